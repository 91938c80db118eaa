# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_packer`."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

from golden.cycle.model import Values


class PackerModel:
    """Bits into words; the flags follow their pixel by six clocks. Data are undefined while no word is valid."""

    INPUTS = ("rst_i", "bit_valid_i", "bit_i", "bit_last_i", "bit_start_i", "bit_done_i", "bit_abort_i")
    OUTPUTS = ("word_valid_o", "word_data_o", "word_last_o", "frame_start_o", "frame_done_o", "frame_abort_o")

    def __init__(self, group_bits: int) -> None:
        self.group_bits = group_bits
        self._reset()

    def _reset(self) -> None:
        self.bits: list[int | None] = []
        none: Values = {**dict.fromkeys(self.OUTPUTS, 0), "word_data_o": None, "word_last_o": None}
        self.pipe = deque([none] * 6)

    def step(self, i: Mapping[str, int | None]) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        valid = i["bit_valid_i"]
        new: Values = {"word_valid_o": 0, "word_data_o": None, "word_last_o": None, "frame_start_o": i["bit_start_i"],
                     "frame_done_o": i["bit_done_i"], "frame_abort_o": i["bit_abort_i"]}
        if valid:
            self.bits.append(i["bit_i"])
            if i["bit_last_i"] or len(self.bits) == self.group_bits:
                known = [b for b in self.bits if b is not None]
                new |= {"word_valid_o": 1, "word_last_o": i["bit_last_i"], "word_data_o":
                        sum(b << n for n, b in enumerate(known)) if len(known) == len(self.bits) else None}
                self.bits = []
        if i["bit_abort_i"]:
            self.bits = []
        self.pipe.append(new)
        out = self.pipe.popleft()
        if i["rst_i"]:
            self._reset()
        return out
