"""The simulated flight that the demo measures and draws."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.station import Moment
from signum.common.arrays import Floats, Image
from signum.measure.flow import FlowField
from signum.measure.track import TrackPoint

SIZE = 256, 192


FOCAL = 280.0


TRACKED = 20


FEATURES = 12


FLOW_FRAMES = 4
"""Frames from one picture of the flow field to the other."""


IMAGES = 4


HELD_SECONDS = 14.0


FREE_SECONDS = 3.0


DT = 0.2



@dataclass
class Phase:
    """What one part of the flight cost."""

    name: str
    frames: int = 0
    clocks: int = 0
    seconds: float = 0.0



@dataclass
class Flight:
    """Everything the report shows.

    Attributes:
        board, sigma, window: what it ran on.
        phases: costs, in order.
        stage: picture and signs of figure 3, both uint8 (H, W).
        snow: (original, its signs, degraded, its signs) of figure 8; agreement: (whole, inner quarter).
        flow: (first frame, second frame, field, true displacement in pixels (dx, dy)).
        first, last: frames of the tracking run; points of the last; initial: those of the first.
        errors: of every valid track measurement against the truth, pixels, (n, 2).
        tracked: (measurements of features in view, of them valid).
        mosaic: the picture; poses: per stored frame (measured, true) position in the mosaic plane, pixels; edges: how
            many there are and how many are accepted.
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
