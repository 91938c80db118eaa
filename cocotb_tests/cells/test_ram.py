"""Cocotb side of the `slog_ram` test."""

import random

import cocotb

from cocotb_tests.env.check import Inputs, Outputs, Stimulus, check_cycles
from cocotb_tests.env.params import params
from golden.cycle.cells.ram import RamModel

CLOCKS = 1500


def traffic(rng: random.Random, width: int, depth: int) -> Stimulus:
    """Both ends at random over a few addresses, the first and the last among them; never the same in one clock."""
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

    await check_cycles(dut, RamModel(), traffic(rng, params()["Width"], params()["Depth"]), count, reset_clocks=0)
    assert reads > CLOCKS // 4
