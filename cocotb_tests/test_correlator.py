"""`slog_correlator`, the blocks wired together, against the joined cycle models on every clock and the frame level."""

from pathlib import Path

from golden.params import TINY
from sim.testbench.runner import simulate
from sim.toolchain import RTL, rtl_sources


def sources() -> list[Path]:
    """Everything up to the correlator that belongs to it, in the board's order of compilation."""
    parts = ("pkg", "ram", "fifo", "fetch", "align", "job_", "walker", "sequencer", "search_ring", "operands", "lanes",
             "add_halves", "popcount", "accumulator", "emit", "array", "running_max", "peak", "correlator")
    return [p for p in rtl_sources(TINY.name) if p.parent == RTL and any(part in p.name for part in parts)]


# The tiny board's queue of scores holds little more than one row of the image; here it holds two, for grants at once.
SCORE_DEPTH = 2 * TINY.max_width


def test_correlator() -> None:
    c = TINY
    simulate("slog_correlator", sources(), "cocotb_tests.correlator.test_correlator", {
        "GroupBits": c.group_bits, "Pitch": c.pitch, "Lanes": c.lanes, "ScoreBits": c.score_bits,
        "MaxWidth": c.max_width, "MaxHeight": c.max_height, "WordsPerRow": c.words_per_row, "Slots": c.slots,
        "MinWindow": c.min_window, "MaxWindow": c.max_window, "RingRows": c.ring_rows, "SurfaceDepth": SCORE_DEPTH,
        "ResultDepth": c.result_depth})
