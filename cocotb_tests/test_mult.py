"""`slog_mult`, and its twin on the ECP5 multiplier, against one cycle model on every clock."""

import pytest

from sim.testbench.runner import simulate

TWINS = {"generic": ["rtl/slog_mult.sv"], "ecp5": ["sim/ecp5/cells.sv", "rtl/ecp5/slog_mult.sv"]}


@pytest.mark.parametrize("twin", TWINS)
def test_mult(twin: str) -> None:
    simulate("slog_mult", TWINS[twin], "cocotb_tests.cells.test_mult")
