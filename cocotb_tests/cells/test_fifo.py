"""`slog_fifo` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.cells.fifo import FifoModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.traffic.stalls import SHAPES, willing
from sim.testbench.runner import simulate

CLOCKS = 600


def traffic(rng: random.Random, source: str, sink: str, width: int) -> Stimulus:
    """Random words with both ends stalled; one reset in mid-traffic."""
    offer, take = willing(source, rng), willing(sink, rng)
    held: int | None = None
    for t in range(CLOCKS):
        if held is None and next(offer):
            held = rng.getrandbits(width)
        valid = held is not None
        out = yield {"rst_i": int(t == CLOCKS // 2), "in_valid_i": int(valid),
                     "in_data_i": held if held is not None else rng.getrandbits(width), "out_ready_i": next(take)}
        if valid and out["in_ready_o"]:
            held = None


@cocotb.test()
@cocotb.parametrize(source=SHAPES, sink=SHAPES)
async def every_clock(dut, source: str, sink: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    popped = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal popped
        popped += bool(out["out_valid_o"] and i["out_ready_i"])

    model = FifoModel(params()["Depth"])
    await check_cycles(dut, model, traffic(rng, source, sink, params()["Width"]), count)
    assert popped > CLOCKS // 10


@pytest.mark.parametrize(("width", "depth"), [(8, 4), (1, 1), (19, 7)])
def test_fifo(width: int, depth: int) -> None:
    simulate("slog_fifo", __name__, {"Width": width, "Depth": depth})
