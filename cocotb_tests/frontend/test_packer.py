# SPDX-License-Identifier: Apache-2.0
"""`slog_packer` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from golden.cycle.frontend.packer import PackerModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate


def _rows(rng: random.Random, shape: str, group: int) -> Stimulus:
    """Rows of 1 bit to a little more than three words, some cut off by an abort; one reset."""
    offer = ready_pattern(shape, rng)
    for n in range(60):
        length = rng.randint(1, 3 * group + 1)
        for x in range(length):
            while not next(offer):
                yield {"bit_i": rng.getrandbits(1), "bit_last_i": rng.getrandbits(1)}
            last = int(x == length - 1)
            yield {"bit_valid_i": 1, "bit_i": rng.getrandbits(1), "bit_last_i": last,
                   "bit_start_i": int(x == 0 and n % 5 == 0), "bit_done_i": last & int(n % 5 == 4)}
            if rng.random() < 0.16 / group:
                yield {"bit_abort_i": 1, "bit_i": 1, "bit_last_i": 1}
                break
        if n == 30:
            yield {"bit_valid_i": 1, "bit_i": 1}
            yield {"rst_i": 1, "bit_valid_i": 1, "bit_i": 1, "bit_last_i": 1, "bit_start_i": 1, "bit_done_i": 1}
    yield {}


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def every_clock(dut, shape: str) -> None:
    group = params()["GroupBits"]
    words = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal words
        words += out["word_valid_o"] or 0

    await check_cycles(dut, PackerModel(group), _rows(random.Random(cocotb.RANDOM_SEED), shape, group), count)
    assert words > 60


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "frontend", PackerModel(params()["GroupBits"]))


@pytest.mark.parametrize("group_bits", [8, 32, 64])  # 8 is also that of the timing diagram
def test_packer(group_bits: int) -> None:
    """Words of one slice, of two, and those of `full`."""
    simulate("slog_packer", __name__, {"GroupBits": group_bits})
