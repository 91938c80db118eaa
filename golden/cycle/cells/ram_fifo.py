# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_ram_fifo`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values

OUT_DEPTH = 6
"""Words of the register queue behind the RAM."""


class RamFifoModel:
    """Queue of `depth` words: one clock into the RAM, two to read it, then a short queue of registers.

    A word counts towards the level for one clock after it leaves. Data are undefined while not valid.
    """

    INPUTS = ("rst_i", "in_valid_i", "in_data_i", "out_ready_i")
    OUTPUTS = ("in_ready_o", "out_valid_o", "out_data_o", "level_o")

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.clear()

    def clear(self) -> None:
        """Empty the queue."""
        self.coming: int | None = None
        self.stored: deque[int] = deque()
        self.flying: deque[int | None] = deque([None, None])
        self.front: deque[int] = deque()
        self.left = 0
        """Words that left in the clock before."""

    @property
    def level(self) -> int:
        """Words in the queue, plus the one that left in the clock before."""
        moving = sum(w is not None for w in (self.coming, *self.flying))
        return len(self.stored) + len(self.front) + moving + self.left

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        level = self.level
        out: Values = {
            "in_ready_o": int(level < self.depth),
            "out_valid_o": int(bool(self.front)),
            "out_data_o": self.front[0] if self.front else None,
            "level_o": level,
        }
        if i["rst_i"]:
            self.clear()
            return out
        # A register is reserved from the clock after the read to the clock after the pop; one more for this read.
        reserved = level - len(self.stored) - sum(w is not None for w in (self.coming, self.flying[-1]))
        read = self.stored and reserved <= OUT_DEPTH - 2
        self.flying.append(self.stored.popleft() if read else None)
        self.left = int(bool(self.front and i["out_ready_i"]))
        if self.left:
            self.front.popleft()
        arrived = self.flying.popleft()
        if arrived is not None:
            self.front.append(arrived)
        if self.coming is not None:
            self.stored.append(self.coming)
        self.coming = i["in_data_i"] if i["in_valid_i"] and out["in_ready_o"] else None
        return out
