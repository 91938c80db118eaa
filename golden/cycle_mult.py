"""Cycle model of `slog_mult`."""

from __future__ import annotations

BITS = 18


def signed(value: int, bits: int) -> int:
    """Two's complement `bits`-bit `value` as a Python integer."""
    return value - (1 << bits) if value >> (bits - 1) else value


class MultModel:
    """Signed 18 x 18 -> 36 bits in three registers with one enable."""

    INPUTS = ("en_i", "a_i", "b_i")
    OUTPUTS = ("p_o",)

    def __init__(self) -> None:
        self.operands: tuple[int, int] | None = None
        self.product: int | None = None
        self.out: int | None = None

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        if i["en_i"]:
            self.out = self.product
            a, b = self.operands or (None, None)
            self.product = None if a is None or b is None else (a * b) & (1 << 2 * BITS) - 1
            self.operands = signed(i["a_i"], BITS), signed(i["b_i"], BITS)
        return {"p_o": out}
