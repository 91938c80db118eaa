"""`slog_fifo` against its cycle model on every clock."""

import pytest

from sim.testbench.runner import simulate


@pytest.mark.parametrize(("width", "depth"), [(8, 4), (1, 1), (19, 7)])
def test_fifo(width: int, depth: int) -> None:
    simulate("slog_fifo", ["rtl/slog_fifo.sv"], "cocotb_tests.cells.test_fifo", {"Width": width, "Depth": depth})
