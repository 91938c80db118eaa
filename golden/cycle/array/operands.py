# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_operands`."""

from __future__ import annotations

from collections import deque

from golden.cycle.array.timing import OPERAND_LATENCY, hold_clocks
from golden.cycle.model import Inputs, Values
from golden.structs import STEP


class OperandsModel:
    """Template banks and search ring as dictionaries of words, read when a step arrives.

    Assumes the rules of the module: a word is written before it is read, and not overwritten while it is read. A word
    never written makes the operand undefined.
    """

    INPUTS = ("rst_i", "wr_valid_i", "wr_tpl_i", "wr_wide_i", "wr_bank_i", "wr_row_i", "wr_word_i", "wr_data_i",
              "step_i")
    OUTPUTS = ("move_o", "valid_o", "first_o", "last_o", "row_b_o", "lanes_o", "tpl_a_o", "tpl_b_o", "search_a_o",
               "search_b_o")

    def __init__(self, group_bits: int, ring_rows: int, hold_idle: bool = True) -> None:
        self.group_bits, self.pitch, self.ring_rows = group_bits, group_bits // 2, ring_rows
        self.hold_idle = hold_idle
        self.lane_mask = (1 << (self.pitch + 1).bit_length()) - 1
        self.hold_clocks = hold_clocks(group_bits, self.pitch + 1)
        self.tpl: dict[tuple[int, int, int], int] = {}  # (bank, group, step) -> word
        self.ring: dict[tuple[int, int], int] = {}  # (row, word) -> word
        # Steps in flight, newest first: control bits and operands.
        self.flight: deque[Values] = deque([{"valid": 0}] * (OPERAND_LATENCY - 1))
        self.out: Values = dict.fromkeys(self.OUTPUTS)
        self.hold = 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        ready = self.flight.pop()
        valid, row_b = ready["valid"], ready.get("row_b")
        self.out = {
            "move_o": int(bool(i["rst_i"] or valid or self.hold or not self.hold_idle)),
            "valid_o": valid and int(not i["rst_i"]),
            **{f"{name}_o": ready.get(name) for name in ("first", "last", "row_b", "lanes")},
            **{f"{name}_a_o": ready[f"{name}_a"] if valid else 0 for name in ("tpl", "search")},
            **{f"{name}_b_o": ready[f"{name}_b"] if valid and row_b else 0 for name in ("tpl", "search")}}
        self.hold = self.hold_clocks if i["rst_i"] or valid else max(self.hold - 1, 0)
        self.flight.appendleft(self._operands(STEP.unpack(i["step_i"])))
        if i["rst_i"]:
            self.flight = deque({**f, "valid": 0} for f in self.flight)
        if i["wr_valid_i"]:
            self._write(i)
        return out

    def _write(self, i: Inputs) -> None:
        row, word, data = i["wr_row_i"], i["wr_word_i"], i["wr_data_i"]
        if not i["wr_tpl_i"]:
            self.ring[row, word] = data
        elif i["wr_wide_i"]:
            self.tpl[i["wr_bank_i"], word, row] = data
        else:
            self.tpl[i["wr_bank_i"], row & 1, row >> 1] = data

    def _operands(self, s: dict[str, int]) -> Values:
        operands: Values = {name: s[name] for name in ("valid", "first", "last", "row_b")}
        operands["lanes"] = s["lanes"] & self.lane_mask
        if s["valid"]:
            row_b = s["ring_row"] if s["wide"] else (s["ring_row"] + 1) % self.ring_rows
            operands |= {
                "tpl_a": self.tpl.get((s["bank"], 0, s["tpl_step"])),
                "tpl_b": self.tpl.get((s["bank"], 1, s["tpl_step"])),
                "search_a": self._units(s["ring_row"], s["chunk"]),
                "search_b": self._units(row_b, s["chunk"] + 2 * s["wide"])}
        return operands

    def _units(self, row: int, unit: int) -> int | None:
        """Three units of `pitch` bits of a ring row from `unit` on, the first in the lowest bits."""
        value = 0
        for k in range(3):
            word = self.ring.get((row, (unit + k) >> 1))
            if word is None:
                return None
            value |= (word >> (self.pitch * ((unit + k) & 1)) & (1 << self.pitch) - 1) << (self.pitch * k)
        return value
