# SPDX-License-Identifier: Apache-2.0
"""A link to an autopilot: sends messages, a HEARTBEAT every second, and keeps what the vehicle tells of itself."""

from __future__ import annotations

import threading
import time
from types import TracebackType
from typing import Any, Self

from signum.applications.mavlink.endpoint import open_channel
from signum.applications.mavlink.telemetry import Telemetry
from signum.common.errors import SignumError, lacking

COMPONENT = 197
"""MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY."""
AUTOPILOT = 1
"""MAV_COMP_ID_AUTOPILOT1."""
BEAT_S = 1.0
"""Period of HEARTBEAT, and of the TIMESYNC requests, seconds."""
STREAM_HZ = 20.0
"""Rate at which the vehicle's attitude and range are asked for, messages a second."""
WAIT_S = 0.1
"""Longest time for which the receiving thread waits at once, seconds."""


class Link:
    """The link; close it, or use it in a `with`.

    A thread of its own sends HEARTBEAT and TIMESYNC and reads what arrives, so that neither waits for a measurement.
    Messages go out as system 1, or as the system whose autopilot is heard.

    Args:
        address: see `open_channel`.

    Attributes:
        messages: pymavlink's module of messages.
        vehicle: what the vehicle has told.
        asking: whether the autopilot is asked for attitude and range when they do not come by themselves.
        sent: messages that the channel took, HEARTBEAT and TIMESYNC aside.
        failed: messages that it did not take.

    Raises:
        SignumError: if pymavlink is not installed, the address cannot be opened, or the host refuses it.
    """

    def __init__(self, address: str) -> None:
        try:
            # The messages belong to MAVLink 2. Which of the two pymavlink's own connections take is fixed by the
            # environment of its first import, which may have been the caller's: these are of MAVLink 2 in any case.
            from pymavlink.dialects.v20 import ardupilotmega
        except ModuleNotFoundError as error:
            raise lacking("mavlink", error) from error

        self.messages: Any = ardupilotmega
        self._channel = open_channel(address)
        self._out = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=COMPONENT)
        self._in = ardupilotmega.MAVLink(None)
        self._in.robust_parsing = True
        self.vehicle = Telemetry()
        self.asking = False
        self.sent = self.failed = 0
        self._lock, self._stop, self._beat = threading.Lock(), threading.Event(), 0.0
        self._heartbeat()
        if self._channel.refused():
            self._channel.close()
            raise SignumError(f"--mavlink {address}: connection refused: nobody listens there; start the receiver "
                              "first, or mend host and port")
        self._thread = threading.Thread(target=self._serve, name="mavlink", daemon=True)
        self._thread.start()

    def send(self, message: Any) -> bool:
        """Send a message of `messages`; whether the channel took it, which is what `sent` counts."""
        taken = self._put(message)
        self.sent += taken
        self.failed += not taken
        return taken

    def _put(self, message: Any) -> bool:
        with self._lock:
            taken = self._channel.write(bytes(message.pack(self._out)))
            self._out.seq = (self._out.seq + taken) % 256
        return taken

    def _heartbeat(self) -> None:
        m, self._beat = self.messages, time.monotonic()
        self._put(m.MAVLink_heartbeat_message(m.MAV_TYPE_ONBOARD_CONTROLLER, m.MAV_AUTOPILOT_INVALID, 0, 0,
                                              m.MAV_STATE_ACTIVE, 3))

    def _ask(self) -> None:
        """For the autopilot's time."""
        self._put(self.messages.MAVLink_timesync_message(0, time.monotonic_ns()))

    def _ask_for(self, *kinds: int) -> None:
        """Ask the autopilot to send messages of these kinds at `STREAM_HZ` over this link."""
        m = self.messages
        for kind in kinds:
            self._put(m.MAVLink_command_long_message(self._out.srcSystem, AUTOPILOT, m.MAV_CMD_SET_MESSAGE_INTERVAL, 0,
                                                     kind, 1e6 / STREAM_HZ, 0, 0, 0, 0, 0))

    def _serve(self) -> None:
        """The thread: until the link is closed."""
        self._ask()
        while not self._stop.is_set():
            due = self._beat + BEAT_S - time.monotonic()
            if due <= 0:
                self._heartbeat()
                self._ask()
                continue
            data = self._channel.read(min(WAIT_S, due))
            now = time.monotonic()
            for message in (self._in.parse_buffer(data) or []) if data else []:
                self._take(message, now)

    def _take(self, message: Any, now: float) -> None:
        m, kind = self.messages, message.get_type()
        if message.get_srcComponent() == AUTOPILOT:
            if kind == "HEARTBEAT" and message.autopilot != m.MAV_AUTOPILOT_INVALID:
                self._out.srcSystem = message.get_srcSystem()
                if self.asking and self.vehicle.attitude(now) is None:
                    self._ask_for(m.MAVLINK_MSG_ID_ATTITUDE, m.MAVLINK_MSG_ID_DISTANCE_SENSOR)
            elif kind == "TIMESYNC" and message.tc1 == 0:
                self._put(m.MAVLink_timesync_message(time.monotonic_ns(), message.ts1))
        self.vehicle.take(message, now)

    def close(self) -> None:
        """Stop the thread and close the channel."""
        self._stop.set()
        self._thread.join()
        self._channel.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()
