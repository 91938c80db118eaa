# SPDX-License-Identifier: Apache-2.0
"""Messages to an autopilot, sent in step with real time."""

from __future__ import annotations

import time

from signum.applications.mavlink.base import LinkSink


class InStep:
    """Real time for what is sent: a MAVLink receiver uses the times of arrival.

    Args:
        sink: of the messages, None for none, and no waiting.
        paced: whether to wait for a frame's time, as a live source does by itself.
    """

    def __init__(self, sink: LinkSink | None, paced: bool) -> None:
        self._any, self._paced, self._start = sink, paced and sink is not None, time.monotonic()

    def begin(self, first: float | None) -> None:
        """The first frame is there; of a live source, at `first` on the monotonic clock."""
        self._start = first if first is not None and not self._paced else time.monotonic()
        if self._any is not None:
            self._any.stamp.origin = self._start

    def wait(self, moment: float) -> None:
        """If paced, until `moment` seconds have passed since the first frame."""
        if self._paced:
            time.sleep(max(0.0, self._start + moment - time.monotonic()))

    @property
    def said(self) -> str:
        """How many messages were sent, and what was not, for the line on the outcome."""
        return "" if self._any is None else f", {self._any.said}"
