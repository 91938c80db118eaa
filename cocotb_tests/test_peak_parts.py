"""The parts of `slog_peak`, each against its cycle model on every clock."""

from cocotb_tests.test_peak import PARTS
from sim.testbench.runner import simulate

SOURCES = ["rtl/slog_pkg.sv", "rtl/slog_compare_pkg.sv", "rtl/slog_peak_pkg.sv", "rtl/slog_stage.sv",
           *(f"rtl/slog_{name}.sv" for name in PARTS),
           "sim/tb/tb_peak_parts.sv"]


def test_peak_parts() -> None:
    simulate("tb_peak_parts", SOURCES, "cocotb_tests.peak.test_peak_parts",
             {"MaxOffsets": 48, "ScoreBits": 9, "ScoreDepth": 128})
