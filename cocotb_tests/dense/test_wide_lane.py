# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_wide_lane` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.bits import signed
from golden.cycle.dense.wide import COLUMNS, WIDE_BITS, WIDE_SCORE, WIDE_SUMS, WORD, WideLaneModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from sim.testbench.runner import simulate

CLOCKS = 4000
WINDOW = 32
AGO = WINDOW // COLUMNS
CLEAR = AGO + 6


def _words(rng: random.Random) -> Stimulus:
    """Streams whose words return inverted a window later, so that delta keeps within its bounds; random sums above."""
    left, right = [0] * (AGO + 1), [0] * (AGO + 1)
    for t in range(CLOCKS):
        clear = t % (CLOCKS // 2) < CLEAR
        long = t // 64 % 3 == 0  # long runs of equal words: delta and the differences reach their ends
        for plane, run in ((left, WORD << COLUMNS if t // 192 % 2 else WORD), (right, 0)):
            plane.insert(0, 0 if clear else run if long else rng.getrandbits(2 * COLUMNS))
            plane.pop()
        bits = [WIDE_BITS.pack({"incoming": plane[0] >> COLUMNS, "leaving": plane[0] & WORD,
                                "incoming_ago": plane[-1] >> COLUMNS, "leaving_ago": plane[-1] & WORD})
                for plane in (left, right)]
        yield {"clear_i": int(clear), "left_i": bits[0], "right_i": bits[1], "ok_i": rng.getrandbits(COLUMNS),
               "above_i": 0 if t % 5 == 0 else rng.getrandbits(WIDE_SUMS.bits)}


@cocotb.test()
async def every_clock(dut) -> None:
    absent, above = 0, 1
    changes: dict[str, set[int]] = {name: set() for name, _ in WIDE_SUMS.fields}

    def watch(i: Inputs, out: Outputs) -> None:
        nonlocal absent, above
        if out["score_o"] is not None:
            absent += sum(out["score_o"] >> (j + 1) * WIDE_SCORE.bits - 1 & 1 for j in range(COLUMNS))
        if out["sums_o"] is not None and not above:  # with nothing above, the sums are the changes
            for name, bits in WIDE_SUMS.fields:
                changes[name].add(signed(WIDE_SUMS.unpack(out["sums_o"])[name], bits))
        above = i["above_i"]

    await check_cycles(dut, WideLaneModel(), _words(random.Random(cocotb.RANDOM_SEED)), watch, reset_clocks=0)
    assert absent > CLOCKS
    assert {min(changes["last"]), max(changes["last"])} == {-WINDOW, WINDOW}, changes["last"]
    for j in range(COLUMNS - 1):
        assert max(changes[f"less{j}"]) >= COLUMNS - 1 - j and min(changes[f"less{j}"]) <= j + 1 - COLUMNS, changes


def test_wide_lane() -> None:
    simulate("slog_dense_wide_lane", __name__)
