"""Cycle model of `slog_ram_fifo`."""

from __future__ import annotations

from collections import deque

OUT_DEPTH = 6
"""Places of the register queue behind the RAM."""


class RamFifoModel:
    """Queue of `depth` words: a clock to the RAM, two of reading, a short queue; a word that left counts for one.

    Data is undefined while not valid.
    """

    INPUTS = ("rst_i", "in_valid_i", "in_data_i", "out_ready_i")
    OUTPUTS = ("in_ready_o", "out_valid_o", "out_data_o", "level_o")

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.clear()

    def clear(self) -> None:
        """Empty it."""
        self.coming: int | None = None
        self.stored: deque[int] = deque()
        self.flying: deque[int | None] = deque([None, None])
        self.front: deque[int] = deque()
        self.left = 0
        """Words that left in the clock before."""

    @property
    def level(self) -> int:
        """Words inside, and those just gone."""
        moving = sum(w is not None for w in (self.coming, *self.flying))
        return len(self.stored) + len(self.front) + moving + self.left

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        level = self.level
        out: dict[str, int | None] = {
            "in_ready_o": int(level < self.depth),
            "out_valid_o": int(bool(self.front)),
            "out_data_o": self.front[0] if self.front else None,
            "level_o": level,
        }
        if i["rst_i"]:
            self.clear()
            return out
        # A place is spoken for from the clock after the read to the clock after the pop; another is kept for that read.
        spoken = level - len(self.stored) - sum(w is not None for w in (self.coming, self.flying[-1]))
        read = self.stored and spoken <= OUT_DEPTH - 2
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
