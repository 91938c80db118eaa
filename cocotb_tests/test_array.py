"""`slog_array` and `slog_operands` against their cycle models on every clock."""

import pytest

from golden.params import FULL, TINY
from sim.testbench.runner import simulate

PACKAGES = ["rtl/slog_pkg.sv", "rtl/slog_array_pkg.sv"]
ARRAY = ["rtl/slog_lanes.sv", "rtl/slog_add_halves.sv", "rtl/slog_popcount.sv", "rtl/slog_accumulator.sv",
         "rtl/slog_emit.sv", "rtl/slog_array.sv"]
OPERANDS = ["rtl/slog_ram.sv", "rtl/slog_ring_slice.sv", "rtl/slog_search_ring.sv", "rtl/slog_operands.sv"]


@pytest.mark.parametrize(("group_bits", "lanes"), [
    (TINY.group_bits, TINY.lanes), (4, 8), (FULL.group_bits, FULL.lanes)])
def test_array(group_bits: int, lanes: int) -> None:
    simulate("slog_array", [*PACKAGES, *ARRAY], "cocotb_tests.array.test_array", {"GroupBits": group_bits, "Lanes": lanes})


@pytest.mark.parametrize(("group_bits", "ring_rows", "words", "hold_idle"), [
    (TINY.group_bits, TINY.ring_rows, TINY.words_per_row, 1), (16, 64, 4, 0)])
def test_operand_array(group_bits: int, ring_rows: int, words: int, hold_idle: int) -> None:
    simulate("tb_operand_array", [*PACKAGES, *OPERANDS, *ARRAY, "sim/tb/tb_operand_array.sv"],
             "cocotb_tests.array.test_operand_array",
             {"GroupBits": group_bits, "RingRows": ring_rows, "WordsPerRow": words, "HoldIdle": hold_idle})
