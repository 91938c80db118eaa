# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_ram_clear`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class RamClearModel:
    """One write and one read port, which reads in every clock; the word appears two clocks later, or 0 if cleared."""

    INPUTS = ("wr_en_i", "wr_addr_i", "wr_data_i", "rd_addr_i", "clear_i")
    OUTPUTS = ("rd_data_o",)

    def __init__(self) -> None:
        self.words: dict[int, int] = {}
        self.read: int | None = None
        self.out: int | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        self.out = 0 if i["clear_i"] else self.read
        self.read = self.words.get(i["rd_addr_i"])
        if i["wr_en_i"]:
            self.words[i["wr_addr_i"]] = i["wr_data_i"]
        return {"rd_data_o": out}
