# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_wide_winner` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.bits import or_zero, pack
from golden.cycle.dense.wide import COLUMNS, NO_WIDE_WINNER, WIDE_SCORE, WIDE_WINNER, WideWinnerModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 4000
FEW = 3
"""Largest sum where ties are wanted."""


def _score(rng: random.Random, top: int) -> int:
    """A score that may be absent."""
    return WIDE_SCORE.pack({"absent": int(rng.random() < 0.2), "sum": rng.randint(0, top)})


def _values(rng: random.Random) -> Stimulus:
    """Anything that groups before may hand on, and nothing; every clock's scores are independent."""
    for t in range(CLOCKS):
        top = (FEW, 1024, 2047)[t // 100 % 3]
        before = rng.getrandbits(8) << WIDE_SCORE.bits | _score(rng, top)
        yield {"base_i": t // (CLOCKS // 4) * 21 % 64, "winner_i": NO_WIDE_WINNER if rng.random() < 0.3 else before,
               "score_i": or_zero(pack([_score(rng, top) for _ in range(COLUMNS)], WIDE_SCORE.bits))}


@cocotb.test()
async def every_clock(dut) -> None:
    seen: set[int] = set()

    def watch(i: Inputs, out: Outputs) -> None:
        if out["winner_o"] is not None:
            index = WIDE_WINNER.unpack(out["winner_o"])["index"]
            if index // COLUMNS == i["base_i"]:
                seen.add(index)

    await check_cycles(dut, WideWinnerModel(), _values(random.Random(cocotb.RANDOM_SEED)), watch, reset_clocks=0)
    assert {index // COLUMNS for index in seen} == {0, 21, 42, 63} and len(seen) == 4 * COLUMNS


def test_wide_winner() -> None:
    simulate("slog_dense_wide_winner", __name__)
