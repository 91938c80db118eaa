# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_scan`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values
from golden.cycle.peak.structs import PRESENT, SCAN
from golden.params import SCORE_BITS


class PeakScanModel:
    """The columns near the best three clocks after their read, the best of all others ten after the last."""

    INPUTS = ("rst_i", "order_valid_i", "order_i", "data_i")
    FLAGS = ("near_end_o", "near_first_o", "near_west_o", "near_centre_o", "near_east_o")
    VALUES = ("near_above_o", "near_middle_o", "near_below_o")
    OUTPUTS = ("order_room_o", "read_o", "read_x_o", *FLAGS, *VALUES, "far_valid_o", "far_o")

    def __init__(self, banks: int) -> None:
        self.banks = banks
        self.clear()

    def clear(self) -> None:
        """Idle; the next row is in bank 0."""
        self.order: dict[str, int] | None = None
        self.x, self.bank = 0, self.banks - 1
        self.wait = False
        """The clock before a row of a single column."""
        self.reading: deque[tuple[dict[str, int], int, int] | None] = deque([None, None])
        self.near: Values | None = None
        self.outside: list[int] = []
        self.far: deque[int | None] = deque([None] * 8)

    @property
    def room(self) -> bool:
        """An order is allowed in the next clock, unless one arrives in this one."""
        return self.order is None or self.wait or self.x >= self.order["last_x"] - 1

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        o, banks = self.order, self.banks
        read = 0
        if o is not None:
            read = sum(1 << (self.bank + d) % banks
                       for name, d in (("above", -1), ("middle", 0), ("below", 1)) if o["fresh"] and o[name])
        far = self.far.popleft()
        out: Values = {"order_room_o": int(self.room), "read_o": read, "read_x_o": self.x if o else None,
                        **dict.fromkeys(self.FLAGS, 0), **dict.fromkeys(self.VALUES), **(self.near or {}),
                        "far_valid_o": int(far is not None), "far_o": far}
        o = None if self.wait else o
        if i["rst_i"]:
            self.clear()
            return out
        # The column read two clocks ago has its data.
        column = self.reading.popleft()
        self.reading.append((o, self.x, self.bank) if o is not None else None)
        self.near, done = None, None
        if column is not None:
            done = self._take_column(*column, i["data_i"])
        self.far.append(done)
        self.wait = False
        if o is not None:
            self.order, self.x = (None, 0) if self.x == o["last_x"] else (o, self.x + 1)
        if i["order_valid_i"]:
            self.order, self.x, self.bank = SCAN.unpack(i["order_i"]), 0, (self.bank + 1) % banks
            self.wait = bool(self.order["only"])
            self.order["last_x"] *= not self.wait
        return out

    def _take_column(self, o: dict[str, int], x: int, bank: int, data: int) -> int | None:
        """Process a column; returns the best outside the neighbourhood at the end of the row, else None."""
        values = [PRESENT + (data >> (bank + d) % self.banks * SCORE_BITS) % PRESENT if o["fresh"] and o[name] else 0
                  for name, d in (("above", -1), ("middle", 0), ("below", 1))]
        side = x - o["best_x"]
        self.near = {"near_end_o": int(o["last"] and x == o["last_x"]), "near_first_o": int(x == 0),
                     "near_west_o": int(side == -1), "near_centre_o": int(side == 0), "near_east_o": int(side == 1),
                     **dict(zip(("near_above_o", "near_middle_o", "near_below_o"), values, strict=True))}
        if not o["fresh"]:
            self.near = {"near_end_o": self.near["near_end_o"]}
        if x == 0:
            self.outside = []
        self.outside += values if abs(side) > 1 else [0]
        return max(self.outside) if x == o["last_x"] else None
