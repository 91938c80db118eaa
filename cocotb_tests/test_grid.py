"""`slog_grid` against the frame-level grid on every clock."""

from sim.testbench.runner import simulate


def test_grid() -> None:
    simulate("slog_grid", ["rtl/slog_pkg.sv", "rtl/slog_grid.sv"], "cocotb_tests.correlator.test_grid")
