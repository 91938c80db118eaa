"""`slog_control` and the generated registers: every clock against their model, every field over AXI4-Lite."""

from sim.testbench.runner import simulate

SOURCES = ["rtl/slog_pkg.sv", "rtl/gen/tiny/slog_cfg_pkg.sv", "rtl/gen/slog_csr_pkg.sv", "rtl/gen/slog_csr.sv",
           "rtl/slog_filter_bank.sv", "rtl/slog_peek.sv", "rtl/slog_axil.sv", "rtl/slog_counters.sv",
           "rtl/slog_clock_gate.sv", "rtl/slog_control.sv"]
PORTS = ("*_i", "*_o", "s_axil_*")


def test_control() -> None:
    simulate("slog_control", SOURCES, "cocotb_tests.control.test_control", ports=PORTS)


def test_registers() -> None:
    simulate("slog_control", SOURCES, "cocotb_tests.control.test_registers", ports=PORTS)
