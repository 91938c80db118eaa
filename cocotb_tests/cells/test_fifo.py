# SPDX-License-Identifier: Apache-2.0
"""`slog_fifo` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from golden.cycle.cells.fifo import FifoModel
from golden.cycle.model import Inputs, Outputs
from golden.traffic.queue import queue_words
from golden.traffic.stalls import SHAPES
from sim.testbench.runner import simulate

CLOCKS = 600


@cocotb.test()
@cocotb.parametrize(source=SHAPES, sink=SHAPES)
async def every_clock(dut, source: str, sink: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    popped = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal popped
        popped += bool(out["out_valid_o"] and i["out_ready_i"])

    def enough() -> bool:
        return popped > CLOCKS // 10

    model = FifoModel(params()["Depth"])
    await check_cycles(dut, model, queue_words(rng, source, sink, params()["Width"], CLOCKS, enough), count)
    assert enough()


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "cells", FifoModel(params()["Depth"]))


@pytest.mark.parametrize(("width", "depth"), [(8, 4), (1, 1), (19, 7)])
def test_fifo(width: int, depth: int) -> None:
    simulate("slog_fifo", __name__, {"Width": width, "Depth": depth})
