# SPDX-License-Identifier: Apache-2.0
"""What the demonstration flies, and what it keeps for the report."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.judge import Moment
from signum.common.arrays import Floats, Image
from signum.measure.flow import FlowField
from signum.measure.track import TrackPoint

CAMERA_SIZE, CAMERA_FOCAL = (256, 192), 280.0
"""Picture size and focal length of the demonstration's camera, pixels."""
FLIGHT_HEIGHT_M = 2.0
"""Height over the floor, metres."""
DT = 0.2
"""Seconds between two frames, but for station keeping."""
TRACKED = 20
"""Frames of the tracking run."""
FEATURES = 12
"""Largest number of tracked features."""
FLOW_FRAMES = 4
"""Frames from one picture of the flow field to the other."""
COLUMN_IMAGES = 4
"""Stored images of the mosaic."""
HELD_SECONDS = 7.0
"""Length of station keeping."""
FREE_SECONDS = 4.0
"""Length of the drift that it is compared with."""


@dataclass
class Phase:
    """What one part of the flight cost."""

    name: str
    frames: int = 0
    clocks: int = 0
    seconds: float = 0.0


@dataclass
class DemoFlight:
    """Everything the report shows.

    Attributes:
        board, sigma, window: what it ran on.
        phases: costs, in order.
        stage: picture and signs of figure 3, both uint8 (H, W).
        snow: (original, its signs, degraded, its signs) of figure 8; agreement: (whole, inner quarter).
        flow: (first frame, second frame, field, true displacement in pixels (dx, dy)).
        flow_errors: of its valid windows, pixels, (n, 2).
        first, last: frames of the tracking run; points: of the last; initial: of the first.
        errors: of every valid track measurement against the truth, pixels, (n, 2).
        tracked: (measurements of features in view, of them valid).
        mosaic: the picture; poses: per stored frame (measured, true) position in the mosaic plane, pixels; edges: their
            number and that of the accepted ones.
        held: station keeping; free: the same water without control.
    """

    board: str
    sigma: float
    window: int
    phases: list[Phase] = field(default_factory=list)
    stage: tuple[Image, Image] | None = None
    snow: tuple[Image, Image, Image, Image] | None = None
    agreement: tuple[float, float] = (0.0, 0.0)
    flow: tuple[Image, Image, FlowField, tuple[float, float]] | None = None
    flow_errors: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    first: Image | None = None
    last: Image | None = None
    initial: list[TrackPoint] = field(default_factory=list)
    points: list[TrackPoint] = field(default_factory=list)
    errors: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    tracked: tuple[int, int] = (0, 0)
    mosaic: Image | None = None
    poses: list[tuple[tuple[float, float], tuple[float, float]]] = field(default_factory=list)
    edges: tuple[int, int] = (0, 0)
    held: list[Moment] = field(default_factory=list)
    free: list[Moment] = field(default_factory=list)
