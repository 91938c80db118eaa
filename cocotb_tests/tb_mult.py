"""Cocotb side of the `slog_mult` test."""

import random

import cocotb

from cocotb_tests.env.cycle import Inputs, Outputs, Stimulus, check_cycles
from golden.cycle_mult import BITS, MultModel

CLOCKS = 2000
EXTREMES = (0, 1, 1 << BITS - 1, (1 << BITS - 1) - 1, (1 << BITS) - 1)


def operand(rng: random.Random) -> int:
    return rng.choice(EXTREMES) if rng.random() < 0.4 else rng.getrandbits(BITS)


def traffic(rng: random.Random) -> Stimulus:
    """Extreme and random operands, the enable high in three clocks of four."""
    for _ in range(CLOCKS):
        yield {"en_i": int(rng.random() < 0.75), "a_i": operand(rng), "b_i": operand(rng)}


@cocotb.test()
async def every_clock(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: set[int] = set()

    def count(_: Inputs, out: Outputs) -> None:
        if out["p_o"] is not None:
            seen.add(out["p_o"])

    await check_cycles(dut, MultModel(), traffic(rng), count, reset_clocks=0)
    assert len(seen) > CLOCKS // 4
