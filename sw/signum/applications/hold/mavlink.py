# SPDX-License-Identifier: Apache-2.0
"""Readings as MAVLink `VISION_POSITION_DELTA` (11011), as an ArduSub vehicle takes them: body FRD, 8 to 10 Hz.

The autopilot integrates the deltas; they are measured against a fixed reference, so their sum does not drift. Frames
between two due messages are skipped: the next message spans them. ArduPilot does not
gate the message by its confidence, and no change is a measured standstill to it: while nothing is measured, nothing is
sent.
"""

from __future__ import annotations

import socket
from types import TracebackType
from typing import Any, Self

import numpy as np

from signum.applications.hold.reading import Reading
from signum.common.errors import SignumError, lacking

SYSTEM, COMPONENT = 1, 197  # MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY
LONGEST_GAP_S = 1.0
"""Longest time that one message spans, seconds: a change of so long ago no longer helps the autopilot's filter."""


class MavlinkSink:
    """Sends the change of station offset from reading to reading.

    Args:
        address: as pymavlink takes it, `udpout:HOST:PORT`.
        rate: largest number of messages a second.

    Attributes:
        sent: messages.
        gaps: times that the reference changed without a message.
        lost: change of `forward`, `right` and `heading` over these gaps, metres and radians, (3,). Deltas of position,
            each turned by the heading at its beginning, add up to the last valid reading less the first and less these.

    Raises:
        SignumError: if pymavlink is not installed, or the address cannot be opened or resolved.
    """

    def __init__(self, address: str, rate: float = 10.0) -> None:
        try:
            from pymavlink import mavutil
            from pymavlink.dialects.v20 import ardupilotmega
        except ModuleNotFoundError as error:
            raise lacking("mavlink", error) from error

        _resolve(address)
        try:
            self._link: Any = mavutil.mavlink_connection(address, source_system=SYSTEM, source_component=COMPONENT)
        except ModuleNotFoundError as error:
            raise SignumError(f"--mavlink {address}: a serial port needs the package {error.name}: install pyserial, "
                              "or write the address as udpout:HOST:PORT") from error
        except (OSError, ValueError, IndexError) as error:
            raise SignumError(f"--mavlink {address}: {error}; write it as udpout:HOST:PORT") from error
        # The message belongs to MAVLink 2. Which of the two pymavlink's own messages are is fixed by the environment of
        # its first import, which may have been the caller's: these are of MAVLink 2 in any case.
        self._messages = ardupilotmega.MAVLink(self._link, srcSystem=SYSTEM, srcComponent=COMPONENT)
        self._base: tuple[float, Reading] | None = None
        self._seen: tuple[float, Reading] | None = None
        self._period, self._due = 1 / rate, 0.0
        self.sent = self.gaps = 0
        self.lost = np.zeros(3)

    def send(self, time: float, reading: Reading) -> None:
        """Send the change since the reading of the last message, if a message is due.

        Nothing is sent of a reading that is not valid: to the autopilot no change is a measured standstill, whatever
        the confidence. The first valid reading after a gap sends the whole change since the last valid one; after a gap
        of more than `LONGEST_GAP_S` it only becomes the reference of the next message.

        Args:
            time: of the frame, seconds.
            reading: of the frame.
        """
        if not reading.valid:
            self._flush()
            return
        if self._base is None:
            self._base, self._due = (time, reading), time + self._period
        elif self._seen is not None and time - self._seen[0] > LONGEST_GAP_S:
            old = self._base[1]
            self.gaps += 1
            self.lost += (reading.forward - old.forward, reading.right - old.right, reading.heading - old.heading)
            self._base, self._due = (time, reading), time + self._period
        elif time >= self._due - 1e-3:
            self._due = max(self._due, time - self._period) + self._period  # a late frame delays no other
            self._change(time, reading)
        self._seen = time, reading

    def _flush(self) -> None:
        """Send what no message has told yet."""
        if self._seen is not None and self._base is not None and self._seen[0] > self._base[0]:
            self._change(*self._seen)

    def _change(self, time: float, reading: Reading) -> None:
        assert self._base is not None
        start, old = self._base
        change = reading.since(old)
        position = [change.forward, change.right, old.range_m - reading.range_m]
        self._messages.vision_position_delta_send(round(time * 1e6), round((time - start) * 1e6),
                                                  [0.0, 0.0, change.heading], position, float(reading.confidence))
        self._base = time, reading
        self.sent += 1

    def close(self) -> None:
        """Send what is left, and close the link."""
        self._flush()
        self._link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


def _resolve(address: str) -> None:
    """Look up the host of `udpout:HOST:PORT`: pymavlink would send to nowhere without a word."""
    kind, _, place = address.partition(":")
    host, _, port = place.rpartition(":")
    if kind != "udpout" or not host or not port.isdecimal():
        return
    if not 0 < int(port) < 1 << 16:
        raise SignumError(f"--mavlink {address}: a port is a number from 1 to 65535")
    try:
        socket.getaddrinfo(host, int(port), type=socket.SOCK_DGRAM)
    except OSError as error:
        raise SignumError(f"--mavlink {address}: host {host} is not known: {error.strerror or error}; give its IP "
                          "address") from error
