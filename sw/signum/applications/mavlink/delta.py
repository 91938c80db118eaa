# SPDX-License-Identifier: Apache-2.0
"""Readings as `VISION_POSITION_DELTA` (11011): the change from one valid reading to the next that is due.

The autopilot integrates the deltas; they are measured against a fixed reference, so their sum does not drift. Frames
between two due messages are skipped: the next message spans them. ArduPilot does not gate the message by its
confidence, and no change is a measured standstill to it: while nothing is measured, nothing is sent.
"""

from __future__ import annotations

import numpy as np

from signum.applications.hold.reading import Reading
from signum.applications.mavlink.link import Link
from signum.applications.mavlink.pace import Pace
from signum.applications.mavlink.stamp import Stamp

LONGEST_GAP_S = 1.0
"""Longest time that one message spans, seconds. ArduPilot's filter takes a delta for a velocity of now, and without one
for so long it declares dead reckoning (`deadReckonDeclare_ms` of AP_NavEKF3.h)."""
LEAST_S = 0.05
"""Shortest time between two messages, seconds: the filter drops an earlier one (`sensorIntervalMin_ms`, the same)."""


class DeltaSender:
    """Sends the change of station offset from reading to reading.

    Args:
        link: to the autopilot.
        stamp: of the messages.
        rate: largest number of messages a second.

    Attributes:
        sent: messages that the link took.
        gaps: times that the reference changed without a message.
        lost: change of `forward`, `right` and `heading` over these gaps, metres and radians, (3,). Deltas of position,
            each turned by the heading at its beginning, add up to the last valid reading less the first and less these.
    """

    def __init__(self, link: Link, stamp: Stamp, rate: float) -> None:
        self._link, self._stamp = link, stamp
        self._base: tuple[float, Reading] | None = None
        self._seen: tuple[float, Reading] | None = None
        self._period, self._pace = 1 / rate, Pace(rate, LEAST_S)
        self.sent = self.gaps = 0
        self.lost = np.zeros(3)

    def send(self, time: float, reading: Reading) -> None:
        """Send the change since the reading of the last message, if a message is due.

        Nothing is sent of a reading that is not valid. The first valid reading after a gap sends the whole change since
        the last valid one; after a gap of more than `LONGEST_GAP_S` it only becomes the reference of the next message.
        So it does where the link took no message for so long.

        Args:
            time: of the frame, seconds.
            reading: of the frame.
        """
        if not reading.valid:
            if self._pace.allowed(time):
                self._flush(time)
            return
        if self._base is None:
            self._base = time, reading
            self._pace.restart(time)
        elif self._too_long(time):
            self._rebase(time, reading)
        elif self._pace.due(time):
            self._change(time, reading, time)
        self._seen = time, reading

    def _too_long(self, time: float) -> bool:
        """Whether nothing was measured, or nothing taken by the link, for too long before `time`."""
        assert self._base is not None
        start, seen = self._base[0], self._seen or self._base
        return time - seen[0] > LONGEST_GAP_S or time - start > LONGEST_GAP_S + self._period

    def _flush(self, time: float) -> None:
        """Send what no message has told yet, at the time of a frame in which nothing is seen."""
        if self._seen is not None and self._base is not None and self._seen[0] > self._base[0]:
            self._change(*self._seen, time)

    def finish(self) -> None:
        """At the end: send what no message has told yet, or count it as a gap."""
        if self._seen is not None:
            self._flush(self._seen[0])
            if self._base is not None and self._seen[0] > self._base[0]:
                self._rebase(*self._seen)

    def _rebase(self, time: float, reading: Reading) -> None:
        assert self._base is not None
        old = self._base[1]
        self.gaps += 1
        self.lost += (reading.forward - old.forward, reading.right - old.right, reading.heading - old.heading)
        self._base = time, reading
        self._pace.restart(time)

    def _change(self, time: float, reading: Reading, now: float) -> None:
        assert self._base is not None
        start, old = self._base
        change = reading.since(old)
        position = [change.forward, change.right, old.range_m - reading.range_m]
        if self._link.send(self._link.messages.MAVLink_vision_position_delta_message(
                self._stamp(time), round((time - start) * 1e6), [0.0, 0.0, change.heading], position,
                float(reading.confidence))):
            self._base = time, reading
            self._pace.sent(now)
            self.sent += 1
