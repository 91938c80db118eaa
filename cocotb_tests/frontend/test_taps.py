# SPDX-License-Identifier: Apache-2.0
"""`slog_taps` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.frontend.taps import TapsModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY
from sim.testbench.runner import simulate


def _lines(rng: random.Random, radius: int, width: int, bits: int) -> Stimulus:
    """Lines of the shortest length and more, with pauses of up to more than the window; resets in mid-line."""
    for count in range(60):
        length = rng.randint(2 * radius + 2, width)
        cut = rng.randrange(length) if count % 20 == 19 else length
        for x in range(cut):
            yield {"valid_i": 1, "first_i": int(x == 0), "last_i": int(x == length - 1),
                   "a_i": rng.getrandbits(bits), "b_i": rng.getrandbits(bits)}
        if cut < length:
            yield {"rst_i": 1, "valid_i": 1, "first_i": 1, "last_i": 1}
        for _ in range(rng.choice((0, 0, 1, radius - 1, radius, radius + 1, 3 * radius))):
            yield {"valid_i": 0, "a_i": rng.getrandbits(bits), "b_i": rng.getrandbits(bits)}
    for _ in range(2 * radius):
        yield {}


@cocotb.test()
async def every_clock(dut) -> None:
    p = params()
    radius = p["Radius"]
    valid = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal valid
        valid += out["valid_o"] or 0

    await check_cycles(dut, TapsModel(radius), _lines(random.Random(cocotb.RANDOM_SEED), radius, 40, p["DataW"]),
                       count)
    assert valid > 50 * (2 * radius + 2)


def test_taps() -> None:
    """With the widest data that a window holds; the front end uses 18 bits."""
    simulate("slog_taps", __name__, {"Radius": TINY.radius, "DataW": 32})
