"""`slog_ram_fifo` against its cycle model on every clock."""

import pytest

from sim.testbench.runner import simulate


@pytest.mark.parametrize(("width", "depth"), [(8, 13), (20, 16)])
def test_ram_fifo(width: int, depth: int) -> None:
    simulate("slog_ram_fifo", ["rtl/slog_ram.sv", "rtl/slog_fifo.sv", "rtl/slog_ram_fifo.sv"],
             "cocotb_tests.cells.test_ram_fifo", {"Width": width, "Depth": depth})
