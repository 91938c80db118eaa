# SPDX-License-Identifier: Apache-2.0
"""Steers to a target: rates of a pan/tilt, or forces of a vehicle, from the target's position in the frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.body_pid import Axes, BodyLoops
from signum.applications.navigate.aim import Aim
from signum.common.arrays import Floats
from signum.geometry.camera import LOOK_DOWN, rotation

BACKTRACK_FRAMES = 6
"""Frames without a position after which the last motion is reversed."""


@dataclass
class PanTiltSteering:
    """Rates of a pan/tilt that bring the target to the middle of the picture.

    Proportional control of an integrator sampled once a frame: with `gain` times the frame period between a fifth and a
    third the error falls to 1 % within 15 frames without overshoot. Rates are limited so that the picture moves by at
    most `stride` pixels from frame to frame, which the search can follow.

    Attributes:
        focal: pixels of the original frame.
        gain: per second.
        stride: original pixels a frame.
    """

    focal: float
    gain: float = 2.5
    stride: float = 12.0
    _blind: int = 0
    _went: tuple[float, float] = (0.0, 0.0)

    def rates(self, aim: Aim, dt: float) -> tuple[float, float]:
        """(pan to the right, tilt up), radians per second, for the present frame; `dt` seconds between frames."""
        most = self.stride / self.focal / dt
        if not aim.known:
            self._blind += 1
            if self._blind <= BACKTRACK_FRAMES:
                return 0.0, 0.0
            back = max(abs(self._went[0]), abs(self._went[1]), 1e-9)
            return -self._went[0] / back * most / 2, -self._went[1] / back * most / 2
        self._blind = 0
        wanted = self.gain * aim.error / self.focal * (1.0, -1.0)
        wanted = wanted / max(1.0, float(np.abs(wanted).max()) / most)
        self._went = float(wanted[0]), float(wanted[1])
        return self._went


@dataclass
class VehicleSteering:
    """Forces that bring the vehicle above the target, at the survey's height and heading, by the station keeper's
    controllers.

    Attributes:
        focal: pixels of the frames; range_m: height of the survey over the floor, metres.
        axes: the vehicle.
    """

    focal: float
    range_m: float
    axes: Axes = field(default_factory=Axes)

    def __post_init__(self) -> None:
        self._loops = BodyLoops(self.axes)

    def forces(self, aim: Aim, level: tuple[float, float], dt: float) -> Floats:
        """(6,) N and N m in body axes.

        Args:
            aim: of the present frame.
            level: roll and pitch, radians.
            dt: seconds between frames.
        """
        found = aim.place.similarity
        if found is None or not aim.known:
            return self._loops.coast()
        below = LOOK_DOWN.T @ rotation(*level, 0.0).T @ np.array([0.0, 0.0, 1.0])
        way = (aim.error - self.focal * below[:2] / below[2]) * found.scale * self.range_m / self.focal
        errors = np.array([-way[1], way[0], self.range_m * (found.scale - 1), -np.radians(found.rot_deg)])
        return self._loops.step(errors, dt)
