# SPDX-License-Identifier: Apache-2.0
"""When the next message is due."""

from __future__ import annotations

import math

EARLY_S = 1e-3
"""By how much a frame may come before a message is due, and after the receiver accepts one, seconds: times are rounded.
"""


class Pace:
    """So many messages a second on average, and none too soon after the one before.

    Args:
        rate: messages a second at most.
        least: shortest time between two that the receiver accepts, seconds.
    """

    def __init__(self, rate: float, least: float) -> None:
        self._period, self._least = 1 / rate, least
        self._due = self._last = -math.inf

    def due(self, time: float) -> bool:
        """Whether a message may go at a time, seconds."""
        return time >= self._due - EARLY_S and self.allowed(time)

    def allowed(self, time: float) -> bool:
        """Whether the receiver would accept one, due or not."""
        return time - self._last >= self._least + EARLY_S

    def sent(self, time: float) -> None:
        """One was sent: a late one delays no other, but none follows it too closely."""
        self._due = max(self._due + self._period, time + self._period / 2)
        self._last = time

    def restart(self, time: float) -> None:
        """The first is due a period after a time."""
        self._due = time + self._period
