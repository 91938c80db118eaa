"""`slog_sequencer` and its walker against their cycle models on every clock."""

from golden.cycle.array.timing import drain_clocks
from golden.params import TINY
from sim.testbench.runner import simulate

PACKAGES = ["rtl/slog_pkg.sv", "rtl/slog_fetch_pkg.sv"]
SIZES = {"Pitch": TINY.pitch, "RingRows": TINY.ring_rows, "DrainClocks": drain_clocks(TINY.group_bits, TINY.lanes)}


def test_walker() -> None:
    simulate("tb_walker", [*PACKAGES, "rtl/slog_walker.sv", "sim/tb/tb_walker.sv"], "cocotb_tests.correlator.test_walker", SIZES)


def test_sequencer() -> None:
    simulate("tb_sequencer", [*PACKAGES, "rtl/slog_walker.sv", "rtl/slog_sequencer.sv", "sim/tb/tb_sequencer.sv"],
             "cocotb_tests.correlator.test_sequencer", {"GroupBits": TINY.group_bits, **SIZES})
