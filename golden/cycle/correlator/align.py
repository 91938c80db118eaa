# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_align`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class AlignModel:
    """Pairs each store word with the next clock's word and shifts the pair right; else undefined."""

    INPUTS = ("rst_i", "in_valid_i", "in_emit_i", "in_data_i", "in_shift_i", "in_side_i")
    OUTPUTS = ("out_valid_o", "out_data_o", "out_side_o")

    def __init__(self, width: int) -> None:
        self.width = width
        stages = width.bit_length() // 2
        self.latency = 2 + stages
        self.valid = [0] * self.latency
        self.first: tuple[int, int] | None = None
        self.data: list[int | None] = [None] * stages
        self.out: int | None = None
        self.side: list[int | None] = [None] * self.latency

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = {"out_valid_o": self.valid[-1], "out_data_o": self.out, "out_side_o": self.side[-1]}
        self.out = self.data[-1]
        word: int | None = None
        if self.valid[0] and self.first is not None:
            low, shift = self.first
            word = (i["in_data_i"] << self.width | low) >> shift & (1 << self.width) - 1
        self.data = [word, *self.data[:-1]]
        begins = i["in_valid_i"] & i["in_emit_i"]
        if begins:
            self.first = i["in_data_i"], i["in_shift_i"]
        self.side = [i["in_side_i"] if begins else None, *self.side[:-1]]
        self.valid = [0] * self.latency if i["rst_i"] else [begins, *self.valid[:-1]]
        return out
