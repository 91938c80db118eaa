"""`slog_fetch` and its parts against their cycle models on every clock.

The parts are tried at full size; at tiny size they are inside `slog_fetch`.
"""

from golden.params import FULL, TINY
from sim.testbench.runner import simulate

PACKAGES = ["rtl/slog_pkg.sv", "rtl/slog_fetch_pkg.sv"]


def test_align() -> None:
    simulate("slog_align", ["rtl/slog_align.sv"], "cocotb_tests.correlator.test_align", {"Width": FULL.group_bits, "SideW": 8})


def test_job_check() -> None:
    simulate("slog_job_check", ["rtl/slog_pkg.sv", "rtl/slog_job_check.sv"], "cocotb_tests.correlator.test_job_check",
             {"MinWindow": FULL.min_window, "MaxWindow": FULL.max_window, "Slots": FULL.slots})


def test_job_plan() -> None:
    simulate("slog_job_plan", [*PACKAGES, "rtl/slog_job_plan.sv"], "cocotb_tests.correlator.test_job_plan",
             {"Width": FULL.group_bits, "MaxHeight": FULL.max_height, "WordsPerRow": FULL.words_per_row})


def test_fetch() -> None:
    c = TINY
    simulate("slog_fetch",
             ["rtl/slog_pkg.sv", "rtl/slog_store_pkg.sv", "rtl/slog_fetch_pkg.sv", "rtl/slog_align.sv",
              "rtl/slog_job_check.sv", "rtl/slog_job_plan.sv", "rtl/slog_fetch.sv"], "cocotb_tests.correlator.test_fetch",
             {"Width": c.group_bits, "MaxHeight": c.max_height, "WordsPerRow": c.words_per_row, "Slots": c.slots,
              "MinWindow": c.min_window, "MaxWindow": c.max_window, "RingRows": c.ring_rows})
