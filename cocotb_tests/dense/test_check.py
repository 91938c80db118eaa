# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_check` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.check import DenseCheckModel
from golden.cycle.dense.structs import BACK, CHECKED, NO_SUM, WINNER
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 3000


def _winners(rng: random.Random, offsets: int) -> Stimulus:
    """Winners in rows, back words of numbers near them in all clocks; a reset in the middle."""
    near = rng.randrange(offsets)
    for t in range(CLOCKS):
        if t % 200 == 0:
            near = rng.randrange(offsets)
        index = min(offsets - 1, max(0, near + rng.randint(-2, 2)))
        winner = {name: rng.getrandbits(bits) for name, bits in WINNER.fields}
        found = rng.random() < 0.8
        winner |= {"index": index if found else 0, "best": rng.randrange(NO_SUM) if found else NO_SUM}
        yield {"winner_valid_i": int(rng.random() < 0.7), "winner_i": WINNER.pack(winner),
               "back_i": BACK.pack({"index": min(offsets - 1, max(0, near + rng.randint(-2, 2))),
                                    "best": rng.getrandbits(11)}), "rst_i": int(t == CLOCKS // 2)}


@cocotb.test()
async def every_clock(dut) -> None:
    offsets, seen = params()["Offsets"], {0: 0, 1: 0}

    def watch(_: Inputs, out: Outputs) -> None:
        if out["checked_o"] is not None:
            seen[CHECKED.unpack(out["checked_o"])["agrees"]] += 1

    await check_cycles(dut, DenseCheckModel(offsets), _winners(random.Random(cocotb.RANDOM_SEED), offsets), watch)
    assert min(seen.values()) > CLOCKS // 8


def test_check() -> None:
    simulate("slog_dense_check", __name__, {"Offsets": 24})
