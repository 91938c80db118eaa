# SPDX-License-Identifier: Apache-2.0
"""What the vehicle tells of itself over the link: attitude, range to the seafloor, clock."""

from __future__ import annotations

import math
import threading
from collections import deque
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from signum.applications.mavlink.clock import VehicleClock

OWN, AUTOPILOT = 197, 1
"""Components: our own, whose messages a router may return, and the autopilot's."""
DOWN = 25
"""MAV_SENSOR_ROTATION_PITCH_270, a range finder that looks down."""
KEEP = 400
"""Attitudes kept: four seconds of the fastest streams."""
FAR_S = 0.25
"""Longest time between a moment and the attitude that is taken for it, seconds."""
RANGE_S = 1.0
"""Age up to which a range counts, seconds."""


@dataclass(frozen=True)
class Attitude:
    """Of the vehicle at a moment, seconds: roll, pitch and yaw, radians, as MAVLink has them, and their rates, radians
    per second."""

    time: float
    roll: float
    pitch: float
    yaw: float
    roll_rate: float
    pitch_rate: float
    yaw_rate: float

    def after(self, dt: float) -> Attitude:
        """`dt` seconds later at the same rates."""
        return replace(self, time=self.time + dt, roll=self.roll + self.roll_rate * dt,
                       pitch=self.pitch + self.pitch_rate * dt, yaw=self.yaw + self.yaw_rate * dt)


class Telemetry:
    """What has arrived; one thread brings it, others ask.

    Attributes:
        clock: the autopilot's.
    """

    def __init__(self) -> None:
        self.clock = VehicleClock()
        self._lock = threading.Lock()
        self._attitudes: deque[Attitude] = deque(maxlen=KEEP)
        self._ranges: deque[tuple[float, float]] = deque(maxlen=KEEP)

    def take(self, message: Any, now: float) -> None:
        """Keep what a message tells; `now` is the monotonic time of its arrival. Other messages are passed over."""
        kind, component = message.get_type(), message.get_srcComponent()
        with self._lock:
            if kind in ("DISTANCE_SENSOR", "RANGEFINDER"):
                if component != OWN:
                    self._take_range(message, now)
            elif component == AUTOPILOT:
                if kind == "ATTITUDE":
                    self._take_attitude(message, now)
                elif kind == "SYSTEM_TIME":
                    self.clock.arrived(message.time_boot_ms / 1e3, now)
                elif kind == "TIMESYNC" and message.tc1:
                    self.clock.answered(message.ts1 / 1e9, message.tc1 / 1e9, now)

    def _take_attitude(self, m: Any, now: float) -> None:
        values = (m.roll, m.pitch, m.yaw, m.rollspeed, m.pitchspeed, m.yawspeed)
        if not all(map(math.isfinite, values)):
            return
        boot = m.time_boot_ms / 1e3
        self.clock.arrived(boot, now)
        if self._attitudes and boot <= self._attitudes[-1].time:
            self._attitudes.clear()  # the autopilot has booted again
        self._attitudes.append(Attitude(boot, *values))

    def _take_range(self, m: Any, now: float) -> None:
        if m.get_type() == "RANGEFINDER":
            distance = float(m.distance)
        elif m.orientation == DOWN and m.min_distance <= m.current_distance <= m.max_distance:
            distance = m.current_distance / 100
        else:
            return
        if math.isfinite(distance) and distance > 0:
            self._ranges.append((now, distance))

    def attitude(self, at: float) -> Attitude | None:
        """The attitude at a moment of the monotonic clock: between the two around it, or by the rates of the nearest;
        None without one within `FAR_S`."""
        with self._lock:
            offset = self.clock.offset
            if offset is None:
                return None
            boot = at + offset
            near = [a for a in self._attitudes if abs(a.time - boot) <= FAR_S]
        before = next((a for a in reversed(near) if a.time <= boot), None)
        after = next((a for a in near if a.time > boot), None)
        if before is None or after is None:
            one = before or after
            return one and replace(one.after(boot - one.time), time=at)
        share = (boot - before.time) / (after.time - before.time)
        turn = math.remainder(after.yaw - before.yaw, 2 * math.pi)
        ends = ((getattr(before, name), getattr(after, name)) for name in
                ("roll", "pitch", "roll_rate", "pitch_rate", "yaw_rate"))
        roll, pitch, *rates = ((1 - share) * a + share * b for a, b in ends)
        return Attitude(at, roll, pitch, before.yaw + share * turn, *rates)

    def range_m(self, at: float) -> float | None:
        """Distance straight down from the vehicle, along its own axis, metres: the median of the last `RANGE_S` before
        a moment of the monotonic clock; None without any."""
        with self._lock:
            found = [distance for time, distance in self._ranges if 0 <= at - time <= RANGE_S]
        return float(np.median(found)) if found else None
