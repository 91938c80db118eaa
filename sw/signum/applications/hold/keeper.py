# SPDX-License-Identifier: Apache-2.0
"""Keeps the vehicle on station by the meter's readings, and by a substitute reference or the gyro without them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from signum.applications.hold.body_pid import Axes, BodyLoops
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import UPRIGHT, Level, Reading
from signum.common.arrays import Floats
from signum.measure.measurer import View

WIDEN_PX = 4
"""Pixels by which the search range grows with every frame without a reading."""
WIDEN_MOST_PX = 60
"""Largest growth of the search range, pixels."""
GIVE_UP_FRAMES = 40
"""Frames without any measurement after which the vehicle holds its present position."""
MAX_GYRO_MISS = 0.012
"""Largest difference between a reading's heading and the gyro's, radians; beyond it the reading has no confidence."""
GYRO_SHARE = 0.03
"""Share of that difference by which the gyro's heading is corrected at every frame: a time constant of three seconds at
ten frames a second."""
SAFE_SHARE = 0.6
"""Share of a reference in view, times that of its windows that agree, below which a substitute is taken: the reference
may soon leave the view."""
SOUGHT_SHARE = 0.35
"""Share of the station in view by the substitute from which it is searched for in the whole view, where it is not found
at its expected place."""


@dataclass(frozen=True)
class Sensed:
    """What the vehicle's own sensors measure at the time of a frame.

    Attributes:
        level: roll, pitch, pan and tilt, radians; None where there is no attitude sensor, and the camera is taken to
            look straight down.
        yaw_rate: radians per second, the mean since the frame before; None without a gyro.
        range_m: of the seafloor straight below, metres; None without a range finder.
        in_step: whether the gyro is as exactly in step with the frames that readings may be judged by it.
    """

    level: Level | None = None
    yaw_rate: float | None = None
    range_m: float | None = None
    in_step: bool = True


@dataclass
class StationKeeper:
    """Frame in, forces out.

    While the station is out of view, the offset comes from a substitute reference, which was taken when the station was
    about to leave the view. Such offsets steer the vehicle but are never reported as readings. Without any
    measurement the vehicle keeps its heading by its gyro and the thrust it needed against the current.

    Attributes:
        meter: anchored on the station.
        axes: the vehicle.
        blind: frames since the last measurement of either reference.
    """

    meter: StationMeter
    axes: Axes = field(default_factory=Axes)
    blind: int = 0
    _loops: BodyLoops = field(init=False, repr=False)
    _substitute: tuple[StationMeter, Reading] | None = field(init=False, default=None, repr=False)
    _offset: Reading = field(init=False, repr=False)
    _gave_up: bool = field(init=False, default=False)
    _by_gyro: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self._loops = BodyLoops(self.axes)
        self._offset = Reading(range_m=self.meter.range_m)

    def step(self, live: View, sensed: Sensed, dt: float) -> tuple[Reading, Floats]:
        """Measure a view and steer.

        Args:
            live: the view; the keeper releases it.
            sensed: at the time of the view.
            dt: seconds since the view before.

        Returns:
            The reading, and forces (6,) N and N m in body axes that bring the vehicle back.
        """
        wide = min(WIDEN_PX * self.blind, WIDEN_MOST_PX)
        heading = self._offset.heading + (sensed.yaw_rate or 0.0) * dt
        if self.blind:
            self.meter.expect(replace(self._offset, heading=heading))
        else:
            self.meter.turn((sensed.yaw_rate or 0.0) * dt)
        level = sensed.level or UPRIGHT
        reading = self.meter.read(live, level, WIDEN_MOST_PX if self._gave_up else wide)
        offset = reading if reading.valid else self._by_substitute(live, sensed, wide)
        if not reading.valid and (offset is None or self._gave_up or self.meter.in_sight() >= SOUGHT_SHARE):
            sought = self.meter.seek(live, level)
            reading, offset = (sought, sought) if sought.valid else (reading, offset)
        if offset is None:
            return reading, self._without_sight(live, sensed, heading, dt)
        self.blind = 0
        self._gave_up = self._gave_up and not reading.valid
        self._offset = offset
        self._renew_substitute(live, reading, offset, level)
        return self._checked(reading, sensed, dt), self._loops.step(self._errors(offset), dt)

    def rescale(self, ratio: float) -> None:
        """Take all ranges to be `ratio` times as large; the metres of readings change with them."""
        self.meter.rescale(ratio)
        self._offset = self._offset.scaled(ratio)
        if self._substitute is not None:
            meter, base = self._substitute
            meter.rescale(ratio)
            self._substitute = meter, base.scaled(ratio)

    def move(self, view: View, level: Level, range_m: float) -> None:
        """Make a view the station; readings are relative to it from now on.

        Args:
            view: the keeper keeps it.
            level: at the moment of the view.
            range_m: at that moment, metres.
        """
        self._drop_substitute()
        self.meter.range_m = range_m
        self.meter.anchor(view, level)
        self._offset = Reading(range_m=range_m)
        self.blind, self._gave_up, self._by_gyro = 0, False, 0.0

    def _without_sight(self, live: View, sensed: Sensed, heading: float, dt: float) -> Floats:
        """Forces for a view in which neither reference is found."""
        yaw_rate = sensed.yaw_rate or 0.0
        self.blind += 1
        self._offset = replace(self._offset, heading=heading)
        if self.blind == GIVE_UP_FRAMES:  # the way back is lost: at least stay here
            self._take_substitute(live, Reading(range_m=self.meter.range_m), sensed.level or UPRIGHT)
            self._gave_up = True
        else:
            self.meter.measurer.release(live)
        self._by_gyro += yaw_rate * dt
        return self._loops.coast_on_heading(-heading, -yaw_rate, dt)

    def _checked(self, reading: Reading, sensed: Sensed, dt: float) -> Reading:
        """The reading, without confidence where its heading differs from the gyro's: a few windows at the edge of the
        view, displaced by relief, rotate the fit a little more with every frame, which the gyro does not measure."""
        if sensed.yaw_rate is None or not sensed.in_step:
            return reading
        self._by_gyro += sensed.yaw_rate * dt
        if not reading.valid:
            return reading
        miss = reading.heading - self._by_gyro
        if abs(miss) > MAX_GYRO_MISS:
            return Reading(agreed=reading.agreed, tried=reading.tried)
        self._by_gyro += GYRO_SHARE * miss
        return reading

    def _errors(self, offset: Reading) -> Floats:
        """Errors (4,) in the present body axes: the station lies as far behind as the vehicle is ahead of it."""
        c, s = np.cos(offset.heading), np.sin(offset.heading)
        forward = -(c * offset.forward + s * offset.right)
        right = -(-s * offset.forward + c * offset.right)
        return np.array([forward, right, offset.range_m - self.meter.range_m, -offset.heading], np.float64)

    def _by_substitute(self, live: View, sensed: Sensed, wide: int) -> Reading | None:
        """The offset from the station by the substitute reference; None where there is none, or it is not found."""
        if self._substitute is None:
            return None
        meter, base = self._substitute
        reading = meter.read(live, sensed.level or UPRIGHT, wide)
        if not reading.valid:
            return None
        offset = reading.after(base)
        self.meter.expect(offset)
        return offset

    def _renew_substitute(self, live: View, reading: Reading, offset: Reading, level: Level) -> None:
        """Take a substitute reference where the present one may soon leave the view, drop it where the station is well
        in view; release the view where it is not kept."""
        if reading.valid and self._safe(self.meter, reading):
            self._drop_substitute()
            self.meter.measurer.release(live)
        elif self._substitute is None or (not reading.valid and not self._safe(self._substitute[0], offset)):
            self._take_substitute(live, offset, level)
        else:
            self.meter.measurer.release(live)
        if reading.valid and self._substitute is not None:
            self._substitute[0].expect(reading.since(self._substitute[1]))

    def _safe(self, meter: StationMeter, reading: Reading) -> bool:
        """Whether a reference that has just been read will stay in view."""
        return meter.in_sight() * reading.agreed >= SAFE_SHARE * reading.tried

    def _take_substitute(self, live: View, offset: Reading, level: Level) -> None:
        self._drop_substitute()
        m = self.meter
        meter = StationMeter(m.measurer, m.focal, offset.range_m, m.window, m.features, 2 * m.reach)
        if meter.anchor(live, level) >= meter.least:
            self._substitute = meter, offset
        else:
            meter.release()

    def _drop_substitute(self) -> None:
        if self._substitute is not None:
            self._substitute[0].release()
            self._substitute = None
