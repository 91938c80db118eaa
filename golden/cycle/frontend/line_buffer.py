# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_line_buffer`."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import pack
from golden.cycle.model import Inputs, Values


class LineBufferModel:
    """The window of a pixel: its column in the last `2 * radius` lines and itself, 7 clocks later; else undefined."""

    INPUTS = ("rst_i", "valid_i", "px_i", "col_i", "bottom_i", "dist_i")
    OUTPUTS = ("window_o",)
    LATENCY = 7

    def __init__(self, max_width: int, radius: int) -> None:
        self.radius = radius
        self.lines: list[deque[int | None]] = [deque([None] * (2 * radius), 2 * radius) for _ in range(max_width)]
        self.pipe: deque[tuple[int, int, Values] | None] = deque([None] * (self.LATENCY - 1))
        self.out: Values = dict.fromkeys(self.OUTPUTS)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        done = self.pipe.pop()
        self.out = done[2] if done else dict.fromkeys(self.OUTPUTS)
        written = self.pipe[3]
        if written:
            self.lines[written[0]].append(written[1])
        self.pipe.appendleft(self._column(i) if i["valid_i"] else None)
        if i["rst_i"]:
            self.pipe = deque([None] * len(self.pipe))
        return out

    def _column(self, i: Inputs) -> tuple[int, int, Values]:
        r, dist = self.radius, i["dist_i"]
        lines = [*self.lines[i["col_i"]], i["px_i"]]
        window = [lines[r + (min(d, dist) if i["bottom_i"] else max(d, -dist))] for d in range(-r, r + 1)]
        return i["col_i"], i["px_i"], {"window_o": pack(window, 8)}
