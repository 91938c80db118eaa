"""`slog_peak` against its cycle model on every clock, and against the frame-level peak search."""

import pytest

from sim.testbench.runner import simulate

PARTS = ("running_max", "peak_room", "peak_rows", "peak_intake", "peak_best", "peak_scan", "peak_collect")
SOURCES = [f"rtl/slog_{name}.sv" for name in
           ("pkg", "compare_pkg", "peak_pkg", "ram", "fifo", "stage", "ram_fifo", *PARTS, "peak")]


@pytest.mark.parametrize(("max_offsets", "score_bits", "score_depth", "result_depth", "testcase"), [
    (48, 9, 128, 4, None),
    (640, 15, 1024, 64, "results_stalled.*long"),
])
def test_peak(max_offsets: int, score_bits: int, score_depth: int, result_depth: int, testcase: str | None) -> None:
    simulate("slog_peak", SOURCES, "cocotb_tests.peak.test_peak",
             {"MaxOffsets": max_offsets, "ScoreBits": score_bits, "ScoreDepth": score_depth,
              "ResultDepth": result_depth}, testcase=testcase)
