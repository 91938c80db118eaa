# SPDX-License-Identifier: Apache-2.0
"""`slog_ram_fifo` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.cells.ram_fifo import RamFifoModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.traffic.queue import queue_words
from golden.traffic.stalls import SHAPES
from sim.testbench.runner import simulate

CLOCKS = 1200


@cocotb.test()
@cocotb.parametrize(source=SHAPES, sink=SHAPES)
async def every_clock(dut, source: str, sink: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    depth, popped, full = params()["Depth"], 0, 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal popped, full
        popped += bool(out["out_valid_o"] and i["out_ready_i"])
        full += not out["in_ready_o"]

    stimulus = queue_words(rng, source, sink, params()["Width"], CLOCKS)
    await check_cycles(dut, RamFifoModel(depth), stimulus, count)
    assert popped > CLOCKS // 20
    if source == "none" and sink != "none":
        assert full > 0


@cocotb.test()
async def rate_and_latency(dut) -> None:
    """Five clocks of latency, then a word per clock."""
    model, words = RamFifoModel(params()["Depth"]), 60
    seen: list[tuple[int, int | None]] = []

    def source(count: int) -> Stimulus:
        for t in range(count + 6):
            out = yield {"rst_i": 0, "in_valid_i": int(t < count), "in_data_i": t, "out_ready_i": 1}
            if out["out_valid_o"]:
                seen.append((t, out["out_data_o"]))

    await check_cycles(dut, model, source(words))
    assert seen == [(t + 5, t) for t in range(words)]
    assert model.level == 0


@cocotb.test()
async def full_and_flowing(dut) -> None:
    """Once full, a word out and a word in on every clock."""
    depth = params()["Depth"]
    steady = 0

    def source() -> Stimulus:
        nonlocal steady
        for t in range(depth + 60):
            popping = t > depth + 10
            out = yield {"rst_i": 0, "in_valid_i": 1, "in_data_i": t % 256, "out_ready_i": int(popping)}
            if popping and t > depth + 12:
                assert out["out_valid_o"]
                steady += 1

    await check_cycles(dut, RamFifoModel(depth), source())
    assert steady >= 40


@pytest.mark.parametrize(("width", "depth"), [(8, 13), (20, 16)])
def test_ram_fifo(width: int, depth: int) -> None:
    simulate("slog_ram_fifo", __name__, {"Width": width, "Depth": depth})
