# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_operands` feeding `slog_array`."""

from __future__ import annotations

from golden.cycle.array.array import ArrayModel
from golden.cycle.array.operands import OperandsModel
from golden.cycle.bits import all_or_zero
from golden.cycle.model import Inputs, Values


class OperandArrayModel:
    """The two models joined: operand writes, steps and mask in; the operands between them and the mismatches out."""

    INPUTS = (*OperandsModel.INPUTS, "mask_i")
    OUTPUTS = (*OperandsModel.OUTPUTS, *ArrayModel.OUTPUTS)

    def __init__(self, group_bits: int, ring_rows: int, hold_idle: bool = True) -> None:
        self.operands = OperandsModel(group_bits, ring_rows, hold_idle)
        self.array = ArrayModel(group_bits, group_bits // 2 + 1)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        operands = self.operands.step(i)
        joined = {f"{name[:-2]}_i": value for name, value in all_or_zero(operands).items()}
        return {**operands,
                **self.array.step({**joined, "rst_i": i["rst_i"], "mask_i": i["mask_i"]})}
