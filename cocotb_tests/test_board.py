"""The whole `tiny` board against its cycle model on every clock, and what it answers against the frame level."""

from sim.runner import simulate
from sim.toolchain import rtl_sources


def test_board() -> None:
    simulate("slog_board", rtl_sources("tiny"), "cocotb_tests.tb_board", ports=("*_i", "*_o", "s_axil_*"))
