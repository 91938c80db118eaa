"""Cycle model of `slog_operands` feeding `slog_array`."""

from __future__ import annotations

from golden.cycle.array.array import ArrayModel
from golden.cycle.array.operands import OperandsModel


class OperandArrayModel:
    """The two models joined: operand writes, steps and mask in; what goes between them and mismatches out."""

    INPUTS = (*OperandsModel.INPUTS, "mask_i")
    OUTPUTS = (*OperandsModel.OUTPUTS, *ArrayModel.OUTPUTS)

    def __init__(self, group_bits: int, ring_rows: int, hold_idle: bool = True) -> None:
        self.operands = OperandsModel(group_bits, ring_rows, hold_idle)
        self.array = ArrayModel(group_bits, group_bits // 2 + 1)

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        operands = self.operands.step(i)
        joined = {f"{name[:-2]}_i": value or 0 for name, value in operands.items()}
        return {**operands,
                **self.array.step({**joined, "rst_i": i["rst_i"], "mask_i": i["mask_i"]})}
