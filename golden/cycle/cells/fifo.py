# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_fifo`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values


class FifoModel:
    """Queue of `depth` words, at least 1; the front word is at the output. Data are undefined while empty."""

    INPUTS = ("rst_i", "in_valid_i", "in_data_i", "out_ready_i")
    OUTPUTS = ("in_ready_o", "out_valid_o", "out_data_o", "level_o")

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.words: deque[int] = deque()

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        w = self.words
        out: Values = {
            "in_ready_o": int(len(w) < self.depth),
            "out_valid_o": int(bool(w)),
            "out_data_o": w[0] if w else None,
            "level_o": len(w),
        }
        push, pop = i["in_valid_i"] and out["in_ready_o"], w and i["out_ready_i"]
        if i["rst_i"]:
            w.clear()
        else:
            if pop:
                w.popleft()
            if push:
                w.append(i["in_data_i"])
        return out
