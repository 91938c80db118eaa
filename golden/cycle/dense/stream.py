# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_stream`."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from golden.cycle.bits import pack
from golden.cycle.dense.structs import ROW
from golden.cycle.model import Inputs, Values

AHEAD = 18
"""Clocks from a column's turn to the clock before it is sent."""


@dataclass(frozen=True)
class _Column:
    """A column on its way to the engine."""

    load: bool
    sent: bool
    first: int
    ok: int
    has: tuple[int, int]


class DenseStreamModel:
    """Columns of one plane's rows. Bits and flags are undefined without valid_o, addresses before the first row.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "start_i", "row_i", "mask_i", "grant_i", "came_i", "data_i")
    OUTPUTS = ("want_o", "addr_o", "valid_o", "first_o", "incoming_o", "leaving_o", "ok_o", "busy_o")

    def __init__(self, width: int, addr_bits: int) -> None:
        self.width, self.addr_bits = width, addr_bits
        self.addresses: list[int | None] = [None, None]
        self.came: list[int | None] = [None, None]
        self.held: list[int | None] = [None, None]
        self.row: dict[str, int] = {}
        self._stop()

    def _stop(self) -> None:
        self.at: int | None = None
        """The column whose turn it is, from the row's first."""
        self.want = [0, 0]
        self.granted = 0
        """Grants of the clock before: the next addresses follow them."""
        self.columns: deque[_Column | None] = deque([None] * AHEAD)
        self.shown: _Column | None = None
        self.busy = 0
        self.some = [False, False]
        """Whether a column was in turn or on its way, one and two clocks ago."""
        self.coming = 0
        """The row of the clock before, which a start begins."""

    @property
    def out(self) -> Values:
        shown = self.shown if self.shown and self.shown.sent else None
        bits = [None if word is None or not shown else word & 1 for word in self.held]
        return {"want_o": self.want[0] | self.want[1] << 1, "addr_o": pack(self.addresses, self.addr_bits),
                "valid_o": int(bool(shown)), "first_o": shown.first if shown else None, "incoming_o": bits[0],
                "leaving_o": bits[1], "ok_o": shown.ok if shown else None, "busy_o": self.busy}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        now = self.columns.pop()
        under_way = now is not None or any(self.columns) or self.at is not None
        begun = bool(i["start_i"]) or self.at is not None
        self.busy, self.some = int(begun or self.some[1]), [under_way, self.some[0]]
        for n in range(2):
            if now and now.load:
                self.held[n] = self.came[n] if now.has[n] else 0
            elif (word := self.held[n]) is not None:
                self.held[n] = word >> 1
            if i["came_i"] >> n & 1:
                self.came[n] = i["data_i"]
            if i["grant_i"] >> n & 1:
                self.want[n] = 0
            if self.granted >> n & 1:
                address = self.addresses[n]
                self.addresses[n] = None if address is None else address + 1 & (1 << self.addr_bits) - 1
        self.granted = i["grant_i"] & 3
        self.shown = now
        self.columns.appendleft(self._turn(i["mask_i"]))
        if i["start_i"]:
            self.row, self.at = ROW.unpack(self.coming), 0
            self.addresses = [self.row[name] & (1 << self.addr_bits) - 1 for name in ("incoming", "leaving")]
        if i["rst_i"]:
            self._stop()
        self.coming = i["row_i"]
        return out

    def _turn(self, mask: int) -> _Column | None:
        """The column whose turn it is; the next one's is in the next clock."""
        if self.at is None:
            return None
        row, at = self.row, self.at
        has = row["has_incoming"], row["has_leaving"]
        load = at % self.width == 0
        if load:
            self.want = [want | some for want, some in zip(self.want, has, strict=True)]
        self.at = at + 1 if at + 1 < row["count"] else None
        within = row["column"] + at + 1 & mask
        return _Column(load, at >= row["skip"], row["first"], row["ok"] if within else 0, has)
