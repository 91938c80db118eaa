# SPDX-License-Identifier: Apache-2.0
"""Keeps the fish in the middle: a fast pan/tilt follows its direction, the vehicle follows the pan/tilt slowly.

The fish's direction in the vehicle's axes is the pan/tilt's angles plus the target's angles in the picture; an
alpha-beta filter estimates its rate. The pan/tilt is commanded with that rate plus a gain times its angle error. The
vehicle's loops have a tenth of the pan/tilt's bandwidth, so the two do not interact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from signum.applications.follow.follower import Target
from signum.applications.pid import Gains, Pid
from signum.common.arrays import Floats

ALPHA, BETA = 0.6, 0.15
"""Gains of the alpha-beta filter; near critical damping, settling in about five frames."""
HEAD_GAIN = 4.0
"""Rate of the pan/tilt per angle error, 1/s: well damped at ten frames a second."""
SWEEP = 0.45
"""Rate of the search, rad/s: two to three degrees a frame at ten frames a second, so frames overlap widely."""
GROWTH = 0.08
"""Growth of the search's ellipse, radians a second: less than the width of view from one turn to the next."""


class Where(StrEnum):
    """Where the camera looks."""

    MIDWATER = "midwater"
    """Ahead, into open water."""
    TERRAIN = "terrain"
    """Straight down."""


@dataclass(frozen=True)
class Felt:
    """What the vehicle's own sensors measure: pan and tilt, radians; heading, radians, and depth, metres, less their
    set points."""

    pan: float
    tilt: float
    heading: float
    depth: float


@dataclass
class Pilot:
    """Targets in, rates of the pan/tilt and forces out.

    Attributes:
        where: decides how the vehicle follows the pan/tilt: in midwater it yaws, heaves and keeps its distance; over
            terrain it moves above the fish and keeps depth and heading.
        focal, centre: of the camera, pixels.
        distance_m: to keep from the fish; over terrain, where one camera measures no range, the assumed range.
        ends: largest |pan| and |tilt| to search, radians.
    """

    where: Where
    focal: float
    centre: tuple[float, float]
    distance_m: float = 2.0
    ends: tuple[float, float] = (1.0, 0.6)
    _angles: Floats = field(init=False, default_factory=lambda: np.zeros(2))
    _rates: Floats = field(init=False, default_factory=lambda: np.zeros(2))
    _lost_for: float = field(init=False, default=0.0)
    _phase: float = field(init=False, default=0.0)
    _left: Felt | None = field(init=False, default=None)
    _loops: dict[str, Pid] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # Second-order loops of 0.5 to 0.7 rad/s for a hull of some 20 kg and 0.4 kg m^2; over terrain yaw and depth do
        # not follow the fish and have higher gains.
        follow = Gains(8.0, 0.6, 14.0, 20.0, 60.0)
        if self.where is Where.MIDWATER:
            self._loops = {"surge": Pid(follow), "heave": Pid(follow), "yaw": Pid(Gains(1.6, 0.1, 0.6, 2.0, 10.0))}
        else:
            self._loops = {"surge": Pid(follow), "sway": Pid(follow), "heave": Pid(Gains(40.0, 8.0, 50.0, 30.0, 200.0)),
                           "yaw": Pid(Gains(5.0, 1.0, 0.5, 4.0, 40.0))}

    def expects(self, felt: Felt, dt: float) -> tuple[float, float]:
        """Predicted pixel of the fish in a frame taken `dt` seconds after the last step."""
        pan, tilt = self._angles + self._rates * dt - (felt.pan, felt.tilt)
        return (self.centre[0] + self.focal * math.tan(np.clip(pan, -1.2, 1.2)),
                self.centre[1] - self.focal * math.tan(np.clip(tilt, -1.2, 1.2)))

    def step(self, target: Target, felt: Felt, dt: float) -> tuple[tuple[float, float], Floats]:
        """Steer by a frame's target; `felt` at its time, `dt` seconds after the frame before.

        Returns:
            (pan rate, tilt rate) rad/s, and forces (6,) N and N m in body axes.
        """
        head = np.array([felt.pan, felt.tilt])
        if target.lost:
            if self._lost_for == 0:
                self._left = felt
            return self._search(head, dt), self._wait(felt, dt)
        predicted = self._angles + self._rates * dt
        if self._lost_for > 0 or not self._angles.any():
            self._rates = np.zeros(2)
            predicted = self._direction(target, head)
        self._lost_for = self._phase = 0.0
        miss = np.zeros(2) if target.state == "coasting" else self._direction(target, head) - predicted
        self._angles = predicted + ALPHA * miss
        self._rates = np.clip(self._rates + BETA / dt * miss, -1.5, 1.5)
        rates = self._rates + HEAD_GAIN * (self._angles - head)
        return (float(rates[0]), float(rates[1])), self._follow(target, felt, dt)

    def _direction(self, target: Target, head: Floats) -> Floats:
        return head + np.arctan([(target.x - self.centre[0]) / self.focal, -(target.y - self.centre[1]) / self.focal])

    def _search(self, head: Floats, dt: float) -> tuple[float, float]:
        """Sweep a growing ellipse, first around the fish's last direction, in the end over the pan/tilt's whole range;
        then begin again."""
        size = 0.1 + GROWTH * self._lost_for
        if size > 1.8 * self.ends[0]:
            self._lost_for, size, self._angles = dt, 0.1, np.zeros(2)
        self._lost_for += dt
        self._phase += SWEEP / max(size, 0.25) * dt
        middle = self._angles * max(0.0, 1 - size / self.ends[0])
        goal = np.clip(middle + size * np.array([math.sin(self._phase), 0.6 * math.cos(self._phase)]),
                       -np.array(self.ends), self.ends)
        rates = np.clip(3.0 * (goal - head), -1.5 * SWEEP, 1.5 * SWEEP)
        return float(rates[0]), float(rates[1])

    def _follow(self, target: Target, felt: Felt, dt: float) -> Floats:
        pan, tilt = (float(a) for a in self._angles)
        near = self.distance_m if math.isnan(target.range_m) else target.range_m
        aside, up = near * math.tan(np.clip(pan, -1, 1)), near * math.tan(np.clip(tilt, -1, 1))
        if self.where is Where.MIDWATER:
            errors = {"surge": near - self.distance_m, "heave": -up, "yaw": pan}
        else:
            errors = {"surge": up, "sway": aside, "heave": -felt.depth, "yaw": -felt.heading}
        return self._forces({name: self._loops[name].step(e, dt) for name, e in errors.items()})

    def _wait(self, felt: Felt, dt: float) -> Floats:
        """Stay here until the fish is found: in midwater at the depth and heading at which it was lost."""
        kept = self._left if self.where is Where.MIDWATER and self._left else Felt(0.0, 0.0, 0.0, 0.0)
        own = {"heave": kept.depth - felt.depth, "yaw": kept.heading - felt.heading}
        if self.where is Where.MIDWATER:  # its speed is not measured: drag stops it
            return self._forces({name: self._loops[name].step(error, dt) for name, error in own.items()})
        return self._forces({name: loop.step(own[name], dt) if name in own else loop.hold()
                             for name, loop in self._loops.items()})

    @staticmethod
    def _forces(axes: dict[str, float]) -> Floats:
        get = axes.get
        return np.array([get("surge", 0.0), get("sway", 0.0), get("heave", 0.0), 0.0, 0.0, get("yaw", 0.0)])
