# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_check`."""

from __future__ import annotations

from collections import deque

from golden.cycle.dense.structs import BACK, CHECKED, NO_SUM, WINNER
from golden.cycle.model import Inputs, Values
from golden.dense import AGREEMENT

LOOKED_UP = 6
"""Clocks from the last back word that a winner may need to the winner's exit, and two more."""


def check_latency(offsets: int) -> int:
    """From a winner to what has been found of it."""
    return offsets + LOOKED_UP + 2


class DenseCheckModel:
    """Winners and back words of the clocks before. Everything is undefined until a valid has come through."""

    INPUTS = ("rst_i", "winner_valid_i", "winner_i", "back_i")
    OUTPUTS = ("valid_o", "checked_o")

    def __init__(self, offsets: int) -> None:
        self.offsets = offsets
        self._forget()

    def _forget(self) -> None:
        # The newest first.
        self.winners: deque[tuple[int, int] | None] = deque([None] * check_latency(self.offsets))
        self.backs: deque[int] = deque([0] * check_latency(self.offsets))

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        came = self.winners.pop()
        out: Values = {"valid_o": None if came is None else came[0], "checked_o": None}
        if came and came[0]:
            out["checked_o"] = self._checked(WINNER.unpack(came[1]))
        self.winners.appendleft((i["winner_valid_i"], i["winner_i"]))
        self.backs.appendleft(i["back_i"])
        self.backs.pop()
        if i["rst_i"]:
            self._forget()
        return out

    def _checked(self, winner: dict[str, int]) -> int:
        """A winner with what the right plane says of it."""
        found = winner["best"] != NO_SUM
        k = winner["index"]
        # The back word came offsets - k clocks after the winner, which came check_latency clocks ago.
        back = BACK.unpack(self.backs[check_latency(self.offsets) - 1 - (self.offsets - k)])["index"] if found else 0
        return CHECKED.pack({**winner, "found": found, "agrees": found and abs(back - k) <= AGREEMENT})
