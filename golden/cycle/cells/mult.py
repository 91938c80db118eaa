# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_mult`."""

from __future__ import annotations

from golden.cycle.bits import signed
from golden.cycle.model import Inputs, Values

BITS = 18
"""Bits of a factor."""


class MultModel:
    """Signed 18 x 18 -> 36 bits in three registers; b, a coefficient, is loaded while `en_i` is low.

    The product is undefined until three enabled clocks have followed the load.
    """

    INPUTS = ("en_i", "a_i", "b_i")
    OUTPUTS = ("p_o",)

    def __init__(self) -> None:
        self.a: int | None = None
        self.b: int | None = None
        self.product: int | None = None
        self.out: int | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        if i["en_i"]:
            self.out = self.product
            self.product = None if self.a is None or self.b is None else (self.a * self.b) & (1 << 2 * BITS) - 1
            self.a = signed(i["a_i"], BITS)
        else:
            self.b = signed(i["b_i"], BITS)
            self.a = self.product = self.out = None
        return {"p_o": out}
