# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_stage`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class StageModel:
    """One register between two handshakes; `half` takes a word only when empty. Data are undefined when not valid."""

    INPUTS = ("rst_i", "in_valid_i", "in_data_i", "out_ready_i")
    OUTPUTS = ("in_ready_o", "out_valid_o", "out_data_o")

    def __init__(self, half: bool = False) -> None:
        self.half = half
        self.word: int | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = self.word is None or bool(i["out_ready_i"] and not self.half)
        out: Values = {"in_ready_o": int(ready), "out_valid_o": int(self.word is not None),
                                      "out_data_o": self.word}
        if i["rst_i"]:
            self.word = None
        elif ready:
            self.word = i["in_data_i"] if i["in_valid_i"] else None
        elif i["out_ready_i"]:
            self.word = None
        return out
