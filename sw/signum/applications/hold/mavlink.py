# SPDX-License-Identifier: Apache-2.0
"""Readings as MAVLink `VISION_POSITION_DELTA` (11011), as an ArduSub vehicle takes them: body FRD, 8 to 10 Hz.

The autopilot integrates the deltas; they are measured against a fixed reference, so their sum does not drift. Frames
between two due messages are skipped: the next message spans them.
"""

from __future__ import annotations

import math
from types import TracebackType
from typing import Any, Self

from signum.applications.hold.reading import Reading
from signum.common.errors import SignumError, lacking

SYSTEM, COMPONENT = 1, 197  # MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY


class MavlinkSink:
    """Sends the change of station offset from reading to reading.

    Args:
        address: as pymavlink takes it, `udpout:HOST:PORT`.
        rate: largest number of messages a second.

    Raises:
        SignumError: if pymavlink is not installed, or the address cannot be opened.
    """

    def __init__(self, address: str, rate: float = 10.0) -> None:
        try:
            from pymavlink import mavutil
            from pymavlink.dialects.v20 import ardupilotmega
        except ModuleNotFoundError as error:
            raise lacking("mavlink", error) from error

        try:
            self._link: Any = mavutil.mavlink_connection(address, source_system=SYSTEM, source_component=COMPONENT)
        except (OSError, ValueError, IndexError) as error:
            raise SignumError(f"--mavlink {address}: {error}; write it as udpout:HOST:PORT") from error
        # The message belongs to MAVLink 2. Which of the two pymavlink's own messages are is fixed by the environment of
        # its first import, which may have been the caller's: these are of MAVLink 2 in any case.
        self._messages = ardupilotmega.MAVLink(self._link, srcSystem=SYSTEM, srcComponent=COMPONENT)
        self._last: tuple[float, Reading] | None = None
        self._period, self._due = 1 / rate, 0.0
        self.sent = 0

    def send(self, time: float, reading: Reading) -> None:
        """Send the change since the last message's reading, if a message is due; confidence 0 and no change where
        either reading is not valid.

        Args:
            time: of the frame, seconds.
            reading: of the frame.
        """
        if self._last is not None and time < self._due - 1e-3:
            return
        before, self._last = self._last, (time, reading)
        if before is None:
            self._due = time + self._period
            return
        self._due = max(self._due, time - self._period) + self._period  # a late frame delays no other
        angle, position, confidence = [0.0] * 3, [0.0] * 3, 0
        old = before[1]
        if old.valid and reading.valid:
            confidence = reading.confidence
            ahead, aside = reading.forward - old.forward, reading.right - old.right
            c, s = math.cos(old.heading), math.sin(old.heading)
            position = [c * ahead + s * aside, -s * ahead + c * aside, old.range_m - reading.range_m]
            angle = [0.0, 0.0, reading.heading - old.heading]
        self._messages.vision_position_delta_send(round(time * 1e6), round((time - before[0]) * 1e6), angle, position,
                                                  float(confidence))
        self.sent += 1

    def close(self) -> None:
        """Close the link."""
        self._link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()
