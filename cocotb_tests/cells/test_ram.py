# SPDX-License-Identifier: Apache-2.0
"""`slog_ram` and its ECP5 twin against one cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.cells.ram import RamModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 1500


def _accesses(rng: random.Random, width: int, depth: int) -> Stimulus:
    """Random writes and reads at a few addresses, the first and the last among them; never both at one in a clock."""
    addresses = sorted({0, depth - 1, depth // 2, *(rng.randrange(depth) for _ in range(12))})
    for _ in range(CLOCKS):
        writing, reading = rng.random() < 0.6, rng.random() < 0.6
        to, at = rng.choice(addresses), rng.choice(addresses)
        if to == at:
            writing, reading = reading, not reading and writing
        yield {"wr_en_i": int(writing), "wr_addr_i": to, "wr_data_i": rng.getrandbits(width),
               "rd_en_i": int(reading), "rd_addr_i": at}


@cocotb.test()
async def every_clock(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    reads = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal reads
        reads += bool(i["rd_en_i"] and out["rd_data_o"] is not None)

    await check_cycles(dut, RamModel(), _accesses(rng, params()["Width"], params()["Depth"]), count, reset_clocks=0)
    assert reads > CLOCKS // 4


@pytest.mark.parametrize(("width", "depth"), [(8, 16), (65, 640)])
def test_ram(width: int, depth: int) -> None:
    simulate("slog_ram", __name__, {"Width": width, "Depth": depth})


ASPECTS = [(71, 512), (19, 1024), (8, 1920), (5, 4000), (3, 8192), (2, 12416)]
"""Widths and depths, one for each aspect ratio of the block RAM."""


@pytest.mark.parametrize(("width", "depth"), ASPECTS)
def test_ram_ecp5(width: int, depth: int) -> None:
    simulate("slog_ram", __name__, {"Width": width, "Depth": depth}, ecp5=True)
