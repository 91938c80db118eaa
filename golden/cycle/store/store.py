# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_store`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values

STORE_LATENCY = 10
"""Clocks from a read to its data, as in rtl/store/slog_store_pkg.sv."""


class StoreModel:
    """A read returns all writes of two clocks before and earlier; its word must not be written in the clock before.

    A peek reads likewise, but of a word written in the clock before it gives an undefined value. Words never written,
    and data before the first read, are undefined.
    """

    INPUTS = ("rst_i", "wr_valid_i", "wr_addr_i", "wr_data_i", "rd_valid_i", "rd_addr_i", "peek_valid_i", "peek_addr_i")
    OUTPUTS = ("rd_data_o", "peek_ready_o", "peek_done_o", "peek_data_o")

    def __init__(self, words: int) -> None:
        self.memory: list[int | None] = [None] * words
        self.flight: list[tuple[int, bool] | None] = [None] * (STORE_LATENCY - 1)
        self.write: tuple[int, int] | None = None  # write of the clock before
        self.data: int | None = None
        self.pending: int | None = None
        self.peeking = False
        self.done = False

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = self.pending is None and not self.peeking
        out: Values = {"rd_data_o": self.data, "peek_ready_o": int(ready),
                                      "peek_done_o": int(self.done), "peek_data_o": self.data}
        read: tuple[int, bool] | None = None
        if i["rd_valid_i"]:
            read = i["rd_addr_i"], False
        elif self.pending is not None:
            read = self.pending, True
            self.pending = None
            self.peeking = True
        if i["peek_valid_i"] and ready:
            self.pending = i["peek_addr_i"]
        # Reading the memory at once is equivalent: a write reaches it one clock later than a read.
        arrived = self.flight.pop()
        self.done = False
        if arrived is not None:
            self.data = arrived[0] if arrived[0] >= 0 else None
            self.done = arrived[1]
        self.flight.insert(0, None if read is None else (self._word(*read), read[1]))
        if self.write is not None:
            self.memory[self.write[0]] = self.write[1]
        self.write = (i["wr_addr_i"], i["wr_data_i"]) if i["wr_valid_i"] else None
        if self.done:
            self.peeking = False
        if i["rst_i"]:
            self.pending, self.peeking, self.done = None, False, False
            self.flight = [None if f is None else (f[0], False) for f in self.flight]
        return out

    def _word(self, address: int, peek: bool) -> int:
        """The word a read finds, -1 if undefined."""
        collides = peek and self.write is not None and self.write[0] == address
        word = self.memory[address]
        return -1 if word is None or collides else word
