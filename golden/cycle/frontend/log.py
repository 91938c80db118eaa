# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_log`."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice

from golden.cycle.bits import or_zero, unpack
from golden.cycle.frontend.fir import adder_levels
from golden.cycle.model import Inputs, Values
from golden.log import ROUND_BITS, Coefs


@dataclass
class _Row:
    """An output row in work: (v, v2) per column so far, None where a line above has never been written."""

    values: list[tuple[int, int] | None] = field(default_factory=list)


def pixel_inputs(video: Mapping[str, int | None]) -> Inputs:
    """The `px_` outputs of `slog_video_in` as inputs of `slog_log`, which ignores those that are undefined."""
    return {f"{name[:-2]}_i": or_zero(value) for name, value in video.items() if name.startswith("px_")}


class LogModel:
    """The LoG by its definition: columns are computed when their pixel arrives, responses when they are due."""

    INPUTS = ("rst_i", "g_i", "g2_i", "px_valid_i", "px_data_i", "px_col_i", "px_first_i", "px_last_i", "px_out_i",
              "px_bottom_i", "px_dist_i", "px_live_i", "px_start_i", "px_done_i", "px_abort_i")
    OUTPUTS = ("bit_valid_o", "bit_o", "bit_last_o", "bit_start_o", "bit_done_o", "bit_abort_o", "busy_o")

    def __init__(self, max_width: int, radius: int) -> None:
        self.radius = radius
        self.latency = 27 + radius + 2 * adder_levels(radius)
        self.lines: list[deque[int | None]] = [deque([None] * (2 * radius), 2 * radius) for _ in range(max_width)]
        self.row = _Row()
        self.pipe: deque[dict[str, int]] = deque([{} for _ in range(self.latency)])
        self.rows: deque[tuple[_Row, int] | None] = deque([None] * (self.latency - 1))
        self.last: deque[int | None] = deque([None] * self.latency)
        self.bit: int | None = None
        self.busy = 0
        self.kernels: tuple[Coefs, Coefs] = ((), ())
        self.coef_words = (-1, -1)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        r = self.radius
        due, last = self.pipe.pop(), self.last.pop()
        out: Values = {
            "bit_valid_o": due.get("live", 0), "bit_o": self.bit, "bit_last_o": last,
            "bit_start_o": due.get("start", 0), "bit_done_o": due.get("done", 0), "bit_abort_o": due.get("abort", 0),
            "busy_o": self.busy}
        self.busy = int(any(p["out"] or p["live"] or p["abort"] for p in (*islice(self.pipe, 1, None), due) if p))
        if (i["g_i"], i["g2_i"]) != self.coef_words:
            self.coef_words = (i["g_i"], i["g2_i"])
            self.kernels = (tuple(unpack(i["g_i"], 18, r + 1)), tuple(unpack(i["g2_i"], 18, r + 1)))
        self.rows.appendleft(self._take(i))
        at = self.rows.pop()
        self.last.appendleft(i["px_valid_i"] & i["px_out_i"] & i["px_last_i"])
        self.bit = None
        if self.pipe[-1].get("live"):
            assert at is not None
            self.bit = self._bit(*at)
        self.pipe.appendleft({
            "out": i["px_valid_i"] & i["px_out_i"], "live": i["px_live_i"], "start": i["px_start_i"],
            "done": i["px_done_i"], "abort": i["px_abort_i"]})
        if i["rst_i"]:
            self.pipe = deque([{} for _ in range(self.latency)])
            self.last = deque([0] * self.latency)
            self.busy = 0
        return out

    def _take(self, i: Inputs) -> tuple[_Row, int] | None:
        if not i["px_valid_i"]:
            return None
        column = self.lines[i["px_col_i"]]
        window = [*column, i["px_data_i"]]
        column.append(i["px_data_i"])
        if not i["px_out_i"]:
            return None
        if i["px_first_i"]:
            self.row = _Row()
        r, dist = self.radius, i["px_dist_i"]
        known: list[int] = []
        for d in range(-r, r + 1):
            px = window[r + (min(d, dist) if i["px_bottom_i"] else max(d, -dist))]
            if px is None:
                self.row.values.append(None)
                break
            known.append(px)
        else:
            v, v2 = (sum(half[abs(k - r)] * px for k, px in enumerate(known)) for half in self.kernels)
            half_unit = 1 << (ROUND_BITS - 1)
            self.row.values.append(((v + half_unit) >> ROUND_BITS, (v2 + half_unit) >> ROUND_BITS))
        return self.row, len(self.row.values) - 1

    def _bit(self, row: _Row, x: int) -> int | None:
        g, g2 = self.kernels
        total = 0
        for d in range(-self.radius, self.radius + 1):
            pair = row.values[min(max(x + d, 0), len(row.values) - 1)]
            if pair is None:
                return None
            total += g2[abs(d)] * pair[0] + g[abs(d)] * pair[1]
        return int(total > 0)
