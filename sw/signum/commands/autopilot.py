# SPDX-License-Identifier: Apache-2.0
"""What the commands that send over MAVLink have in common: in step with real time."""

from __future__ import annotations

import time

from signum.applications.hold.reading import Reading
from signum.applications.mavlink.sink import MavlinkSink


class Autopilot:
    """Where readings are sent, if anywhere, in step with real time: a MAVLink receiver uses the times of arrival.

    Args:
        sink: of the messages.
        paced: whether to wait for a reading's time, as a live source does by itself.
    """

    def __init__(self, sink: MavlinkSink | None, paced: bool) -> None:
        self._sink, self._paced, self._start = sink, paced, time.monotonic()

    def send(self, moment: float, reading: Reading) -> None:
        """Send the reading of `moment` seconds, if paced once so many seconds have passed since the start."""
        if self._sink is not None:
            if self._paced:
                time.sleep(max(0.0, self._start + moment - time.monotonic()))
            self._sink.send(moment, reading)

    @property
    def said(self) -> str:
        """How many messages were sent, and what was not, for the line on the outcome."""
        return "" if self._sink is None else f", {self._sink.said}"
