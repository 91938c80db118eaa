# SPDX-License-Identifier: Apache-2.0
"""`slog_line_buffer` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.frontend.line_buffer import LineBufferModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY
from sim.testbench.runner import simulate


def _lines(rng: random.Random, width: int, radius: int, count: int) -> Stimulus:
    """Whole lines with every border distance, pauses between them, and a reset in mid-line once."""
    for n in range(count):
        bottom, dist = rng.getrandbits(1), rng.randint(0, radius)
        for col in range(width):
            yield {"valid_i": 1, "px_i": rng.getrandbits(8), "col_i": col, "bottom_i": bottom, "dist_i": dist}
        if n == count // 2:
            yield {"valid_i": 1, "px_i": 7, "col_i": 0, "bottom_i": 0, "dist_i": 0}
            yield {"rst_i": 1, "valid_i": 1, "px_i": 9, "col_i": 1}
        for _ in range(rng.choice((0, 0, 1, 5))):
            yield {"valid_i": 0, "px_i": rng.getrandbits(8), "col_i": rng.randrange(width), "dist_i": dist}
    for _ in range(8):
        yield {}


@cocotb.test()
@cocotb.parametrize(width=(4, 18, 48))
async def every_clock(dut, width: int) -> None:
    p = params()
    rng = random.Random(cocotb.RANDOM_SEED)
    full = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal full
        full += out["window_o"] is not None

    model = LineBufferModel(p["MaxWidth"], p["Radius"])
    await check_cycles(dut, model, _lines(rng, width, p["Radius"], 70), count)
    assert full > 40 * width


def test_line_buffer() -> None:
    simulate("slog_line_buffer", __name__, {"MaxWidth": TINY.max_width, "Radius": TINY.radius})
