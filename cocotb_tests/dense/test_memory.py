# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_memory` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.memory import DenseMemoryModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

ROWS = 40


def _rows(rng: random.Random) -> Stimulus:
    """Rows of passes of several widths, the whole depth among them; a reset in the middle of some."""
    width, depth = params()["Width"], params()["Depth"]
    for n in range(ROWS):
        length = depth if n % 8 < 3 else rng.randint(4, depth)
        cut = rng.randrange(length) if n % 16 == 9 else length
        for _ in range(cut):
            yield {"run_i": 1, "first_i": int(n % 8 == 0), "sum_i": rng.getrandbits(width)}
        if cut < length:
            yield {"rst_i": 1, "sum_i": rng.getrandbits(width)}
        for _ in range(rng.choice((1, 2, 9))):
            yield {"run_i": 0, "first_i": rng.getrandbits(1), "sum_i": rng.getrandbits(width)}


@cocotb.test()
async def every_clock(dut) -> None:
    words = zeros = 0

    def watch(_: Inputs, out: Outputs) -> None:
        nonlocal words, zeros
        words += bool(out["above_o"])
        zeros += out["above_o"] == 0

    await check_cycles(dut, DenseMemoryModel(), _rows(random.Random(cocotb.RANDOM_SEED)), watch)
    assert words > 10 * params()["Depth"] and zeros > params()["Depth"]


@pytest.mark.parametrize(("width", "depth"), [(88, 40), (22, 33)])
def test_memory(width: int, depth: int) -> None:
    simulate("slog_dense_memory", __name__, {"Width": width, "Depth": depth})
