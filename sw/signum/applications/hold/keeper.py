"""Keeps the vehicle on station: a PID per axis on the meter's readings, and what to do when there are none."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from signum.applications.hold.meter import UPRIGHT, Level, Reading, StationMeter
from signum.applications.hold.tuning import Axis
from signum.applications.pid import Gains, Pid
from signum.common.arrays import Floats
from signum.measure.measurer import View

WIDEN = 4
"""Pixels by which the search widens with every frame without a reading."""
WIDEST = 60
STRIDE_M = 0.2
"""The farthest the controller is told it is off: the way back is made at a pace the search can follow."""
ADRIFT = 40
"""Frames without anything seen after which the vehicle holds wherever it is."""
PARTED = 0.012
"""Radians by which a reading's heading and the gyro's may part."""
GYRO_SHARE = 0.03
"""Share of their difference by which the gyro's heading follows at every frame: in three seconds."""
EASY = 0.6
"""Share of a reference's features in sight below which a stand-in is taken: it may be about to leave the view."""


@dataclass(frozen=True)
class Axes:
    """What the controller knows of the vehicle, and the gains `tuning.tune` found for that: surge, sway, heave, yaw.

    The vehicle's own sensors and autopilot damp yaw; thrusters slew from end to end in a tenth of a second.
    """

    axes: tuple[Axis, ...] = (Axis(16.0, 18.0, 40.0), Axis(22.0, 10.0, 40.0), Axis(24.0, 12.0, 40.0),
                              Axis(0.4, 0.3, 6.0, damper=2.6))
    tuned: tuple[tuple[float, float, float], ...] = (
        (67.1, 141.5, 62.5), (60.0, 110.1, 76.8), (68.2, 125.9, 84.2), (5.91, 17.0, 1.26))

    def loops(self) -> list[Pid]:
        """A controller for each axis."""
        return [Pid(Gains(*tuned, limit=axis.limit, slew=20 * axis.limit))
                for axis, tuned in zip(self.axes, self.tuned, strict=True)]


@dataclass(frozen=True)
class Sensed:
    """What the vehicle's own sensors say at the moment of a frame: roll, pitch, pan and tilt, radians; yaw rate,
    radians per second, None without a gyro."""

    level: Level = UPRIGHT
    yaw_rate: float | None = None


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
    _adrift: bool = field(init=False, default=False)
    _by_gyro: float = field(init=False, default=0.0)
    _errors: Floats | None = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        self._loops = self.axes.loops()
        self._offset = Reading(range_m=self.meter.range_m)

    def step(self, live: View, sensed: Sensed, dt: float) -> tuple[Reading, Floats]:
        """Read a view, which is the keeper's from then on; forces (6,) N and N m in body axes to bring the vehicle
        back."""
        wide = min(WIDEN * self.blind, WIDEST)
        yaw_rate = sensed.yaw_rate or 0.0
        heading = self._offset.heading + yaw_rate * dt
        if self.blind:
            self.meter.expect(replace(self._offset, heading=heading))
        reading = self.meter.read(live, sensed.level, WIDEST if self._adrift else wide)
        seen = reading if reading.valid else self._by_stand_in(live, sensed, wide)
        if seen is None:
            self.blind += 1
            self._offset = replace(self._offset, heading=heading)
            if self.blind == ADRIFT:  # the way back is lost: at least stay here
                self._take_stand_in(live, Reading(range_m=self.meter.range_m), sensed.level)
                self._adrift = True
            else:
                self.meter.measurer.release(live)
            self._errors = None
            self._by_gyro += yaw_rate * dt
            forces = [loop.hold() for loop in self._loops[:3]]
            return reading, self._forces([*forces, self._loops[3].step(-heading, dt, -yaw_rate)])
        self.blind = 0
        self._adrift = self._adrift and not reading.valid
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
        return self._believed(reading, sensed, dt), self._forces(self._steer(seen, dt))

    def _believed(self, reading: Reading, sensed: Sensed, dt: float) -> Reading:
        """The reading, without confidence where its heading and the gyro's part: a few windows at the edge of the view,
        moved by relief, turn the fit a little more with every frame, which a gyro would feel."""
        if sensed.yaw_rate is None:
            return reading
        self._by_gyro += sensed.yaw_rate * dt
        if not reading.valid:
            return reading
        miss = reading.heading - self._by_gyro
        if abs(miss) > PARTED:
            return Reading(agreed=reading.agreed, tried=reading.tried)
        self._by_gyro += GYRO_SHARE * miss
        return reading

    def _steer(self, offset: Reading, dt: float) -> list[float]:
        """The errors in the body's present axes: the station is behind by what the vehicle is ahead."""
        c, s = np.cos(offset.heading), np.sin(offset.heading)
        forward = -(c * offset.forward + s * offset.right)
        right = -(-s * offset.forward + c * offset.right)
        errors = np.array([forward, right, offset.range_m - self.meter.range_m, -offset.heading], np.float64)
        rates = np.zeros(4) if self._errors is None else (errors - self._errors) / dt
        self._errors = errors
        far = max(1.0, float(np.hypot(forward, right)) / STRIDE_M)
        near = far <= 1  # a push is no current: what it takes to come back from far away must not be learnt
        shown = errors / np.array([far, far, 1.0, 1.0])
        return [loop.step(float(e), dt, float(r), near) for loop, e, r in zip(self._loops, shown, rates, strict=True)]

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
    def _forces(axes: list[float]) -> Floats:
        return np.array([axes[0], axes[1], axes[2], 0.0, 0.0, axes[3]])
