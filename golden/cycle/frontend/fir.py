# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_fir`."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import pack, signed, unpack
from golden.cycle.model import Inputs, Values


def adder_levels(radius: int) -> int:
    """Levels of pairwise addition of the taps and the bias: clog2(radius + 2)."""
    return (radius + 1).bit_length()


def fir_latency(radius: int, sum_bits: int) -> int:
    """Clocks from the window to the sums: sums of more than 24 bits are added in halves, which takes one more."""
    return 7 + adder_levels(radius) + (sum_bits > 24)


class FirModel:
    """Symmetric FIR: `fir_latency` clocks from window to sums; undefined where no window was valid."""

    INPUTS = ("rst_i", "valid_i", "window_i", "coef_i")
    OUTPUTS = ("sum_o",)

    def __init__(self, radius: int, data_bits: int, kernels: int, sum_bits: int, bias: int) -> None:
        self.radius, self.data_bits = radius, data_bits
        self.kernels, self.sum_bits, self.bias = kernels, sum_bits, bias
        self.pipe: deque[int | None] = deque([None] * (fir_latency(radius, sum_bits) - 1))
        self.sum: int | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out: Values = {"sum_o": self.sum}
        self.sum = self.pipe.pop()
        self.pipe.appendleft(self._sums(i) if i["valid_i"] else None)
        if i["rst_i"]:
            self.pipe = deque([None] * len(self.pipe))
        return out

    def _sums(self, i: Inputs) -> int | None:
        r, n = self.radius, self.data_bits
        window = [i["window_i"] >> (n * k) & ((1 << n) - 1) for k in range(2 * r + 1)]
        sums = []
        for k in range(self.kernels):
            half = unpack(i["coef_i"] >> (18 * (r + 1) * k), 18, r + 1)
            folds = (sum(window[p] for p in {r - d, r + d}) for d in range(r + 1))
            sums.append(self.bias + sum(c * signed(fold, 18) for c, fold in zip(half, folds, strict=True)))
        return pack(sums, self.sum_bits)
