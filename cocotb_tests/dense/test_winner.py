# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_winner` and `slog_dense_back` against their cycle models on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.bits import pack
from golden.cycle.dense.structs import BACK, NO_BACK, NO_SUM, NO_WINNER, SUM_BITS, WINNER
from golden.cycle.dense.winner import DenseBackModel, DenseWinnerModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 2000
FEW = 3
"""Largest sum where ties are wanted."""


def _sum(rng: random.Random, top: int) -> int:
    """A number of mismatches that may be absent."""
    return rng.randint(0, top) if rng.random() < 0.8 else NO_SUM


def _values(rng: random.Random, port: str) -> Stimulus:
    """Anything that lanes before these may hand on, and nothing; every clock's scores are independent."""
    lanes, base = params()["Lanes"], params()["Lanes"] * rng.randint(0, 3)
    layout, none = (WINNER, NO_WINNER) if port == "winner_i" else (BACK, NO_BACK)
    for t in range(CLOCKS):
        top = (FEW, 1024)[t // 100 % 2]
        kept = {name: rng.getrandbits(bits) if bits < SUM_BITS else _sum(rng, top) for name, bits in layout.fields}
        yield {"base_i": base, port: none if rng.random() < 0.3 else layout.pack(kept),
               "score_i": pack([_sum(rng, top) for _ in range(lanes)], SUM_BITS) or 0}


@cocotb.test()
async def every_clock(dut) -> None:
    name = dut._name.removeprefix("slog_dense_")
    model, layout = (DenseBackModel, BACK) if name == "back" else (DenseWinnerModel, WINNER)
    seen: set[int] = set()

    def watch(_: Inputs, out: Outputs) -> None:
        if out[f"{name}_o"] is not None:
            seen.add(layout.unpack(out[f"{name}_o"])["index"])

    lanes = params()["Lanes"]
    await check_cycles(dut, model(lanes), _values(random.Random(cocotb.RANDOM_SEED), f"{name}_i"), watch,
                       reset_clocks=0)
    assert len(seen) > 2 * lanes


@pytest.mark.parametrize("lanes", [2, 8])
@pytest.mark.parametrize("name", ["winner", "back"])
def test_winner(name: str, lanes: int) -> None:
    simulate(f"slog_dense_{name}", __name__, {"Lanes": lanes})
