# SPDX-License-Identifier: Apache-2.0
"""One PID per body axis: position errors in, thruster forces out; shared by station keeping and mosaic navigation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.applications.hold.tuning import Axis
from signum.applications.pid import Gains, Pid
from signum.common.arrays import Floats

STRIDE_M = 0.2
"""Largest horizontal error passed to the controllers, metres: it limits the speed of the return to what the search can
follow."""


@dataclass(frozen=True)
class Axes:
    """The vehicle's dynamics and the gains `tuning.tune` found for them: surge, sway, heave, yaw.

    The vehicle's own sensors and autopilot damp yaw; thrusters slew over their whole range in a tenth of a second.
    """

    axes: tuple[Axis, ...] = (Axis(16.0, 18.0, 40.0), Axis(22.0, 10.0, 40.0), Axis(24.0, 12.0, 40.0),
                              Axis(0.4, 0.3, 6.0, damper=2.6))
    tuned: tuple[tuple[float, float, float], ...] = (
        (67.1, 141.5, 62.5), (60.0, 110.1, 76.8), (68.2, 125.9, 84.2), (5.91, 17.0, 1.26))

    def loops(self) -> list[Pid]:
        """A controller for each axis."""
        return [Pid(Gains(*tuned, limit=axis.limit, slew=20 * axis.limit))
                for axis, tuned in zip(self.axes, self.tuned, strict=True)]


class BodyLoops:
    """The controllers of surge, sway, heave and yaw.

    Args:
        axes: the vehicle.
    """

    def __init__(self, axes: Axes) -> None:
        self._loops = axes.loops()
        self._errors: Floats | None = None

    def step(self, errors: Floats, dt: float) -> Floats:
        """Forces (6,) N and N m in body axes for errors (4,), metres forward, right, down and radians of heading, `dt`
        seconds after the call before."""
        rates = np.zeros(4) if self._errors is None else (errors - self._errors) / dt
        self._errors = errors
        far = max(1.0, float(np.hypot(errors[0], errors[1])) / STRIDE_M)
        # Beyond STRIDE_M the error is from a push, not from the current: the integrals must not include it.
        near = far <= 1
        limited = errors / np.array([far, far, 1.0, 1.0])
        return _forces([loop.step(float(e), dt, float(r), near)
                        for loop, e, r in zip(self._loops, limited, rates, strict=True)])

    def coast(self) -> Floats:
        """Forces (6,) without a measurement: only what the integrals hold against the current."""
        self._errors = None
        return _forces([loop.hold() for loop in self._loops])

    def coast_on_heading(self, error: float, rate: float, dt: float) -> Floats:
        """As `coast`, with the heading controlled by its error, radians, and the error's rate, radians per second."""
        self._errors = None
        return _forces([*(loop.hold() for loop in self._loops[:3]), self._loops[3].step(error, dt, rate)])


def _forces(axes: list[float]) -> Floats:
    return np.array([axes[0], axes[1], axes[2], 0.0, 0.0, axes[3]])
