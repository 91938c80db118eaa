# SPDX-License-Identifier: Apache-2.0
"""`slog_mult` and its ECP5 twin against one cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from golden.cycle.cells.mult import BITS, MultModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 2000
EXTREMES = (0, 1, 1 << BITS - 1, (1 << BITS - 1) - 1, (1 << BITS) - 1)


def _operand(rng: random.Random) -> int:
    return rng.choice(EXTREMES) if rng.random() < 0.4 else rng.getrandbits(BITS)


def _products(rng: random.Random) -> Stimulus:
    """Runs of extreme and random operands; a new coefficient before each run, constant within it."""
    b, left = _operand(rng), 0
    for _ in range(CLOCKS):
        if left == 0:
            left = rng.randint(1, 12)
            b = _operand(rng)
            for _ in range(rng.randint(1, 2)):
                yield {"en_i": 0, "a_i": _operand(rng), "b_i": b}
        left -= 1
        yield {"en_i": 1, "a_i": _operand(rng), "b_i": b}


@cocotb.test()
async def every_clock(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: set[int] = set()

    def count(_: Inputs, out: Outputs) -> None:
        if out["p_o"] is not None:
            seen.add(out["p_o"])

    await check_cycles(dut, MultModel(), _products(rng), count, reset_clocks=0)
    assert len(seen) > CLOCKS // 4


@pytest.mark.parametrize("ecp5", [False, True], ids=["generic", "ecp5"])
def test_mult(ecp5: bool) -> None:
    simulate("slog_mult", __name__, ecp5=ecp5)
