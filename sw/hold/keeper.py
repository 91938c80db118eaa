"""Keeps the vehicle on station: a PID per axis on the meter's readings, and what to do when there are none."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sw.control import Gains, Pid
from sw.hold.meter import Level, Reading, StationMeter
from sw.measure import View

WIDEN = 4
"""Pixels by which the search widens with every frame without a reading."""
WIDEST = 60
STRIDE_M = 0.2
"""The farthest the controller is told it is off: the way back is made at a pace the search can follow."""
ADRIFT = 40
"""Frames without anything seen after which the vehicle holds wherever it is."""
EASY = 0.6
"""Share of a reference's features in sight below which a stand-in is taken: it may be about to leave the view."""


def gains(inertia: float, damping: float, bandwidth: float, limit: float) -> Gains:
    """PID gains by pole placement for an axis that is an inertia with linear damping.

    With force u = Kp e + Ki int e + Kd de/dt the closed loop inertia s^3 + (damping + Kd) s^2 + Kp s + Ki gets the
    poles (s + w/3)(s^2 + 2 z w s + w^2), w the `bandwidth` in rad/s, damping z = 0.9.

    Args:
        inertia: kg or kg m^2, added mass included. damping: N s/m or N m s, at the speeds to be held, an autopilot's
            damper included; where that alone damps more than asked for, Kd is 0.
        limit: N or N m.
    """
    w, z, slow = bandwidth, 0.9, bandwidth / 3
    return Gains(proportional=inertia * (w * w + 2 * z * w * slow), integral=inertia * slow * w * w,
                 rate=max(0.0, inertia * (2 * z * w + slow) - damping), limit=limit, slew=20 * limit)


@dataclass(frozen=True)
class Axes:
    """What the controller must know of the vehicle: inertia, damping and limit of surge, sway, heave, yaw, and
    bandwidths."""

    inertia: tuple[float, float, float, float] = (16.0, 22.0, 24.0, 0.4)
    damping: tuple[float, float, float, float] = (14.0, 18.0, 14.0, 2.9)
    limit: tuple[float, float, float, float] = (40.0, 40.0, 40.0, 6.0)
    bandwidth: tuple[float, float, float, float] = (2.2, 2.2, 1.5, 4.0)


@dataclass(frozen=True)
class Sensed:
    """What the vehicle's own sensors say at the moment of a frame: roll and pitch, radians; yaw rate, radians per
    second."""

    level: Level = (0.0, 0.0)
    yaw_rate: float = 0.0


@dataclass
class StationKeeper:
    """Frame in, forces out.

    While the station is out of sight, a stand-in reference, taken when it was about to leave the view, tells the way
    back; its offsets steer the vehicle but are never given out as readings. With nothing in sight at all the vehicle
    keeps its heading by its gyro and the thrust it needed against the current.

    Attributes:
        meter: anchored on the station.
        axes: the vehicle.
        blind: frames since the last thing of any kind was seen.
    """

    meter: StationMeter
    axes: Axes = field(default_factory=Axes)
    blind: int = 0
    _loops: list[Pid] = field(init=False, repr=False)
    _stand_in: tuple[StationMeter, Reading] | None = field(init=False, default=None, repr=False)
    _offset: Reading = field(init=False, repr=False)

    def __post_init__(self) -> None:
        a = self.axes
        self._loops = [Pid(gains(*axis)) for axis in zip(a.inertia, a.damping, a.bandwidth, a.limit, strict=True)]
        self._offset = Reading(range_m=self.meter.range_m)

    def step(self, live: View, sensed: Sensed, dt: float) -> tuple[Reading, NDArray[np.float64]]:
        """Read a view, which is the keeper's from then on; forces (6,) N and N m in body axes to bring the vehicle
        back."""
        wide = min(WIDEN * self.blind, WIDEST)
        heading = self._offset.heading + sensed.yaw_rate * dt
        if self.blind:
            self.meter.expect(replace(self._offset, heading=heading))
        reading = self.meter.read(live, sensed.level, wide)
        seen = reading if reading.valid else self._by_stand_in(live, sensed, wide)
        if seen is None:
            self.blind += 1
            self._offset = replace(self._offset, heading=heading)
            if self.blind == ADRIFT:  # the way back is lost: at least stay here
                self._take_stand_in(live, Reading(range_m=self.meter.range_m), sensed.level)
            else:
                self.meter.measurer.release(live)
            forces = [loop.hold() for loop in self._loops[:3]]
            return reading, self._forces([*forces, self._loops[3].step(-heading, dt)])
        self.blind = 0
        self._offset = seen
        if reading.valid and reading.agreed >= EASY * self.meter.offered:
            self._drop_stand_in()
            self.meter.measurer.release(live)
        elif self._stand_in is None or (not reading.valid and seen.agreed < EASY * self._stand_in[0].offered):
            self._take_stand_in(live, seen, sensed.level)
        else:
            self.meter.measurer.release(live)
        if reading.valid and self._stand_in is not None:
            self._stand_in[0].expect(reading.since(self._stand_in[1]))
        return reading, self._forces(self._steer(seen, dt))

    def _steer(self, offset: Reading, dt: float) -> list[float]:
        """The errors in the body's present axes: the station is behind by what the vehicle is ahead."""
        c, s = np.cos(offset.heading), np.sin(offset.heading)
        forward = -(c * offset.forward + s * offset.right)
        right = -(-s * offset.forward + c * offset.right)
        far = max(1.0, float(np.hypot(forward, right)) / STRIDE_M)
        errors = (forward / far, right / far, offset.range_m - self.meter.range_m, -offset.heading)
        return [loop.step(float(e), dt) for loop, e in zip(self._loops, errors, strict=True)]

    def _by_stand_in(self, live: View, sensed: Sensed, wide: int) -> Reading | None:
        """The offset from the station by the stand-in reference; None without one, or if that is lost too."""
        if self._stand_in is None:
            return None
        meter, base = self._stand_in
        reading = meter.read(live, sensed.level, wide)
        if not reading.valid:
            return None
        offset = reading.after(base)
        self.meter.expect(offset)
        return offset

    def _take_stand_in(self, live: View, offset: Reading, level: Level) -> None:
        self._drop_stand_in()
        m = self.meter
        meter = StationMeter(m.measurer, m.focal, offset.range_m, m.window, m.features, 2 * m.reach)
        if meter.anchor(live, level) >= meter.least:
            self._stand_in = meter, offset
        else:
            meter.release()

    def _drop_stand_in(self) -> None:
        if self._stand_in is not None:
            self._stand_in[0].release()
            self._stand_in = None

    @staticmethod
    def _forces(axes: list[float]) -> NDArray[np.float64]:
        return np.array([axes[0], axes[1], axes[2], 0.0, 0.0, axes[3]])
