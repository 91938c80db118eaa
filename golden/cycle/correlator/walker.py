# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_walker`."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from golden.cycle.model import Inputs, Values
from golden.structs import STEP, STEP_ROW


def row_counts(steps: int, passes: int, gap_row: int, gap_pass: int) -> dict[str, int]:
    """The counts as fields of a `row_t`: less one (gaps) or two (steps, passes), modulo the field."""
    return {"steps": (steps - 2) % 256, "passes": (passes - 2) % 64, "gap_row": (gap_row - 1) % 128,
            "gap_pass": (gap_pass - 1) % 128}


def _row_steps(row: dict[str, int], pitch: int, ring_rows: int) -> Iterator[dict[str, int] | None]:
    """The clocks of a `row_t`: a `step_t` each, or None in a gap."""
    steps, passes = (row["steps"] + 2) % 256, (row["passes"] + 2) % 64
    for chunk in range(passes):
        yield from [None] * ((row["gap_pass" if chunk else "gap_row"] + 1) % 128)
        for s in range(steps):
            last = s == steps - 1
            yield {"valid": 1, "first": int(s == 0), "last": int(last), "wide": row["wide"],
                   "row_b": int(bool(row["wide"]) or not (last and row["odd"])), "bank": row["bank"], "tpl_step": s,
                   "ring_row": (row["ring_row"] + (s if row["wide"] else 2 * s)) % ring_rows, "chunk": chunk,
                   "lanes": row["last_lanes"] if chunk == passes - 1 else pitch}


class WalkerModel:
    """Holds the remaining steps of the current row. `step_o` is undefined between steps."""

    INPUTS = ("rst_i", "row_valid_i", "row_i")
    OUTPUTS = ("row_ready_o", "step_valid_o", "step_o", "rows_freed_o", "bank_free_o", "busy_o", "drained_o")

    def __init__(self, pitch: int, ring_rows: int, drain_clocks: int) -> None:
        self.pitch, self.ring_rows, self.drain_clocks = pitch, ring_rows, drain_clocks
        self.last: int | None = None
        self._reset()

    def _reset(self) -> None:
        self.left: deque[dict[str, int] | None] = deque()
        self.row: dict[str, int] = {}
        self.coming: dict[str, int] | None = None  # the step of the next clock
        self.valid = self.freed = self.bank_free = 0
        self.freeing: tuple[int, int] | None = None  # rows_freed_o and bank_free_o of the next clock
        self.drain, self.drained = self.drain_clocks, False

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = len(self.left) <= 1
        out: Values = {
            "row_ready_o": int(ready), "step_valid_o": self.valid, "step_o": self.last if self.valid else None,
            "rows_freed_o": self.freed, "bank_free_o": self.bank_free,
            "busy_o": int(bool(self.left) or self.coming is not None or bool(self.valid)),
            "drained_o": int(self.drained)}
        active = bool(self.left)
        step, self.coming = self.coming, self.left.popleft() if self.left else None
        self.valid = int(step is not None)
        ended = active and not self.left
        self.bank_free = 0
        if self.freeing is not None:
            self.freed, self.bank_free = self.freeing
        self.freeing = (self.row["free_to"], self.row["final_row"]) if ended else None
        taken = bool(ready and i["row_valid_i"])
        self.drained = not active and not taken and step is None and self.drain == 0
        self.drain = self.drain_clocks if step is not None else max(self.drain - 1, 0)
        if step is not None:
            self.last = STEP.pack({**step, "valid": 0})
        if taken:
            self.row = STEP_ROW.unpack(i["row_i"])
            self.left.extend(_row_steps(self.row, self.pitch, self.ring_rows))
        if i["rst_i"]:
            self._reset()
        return out
