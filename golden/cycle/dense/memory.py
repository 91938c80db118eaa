# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_memory`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values

READ_CLOCKS, WRITE_CLOCKS = 3, 4
"""From run_i to above_o, and to the clock in which sum_i is taken."""


class DenseMemoryModel:
    """A word for each clock of a row, counted from its first.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "run_i", "first_i", "sum_i")
    OUTPUTS = ("above_o",)

    def __init__(self) -> None:
        self.words: dict[int, int] = {}
        self.place = 0
        # What was asked for in the clocks before, the newest first: place, whether it is cleared, None outside a row.
        self.asked: deque[tuple[int, int] | None] = deque([None] * WRITE_CLOCKS)
        self.above: deque[int | None] = deque([None] * READ_CLOCKS)

    @property
    def out(self) -> Values:
        return {"above_o": self.above[-1]}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        written = self.asked.pop()
        if written is not None:
            self.words[written[0]] = i["sum_i"]
        if i["rst_i"]:
            self.asked = deque([None] * (WRITE_CLOCKS - 1))
        asked = (self.place, i["first_i"]) if i["run_i"] else None
        self.above.pop()
        self.above.appendleft(None if asked is None else 0 if asked[1] else self.words.get(asked[0]))
        self.asked.appendleft(None if i["rst_i"] else asked)
        self.place = self.place + 1 if i["run_i"] else 0
        return out
