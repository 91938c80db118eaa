"""Cycle models of the LoG data path: `slog_line_buffer`, `slog_fir`, `slog_taps`, `slog_log`."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice

from golden.log import ROUND_BITS, Coefs

Bits = dict[str, int | None]


def pack(values: Sequence[int | None], width: int) -> int | None:
    """Fields of `width` bits in one word, the first lowest; None if any is undefined."""
    word = 0
    for i, v in enumerate(values):
        if v is None:
            return None
        word |= (v & ((1 << width) - 1)) << (i * width)
    return word


def signed(word: int, width: int) -> int:
    """Two's complement value of the low `width` bits."""
    word &= (1 << width) - 1
    return word - (1 << width) if word >> (width - 1) else word


def unpack(word: int, width: int, count: int) -> list[int]:
    """`count` signed fields of `width` bits, the lowest first."""
    return [signed(word >> (i * width), width) for i in range(count)]


def levels(radius: int) -> int:
    """Levels of pairwise addition of the taps and the bias: clog2(radius + 2)."""
    return (radius + 1).bit_length()


class LineBufferModel:
    """A column of the last `2 * radius` lines per pixel, 7 clocks later; between columns it is anything."""

    INPUTS = ("rst_i", "valid_i", "px_i", "col_i", "bottom_i", "dist_i")
    OUTPUTS = ("window_o",)
    LATENCY = 7

    def __init__(self, max_width: int, radius: int) -> None:
        self.radius = radius
        self.lines: list[deque[int | None]] = [deque([None] * (2 * radius), 2 * radius) for _ in range(max_width)]
        self.pipe: deque[tuple[int, int, Bits] | None] = deque([None] * (self.LATENCY - 1))
        self.out: Bits = dict.fromkeys(self.OUTPUTS)

    def step(self, i: dict[str, int]) -> Bits:
        """Outputs of this clock, then the edge."""
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

    def _column(self, i: dict[str, int]) -> tuple[int, int, Bits]:
        r, dist = self.radius, i["dist_i"]
        lines = [*self.lines[i["col_i"]], i["px_i"]]
        window = [lines[r + (min(d, dist) if i["bottom_i"] else max(d, -dist))] for d in range(-r, r + 1)]
        return i["col_i"], i["px_i"], {"window_o": pack(window, 8)}


class FirModel:
    """Symmetric FIR. Between sums the output is anything."""

    INPUTS = ("rst_i", "valid_i", "window_i", "coef_i")
    OUTPUTS = ("sum_o",)

    def __init__(self, radius: int, data_bits: int, kernels: int, sum_bits: int, bias: int) -> None:
        self.radius, self.data_bits = radius, data_bits
        self.kernels, self.sum_bits, self.bias = kernels, sum_bits, bias
        self.pipe: deque[int | None] = deque([None] * (5 + levels(radius)))
        self.sum: int | None = None

    def step(self, i: dict[str, int]) -> Bits:
        """Outputs of this clock, then the edge."""
        out: Bits = {"sum_o": self.sum}
        self.sum = self.pipe.pop()
        self.pipe.appendleft(self._sums(i) if i["valid_i"] else None)
        if i["rst_i"]:
            self.pipe = deque([None] * len(self.pipe))
        return out

    def _sums(self, i: dict[str, int]) -> int | None:
        r, n = self.radius, self.data_bits
        window = [i["window_i"] >> (n * k) & ((1 << n) - 1) for k in range(2 * r + 1)]
        sums = []
        for k in range(self.kernels):
            half = unpack(i["coef_i"] >> (18 * (r + 1) * k), 18, r + 1)
            folds = (sum(window[p] for p in {r - d, r + d}) for d in range(r + 1))
            sums.append(self.bias + sum(c * signed(fold, 18) for c, fold in zip(half, folds, strict=True)))
        return pack(sums, self.sum_bits)


@dataclass
class _Tap:
    valid: int = 0
    first: int = 0
    last: int = 0
    a: int = 0
    b: int = 0


class TapsModel:
    """Windows of the horizontal filters, cut from what came where the line around the centre ends."""

    FIELD = 32
    """Bits a value takes in a window."""

    INPUTS = ("rst_i", "valid_i", "first_i", "last_i", "a_i", "b_i")
    OUTPUTS = ("valid_o", "a_window_o", "b_window_o")

    def __init__(self, radius: int) -> None:
        self.radius = radius
        self.taps: deque[_Tap] = deque([_Tap() for _ in range(2 * radius + 2)], 2 * radius + 2)  # the oldest first

    def step(self, i: dict[str, int]) -> Bits:
        """Outputs of this clock, then the edge."""
        r, taps = self.radius, self.taps
        out: Bits = {"valid_o": taps[r].valid, "a_window_o": None, "b_window_o": None}
        if taps[r].valid:
            oldest = next((k for k in range(r, -1, -1) if taps[k].first), 0)
            newest = next((k for k in range(r, 2 * r + 1) if taps[k].last), 2 * r)
            window = [taps[min(max(k, oldest), newest)] for k in range(2 * r + 1)]
            out |= {"a_window_o": pack([t.a for t in window], self.FIELD),
                    "b_window_o": pack([t.b for t in window], self.FIELD)}
        v = i["valid_i"]
        taps.append(_Tap(v, i["first_i"], i["last_i"], i["a_i"], i["b_i"]))
        if i["rst_i"]:
            taps.extend([_Tap() for _ in taps])
        return out


@dataclass
class _Row:
    """A line under which an output row is computed: (v, v2) per column so far, None where lines are missing."""

    values: list[tuple[int, int] | None] = field(default_factory=list)


class LogModel:
    """The whole LoG, from the definition: columns when their pixel comes, responses when they are due."""

    INPUTS = ("rst_i", "g_i", "g2_i", "px_valid_i", "px_data_i", "px_col_i", "px_first_i", "px_last_i", "px_out_i",
              "px_bottom_i", "px_dist_i", "px_live_i", "px_start_i", "px_done_i", "px_abort_i")
    OUTPUTS = ("bit_valid_o", "bit_o", "bit_last_o", "bit_start_o", "bit_done_o", "bit_abort_o", "busy_o")

    def __init__(self, max_width: int, radius: int) -> None:
        self.radius = radius
        self.latency = 23 + radius + 2 * levels(radius)
        self.lines: list[deque[int | None]] = [deque([None] * (2 * radius), 2 * radius) for _ in range(max_width)]
        self.row = _Row()
        self.pipe: deque[dict[str, int]] = deque([{} for _ in range(self.latency)])
        self.rows: deque[tuple[_Row, int] | None] = deque([None] * (self.latency - 1))
        self.last: deque[int | None] = deque([None] * self.latency)
        self.bit: int | None = None
        self.busy = 0
        self.kernels: tuple[Coefs, Coefs] = ((), ())
        self.coef_words = (-1, -1)

    def step(self, i: dict[str, int]) -> Bits:
        """Outputs of this clock, then the edge."""
        r = self.radius
        due, last = self.pipe.pop(), self.last.pop()
        out: Bits = {
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

    def _take(self, i: dict[str, int]) -> tuple[_Row, int] | None:
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
