# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_ram`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class RamModel:
    """One write and one read port; the word read appears two clocks later and is held until the next one."""

    INPUTS = ("wr_en_i", "wr_addr_i", "wr_data_i", "rd_en_i", "rd_addr_i")
    OUTPUTS = ("rd_data_o",)

    def __init__(self) -> None:
        self.words: dict[int, int] = {}
        self.read: int | None = None
        self.out: int | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        self.out = self.read
        if i["rd_en_i"]:
            self.read = self.words.get(i["rd_addr_i"])
        if i["wr_en_i"]:
            self.words[i["wr_addr_i"]] = i["wr_data_i"]
        return {"rd_data_o": out}
