# SPDX-License-Identifier: Apache-2.0
"""The autopilot's clock, seconds since its boot, by this machine's monotonic one."""

from __future__ import annotations

from collections import deque

KEEP_S = 10.0
"""Age at which a sample of the clocks' difference is dropped, seconds."""
REBOOT_S = 1.0
"""Change of the difference between one sample and the ones kept that means a reboot, seconds."""


class VehicleClock:
    """Difference between the autopilot's clock and ours.

    A TIMESYNC answer bounds it from both sides: the error is at most half of the round trip, and the answer with the
    shortest one of the last `KEEP_S` is used. Without answers, a stamp that arrives (SYSTEM_TIME, ATTITUDE) shows the
    difference less its delay, which is at least 0: the largest of the last `KEEP_S` is used.
    """

    def __init__(self) -> None:
        self._stamps: deque[tuple[float, float]] = deque()
        self._trips: deque[tuple[float, float, float]] = deque()

    @property
    def offset(self) -> float | None:
        """Autopilot's clock less ours, seconds; None as long as nothing has arrived."""
        trips, stamps = tuple(self._trips), tuple(self._stamps)
        if trips:
            return min(trips, key=lambda t: t[1])[2]
        return max(s[1] for s in stamps) if stamps else None

    def arrived(self, boot: float, now: float) -> None:
        """A stamp of `boot` seconds arrived at `now`."""
        self._forget(now, boot - now)
        self._stamps.append((now, boot - now))

    def answered(self, asked: float, boot: float, now: float) -> None:
        """The autopilot answered at its time `boot` what we asked at `asked`, and the answer arrived at `now`."""
        if not 0 <= now - asked <= KEEP_S:
            return  # an answer to somebody else
        offset = boot - (asked + now) / 2
        self._forget(now, offset)
        self._trips.append((now, now - asked, offset))

    def _forget(self, now: float, offset: float) -> None:
        """Drop old samples, and all of them after a reboot."""
        known = self.offset
        if known is not None and abs(offset - known) > REBOOT_S:
            self._stamps.clear()
            self._trips.clear()
        for kept in (self._stamps, self._trips):
            while kept and now - kept[0][0] > KEEP_S:
                kept.popleft()
