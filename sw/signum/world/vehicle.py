# SPDX-License-Identifier: Apache-2.0
"""A six-degree-of-freedom vehicle: drag, thrusters with lag and limits, righting moment, a current with surge; its
pan/tilt."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from signum.common.arrays import Floats
from signum.geometry.camera import LOOK_AHEAD, LOOK_DOWN, Sight, pan_tilt, rotation


@dataclass(frozen=True)
class Current:
    """Moving water: a steady part and a surge along the same axes, metres per second, world north and east.

    Attributes:
        steady: (north, east) m/s.
        surge: amplitude (north, east, down) m/s of an oscillation.
        period: of the surge, seconds.
    """

    steady: tuple[float, float] = (0.0, 0.0)
    surge: tuple[float, float, float] = (0.0, 0.0, 0.0)
    period: float = 7.0

    def at(self, time: float) -> Floats:
        """Velocity of the water (3,) m/s at `time` seconds."""
        wave = np.sin(2 * np.pi * time / self.period)
        return np.asarray(np.array([*self.steady, 0.0]) + wave * np.array(self.surge))


STILL = Current()
"""Still water."""


@dataclass(frozen=True)
class Hull:
    """The dynamics of a small inspection vehicle: mass with added mass, drag, thrust.

    Axes are surge, sway, heave and roll, pitch, yaw. Masses kg and kg m^2, linear drag N s/m and N m s, quadratic
    drag N s^2/m^2 and N m s^2, thrust limits N and N m, lag in seconds, righting moment N m per radian of roll and
    pitch. The horizontal thrusters are `lever` metres below the centre of mass, so their thrust tilts the hull; flow
    from the side yaws it (Munk moment, from the masses). The autopilot's gyro damps yaw by `yaw_damper` N m s through
    the thrusters.
    """

    inertia: tuple[float, ...] = (16.0, 22.0, 24.0, 0.3, 0.35, 0.4)
    linear: tuple[float, ...] = (8.0, 10.0, 12.0, 0.3, 0.35, 0.3)
    quadratic: tuple[float, ...] = (25.0, 35.0, 45.0, 0.5, 0.5, 0.5)
    limit: tuple[float, ...] = (40.0, 40.0, 40.0, 0.0, 0.0, 6.0)
    lag: float = 0.15
    righting: float = 6.0
    lever: float = 0.01
    yaw_damper: float = 2.6


@dataclass
class Vehicle:
    """The vehicle's state and motion.

    Attributes:
        position: (3,) world metres; two metres above the floor is (0, 0, -2).
        attitude: roll, pitch, yaw, radians.
        velocity: (6,) body velocity over ground m/s and angular velocity rad/s.
    """

    hull: Hull = field(default_factory=Hull)
    current: Current = STILL
    position: Floats = field(default_factory=lambda: np.array([0.0, 0.0, -2.0]))
    attitude: Floats = field(default_factory=lambda: np.zeros(3))
    velocity: Floats = field(default_factory=lambda: np.zeros(6))
    thrust: Floats = field(default_factory=lambda: np.zeros(6))
    time: float = 0.0

    @property
    def turn(self) -> Floats:
        """Body to world (3, 3)."""
        return rotation(*self.attitude)

    def step(self, command: Floats, dt: float) -> None:
        """Move for `dt` seconds with forces commanded (6,) N and N m, clipped to the thrusters' limits."""
        h = self.hull
        inertia, limit = np.array(h.inertia), np.array(h.limit)
        count = max(1, round(dt / 0.02))
        d = dt / count
        for _ in range(count):
            damped = command - np.array([0, 0, 0, 0, 0, h.yaw_damper * self.velocity[5]])
            wanted = np.clip(damped, -limit, limit)
            self.thrust = wanted + (self.thrust - wanted) * np.exp(-d / h.lag)
            through = self.velocity.copy()
            through[:3] -= self.turn.T @ self.current.at(self.time)
            drag = np.array(h.linear) * through + np.array(h.quadratic) * np.abs(through) * through
            coupled = np.array([
                0, 0, 0, -h.righting * self.attitude[0] + h.lever * self.thrust[1],
                -h.righting * self.attitude[1] - h.lever * self.thrust[0],
                (h.inertia[0] - h.inertia[1]) * through[0] * through[1]])
            self.velocity = self.velocity + d * (self.thrust - drag + coupled) / inertia
            self.position = self.position + d * self.turn @ self.velocity[:3]
            roll, pitch, _ = self.attitude
            p, q, r = self.velocity[3:]
            self.attitude = self.attitude + d * np.array([
                p + np.tan(pitch) * (q * np.sin(roll) + r * np.cos(roll)),
                q * np.cos(roll) - r * np.sin(roll),
                (q * np.sin(roll) + r * np.cos(roll)) / np.cos(pitch)])
            self.time += d


@dataclass
class PanTilt:
    """A fast pan/tilt: angles follow a rate command within rate and acceleration limits, and stop at their end stops.

    Attributes:
        pan: to the right, radians; tilt: up, radians. Zero is the mount's own direction.
        rate_limit: radians per second; acceleration: radians per second squared; ends: largest |pan| and |tilt|.
    """

    pan: float = 0.0
    tilt: float = 0.0
    rate_limit: float = 1.5
    acceleration: float = 8.0
    ends: tuple[float, float] = (1.2, 0.9)
    rates: Floats = field(default_factory=lambda: np.zeros(2))

    def step(self, pan_rate: float, tilt_rate: float, dt: float) -> None:
        """Turn for `dt` seconds at commanded rates, radians per second."""
        wanted = np.clip([pan_rate, tilt_rate], -self.rate_limit, self.rate_limit)
        self.rates = self.rates + np.clip(wanted - self.rates, -self.acceleration * dt, self.acceleration * dt)
        angles = np.clip(np.array([self.pan, self.tilt]) + self.rates * dt, -np.array(self.ends), self.ends)
        self.pan, self.tilt = float(angles[0]), float(angles[1])


@dataclass(frozen=True, eq=False)
class Mount:
    """A camera's mount on the vehicle: `offset` (3,) body metres, `look` camera to body (3, 3) at rest."""

    offset: Floats = field(default_factory=lambda: np.zeros(3))
    look: Floats = field(default_factory=lambda: LOOK_DOWN)

    def sight(self, vehicle: Vehicle, head: PanTilt | None = None) -> Sight:
        """The camera's present pose, rotated by the pan/tilt where there is one."""
        look = self.look
        if head is not None:
            look = look @ pan_tilt(head.pan, head.tilt)
        return Sight(vehicle.position + vehicle.turn @ self.offset, vehicle.turn @ look)


DOWN = Mount()
"""A camera that looks straight down; image up is forward."""
AHEAD = Mount(look=LOOK_AHEAD)
"""A camera that looks ahead, upright."""
