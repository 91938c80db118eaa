# SPDX-License-Identifier: Apache-2.0
"""An autopilot on the other end of `signum hold`: told in step with real time, and asked how its vehicle moves."""

from __future__ import annotations

import math
import time

from signum.applications.hold.keeper import Sensed
from signum.applications.hold.reading import Level, Reading
from signum.applications.mavlink.sink import MavlinkSink
from signum.applications.mavlink.telemetry import Attitude
from signum.commands.in_step import InStep

RANGE_WAIT_S = 2.0
"""Longest wait for the vehicle's range before the first frame, seconds."""


class Autopilot(InStep):
    """Where readings are sent, if anywhere, and who tells how the vehicle moves.

    Args:
        sink: of the messages.
        paced: whether to wait for a reading's time, as a live source does by itself.
        sensing: whether what the vehicle tells of itself is used.

    Attributes:
        sensing: the same; never without a sink.
    """

    def __init__(self, sink: MavlinkSink | None, paced: bool, sensing: bool = False) -> None:
        super().__init__(sink, paced)
        self._sink, self.sensing = sink, sensing and sink is not None
        if sink is not None:
            sink.link.asking = sensing
        self._last: tuple[float, Attitude] | None = None
        self._level: Level | None = None
        self._north: float | None = None
        self._frames = self._levelled = 0

    def await_range(self) -> None:
        """Wait a moment for the vehicle's range."""
        end = time.monotonic() + RANGE_WAIT_S
        while self.range_m is None and time.monotonic() < end:
            time.sleep(0.01)

    @property
    def range_m(self) -> float | None:
        """Range that the vehicle has told of lately, metres; None without."""
        return self._sink.link.vehicle.range_m(time.monotonic()) if self._sink is not None and self.sensing else None

    def at(self, moment: float) -> Sensed:
        """What the vehicle tells of a frame `moment` seconds after the first; if paced, at that time."""
        if self._sink is None or not self.sensing:
            return Sensed()
        self.wait(moment)
        vehicle, now = self._sink.link.vehicle, self._start + moment
        attitude, distance = vehicle.attitude(now), vehicle.range_m(time.monotonic())
        self._level = None
        self._frames += 1
        self._levelled += attitude is not None
        if attitude is None:
            return Sensed(range_m=distance, in_step=False)
        self._level = Level(attitude.roll, attitude.pitch)
        rate = attitude.yaw_rate
        if self._last is not None and moment > self._last[0]:
            rate = math.remainder(attitude.yaw - self._last[1].yaw, 2 * math.pi) / (moment - self._last[0])
        self._last = moment, attitude
        if distance is not None:
            distance *= math.cos(attitude.roll) * math.cos(attitude.pitch)
        return Sensed(self._level, rate, distance, in_step=False)

    def send(self, moment: float, reading: Reading) -> None:
        """Send the reading of `moment` seconds, if paced once so many seconds have passed since the start."""
        if self._sink is None:
            return
        self.wait(moment)
        if self._north is None and reading.valid and self._level is not None and self._last is not None:
            self._north = math.remainder(self._last[1].yaw - reading.heading, 2 * math.pi)
        self._sink.send(moment, reading, self._level, self._north or 0.0)

    @property
    def said(self) -> str:
        """How many messages were sent, and what was not, for the line on the outcome."""
        known = f", attitude known of {self._levelled} of {self._frames} frames" if self.sensing else ""
        return super().said + known
