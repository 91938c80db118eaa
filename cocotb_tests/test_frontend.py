"""The front end and its parts against their cycle models on every clock."""

import pytest

from golden.params import TINY
from sim.testbench.runner import simulate

SIZE = {"MaxWidth": TINY.max_width, "Radius": TINY.radius}
FIR = ["rtl/slog_mult.sv", "rtl/slog_fir_kernel.sv", "rtl/slog_fir.sv"]
LINES = ["rtl/slog_ram.sv", "rtl/slog_line_bank.sv", "rtl/slog_line_buffer.sv"]
TAPS = ["rtl/slog_taps_slice.sv", "rtl/slog_taps_window.sv", "rtl/slog_taps.sv"]
LOG = [*LINES, *FIR, *TAPS, "rtl/slog_log.sv"]


def test_video_in() -> None:
    simulate("slog_video_in", ["rtl/slog_ram.sv", "rtl/slog_video_in.sv"], "cocotb_tests.frontend.test_video_in", SIZE)


def test_line_buffer() -> None:
    simulate("slog_line_buffer", LINES, "cocotb_tests.frontend.test_line_buffer", SIZE)


@pytest.mark.parametrize("shape", [
    {"Radius": 8, "DataW": 8, "Kernels": 2, "SumW": 24, "Bias": 64},
    {"Radius": 8, "DataW": 32, "Kernels": 1, "SumW": 36, "Bias": -1},
    {"Radius": 3, "DataW": 18, "Kernels": 1, "SumW": 36, "Bias": 5},
], ids=["column", "row", "small"])
def test_fir(shape: dict[str, int]) -> None:
    simulate("slog_fir", FIR, "cocotb_tests.frontend.test_fir", shape)


def test_taps() -> None:
    simulate("slog_taps", TAPS, "cocotb_tests.frontend.test_taps", {"Radius": TINY.radius, "DataW": 18})


def test_log() -> None:
    simulate("slog_log", LOG, "cocotb_tests.frontend.test_log", SIZE)


@pytest.mark.parametrize("group_bits", [4, 8])
def test_packer(group_bits: int) -> None:
    simulate("slog_packer", ["rtl/slog_packer.sv"], "cocotb_tests.frontend.test_packer", {"GroupBits": group_bits})


def test_frontend() -> None:
    sources = [*LOG, "rtl/slog_video_in.sv", "rtl/slog_packer.sv", "rtl/slog_frontend.sv"]
    simulate("slog_frontend", sources, "cocotb_tests.frontend.test_frontend", {**SIZE, "GroupBits": TINY.group_bits})
