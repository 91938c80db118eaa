"""`slog_ram`, and its twin on ECP5 block RAMs, against one cycle model on every clock."""

import pytest

from sim.testbench.runner import simulate

GENERIC = ["rtl/slog_ram.sv"]
ECP5 = ["sim/ecp5/cells.sv", "rtl/ecp5/slog_ecp5_bram.sv", "rtl/ecp5/slog_ram.sv"]


@pytest.mark.parametrize(("width", "depth"), [(8, 16), (65, 640)])
def test_generic(width: int, depth: int) -> None:
    simulate("slog_ram", GENERIC, "cocotb_tests.cells.test_ram", {"Width": width, "Depth": depth})


ASPECTS = [(37, 512), (19, 1024), (8, 1920), (5, 4000), (3, 8192), (2, 12416)]
"""Widths and depths, one for each aspect of the block."""


@pytest.mark.parametrize(("width", "depth"), ASPECTS)
def test_ecp5(width: int, depth: int) -> None:
    simulate("slog_ram", ECP5, "cocotb_tests.cells.test_ram", {"Width": width, "Depth": depth})
