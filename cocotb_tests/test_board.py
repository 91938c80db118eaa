"""The whole `tiny` board against its cycle model on every clock, and what it answers against the frame level."""

from sim.testbench.runner import simulate
from sim.toolchain import rtl_sources

PORTS = ("*_i", "*_o", "s_axil_*")


def test_board() -> None:
    simulate("slog_board", rtl_sources("tiny"), "cocotb_tests.tb_board", ports=PORTS)


def test_board_with_gated_clocks() -> None:
    """The clocks the fast build stops must not show in any output."""
    simulate("slog_board", rtl_sources("tiny"), "cocotb_tests.tb_board", ports=PORTS, defines={"SLOG_CLOCK_GATE": "1"},
             testcase="everyday_work/shape=random|reset_in_the_middle|broken_frames/shape=none|access_during_work")
