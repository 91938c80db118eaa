# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_lanes` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.lanes import DenseLanesModel
from golden.cycle.dense.structs import LEFT, NO_SUM, RIGHT, SUM_BITS
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 3000


def _pixels(rng: random.Random) -> Stimulus:
    """Streams whose bits return inverted a window later, so that delta keeps within its bounds; random sums above."""
    lanes, window = params()["Lanes"], params()["MaxWindow"]
    left, right = [0] * (window + 1), [0] * (window + 1)
    for t in range(CLOCKS):
        clear = t < 3 * lanes + window + 8 or (CLOCKS // 2 < t < CLOCKS // 2 + 3 * lanes + window + 8)
        dense = t // 64 % 3 == 0  # long runs: delta reaches its ends
        for plane, lean in ((left, 3), (right, 0)):
            plane.insert(0, 0 if clear else 2 * (lean >> 1) + (lean & 1) * (t // 192 % 2) if dense
                         else rng.getrandbits(2))
            plane.pop()
        yield {"clear_i": int(clear), "used_i": (1 << lanes) - 1 if t % 500 < 400 else rng.getrandbits(lanes),
               "left_i": LEFT.pack({"in_row": rng.getrandbits(1), "first": rng.getrandbits(1),
                                    "bits": left[0] << 2 | left[-1]}),
               "right_i": RIGHT.pack({"in_row": rng.getrandbits(1), "bits": right[0] << 2 | right[-1]}),
               "left_ok_i": rng.getrandbits(2), "right_ok_i": rng.getrandbits(2),
               "above_i": rng.getrandbits(lanes * SUM_BITS)}


@cocotb.test()
async def every_clock(dut) -> None:
    lanes = params()["Lanes"]
    scored = absent = 0

    def watch(_: Inputs, out: Outputs) -> None:
        nonlocal scored, absent
        if out["score_o"] is not None:
            scores = [out["score_o"] >> k * SUM_BITS & NO_SUM for k in range(lanes)]
            scored += sum(score != NO_SUM for score in scores)
            absent += scores.count(NO_SUM)

    await check_cycles(dut, DenseLanesModel(lanes), _pixels(random.Random(cocotb.RANDOM_SEED)), watch, reset_clocks=0)
    assert scored > lanes * CLOCKS // 4 and absent > lanes * CLOCKS // 4


@pytest.mark.parametrize(("lanes", "window"), [(8, 32), (2, 3)])
def test_lanes(lanes: int, window: int) -> None:
    simulate("slog_dense_lanes", __name__, {"Lanes": lanes, "MaxWindow": window})
