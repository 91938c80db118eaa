"""`slog_capture` against its cycle model on every clock."""

import pytest

from sim.testbench.runner import simulate

SOURCES = ["rtl/slog_capture_channel.sv", "rtl/slog_capture_slice.sv", "rtl/slog_capture.sv"]


@pytest.mark.parametrize("cameras", [2, 1])
def test_capture(cameras: int) -> None:
    simulate("slog_capture", SOURCES, "cocotb_tests.store.test_capture",
             {"Cameras": cameras, "GroupBits": 8, "Slots": 6, "SlotWords": 12, "WordsPerRow": 3})
