# SPDX-License-Identifier: Apache-2.0
"""`slog_array` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from golden.cycle.array.array import ArrayModel
from golden.cycle.array.timing import core_latency
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import FULL, TINY
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate


def _passes(rng: random.Random, move: str, bubbles: str, passes: int, reset_at: int | None) -> Stimulus:
    """`passes` passes of 1 to 12 random rows under a few random masks; operands wait while the array is frozen."""
    g, lanes = params()["GroupBits"], params()["Lanes"]
    moves, rows = ready_pattern(move, rng), ready_pattern(bubbles, rng)
    mask, t, until_last = 0, 0, 0

    def clock(row: Inputs | None) -> Stimulus:
        """One enabled clock, after any number of frozen ones."""
        nonlocal t, until_last
        noise = {"valid_i": 0, "first_i": rng.getrandbits(1), "last_i": rng.getrandbits(1),
                 "lanes_i": rng.randint(1, lanes)}
        while True:
            moving, reset = next(moves), int(t == reset_at)
            t += 1
            yield {**noise, **(row or {}), "mask_i": mask, "move_i": moving, "rst_i": reset}
            if reset:
                until_last = 0
            if moving:
                until_last = max(until_last - 1, 0)
                return

    for n in range(passes):
        if n % 8 == 0:
            for _ in range(lanes + 1):
                yield from clock(None)
            mask = rng.choice((rng.getrandbits(2 * g), (1 << 2 * g) - 1))
        steps, width = rng.choice((1, lanes, rng.randint(1, 12))), rng.choice((1, lanes, rng.randint(1, lanes)))
        while until_last > steps - 1:
            yield from clock(None)
        dense = rng.random() < 0.3  # every bit differs
        for s in range(steps):
            while not next(rows):
                yield from clock(None)
            operands = {name: rng.getrandbits(g) for name in ("tpl_a_i", "tpl_b_i")} | {
                name: rng.getrandbits(g + lanes - 1) for name in ("search_a_i", "search_b_i")}
            if dense:
                operands = dict.fromkeys(("tpl_a_i", "tpl_b_i"), (1 << g) - 1) | dict.fromkeys(
                    ("search_a_i", "search_b_i"), 0)
            if rng.random() < 0.1:
                operands |= {"tpl_b_i": 0, "search_b_i": 0}
            yield from clock({"valid_i": 1, "first_i": int(s == 0), "last_i": int(s == steps - 1), "lanes_i": width,
                              **operands})
        until_last = width - 1
    for _ in range(core_latency(g) + lanes + 4):
        yield from clock(None)


@cocotb.test()
@cocotb.parametrize(move=SHAPES, bubbles=("none", "random"))
async def every_clock(dut, move: str, bubbles: str) -> None:
    """Random rows and masks; with random bubbles also a reset in mid-pass."""
    g, lanes = params()["GroupBits"], params()["Lanes"]
    passes = 60 if g <= 16 else 16
    scores: list[int] = []

    def watch(i: Inputs, out: Outputs) -> None:
        if out["mismatch_valid_o"] and i["move_i"]:
            scores.append(out["mismatch_o"] or 0)

    rng = random.Random(cocotb.RANDOM_SEED)
    reset_at = rng.randint(100, 200) if bubbles == "random" else None
    await check_cycles(dut, ArrayModel(g, lanes), _passes(rng, move, bubbles, passes, reset_at), watch)
    assert len(scores) > passes and max(scores) > g


@cocotb.test()
async def fullest_count(dut) -> None:
    """The largest window between two smaller ones, every pixel different: the accumulator's top bits rise and fall."""
    g, lanes = params()["GroupBits"], params()["Lanes"]
    heights = 3 * g // 2, 2 * g, 1
    seen: list[int] = []

    def rows() -> Stimulus:
        # The scores of a pass are out before the last one, a row only, can add its own.
        for steps, rest in zip(heights, (0, lanes, core_latency(g) + lanes + 2), strict=True):
            for t in range(steps + rest):
                valid = t < steps
                yield {"move_i": 1, "mask_i": (1 << 2 * g) - 1, "valid_i": int(valid), "first_i": int(t == 0),
                       "last_i": int(t == steps - 1), "lanes_i": lanes,
                       **dict.fromkeys(("tpl_a_i", "tpl_b_i"), (1 << g) - 1 if valid else 0)}

    def watch(i: Inputs, out: Outputs) -> None:
        if out["mismatch_valid_o"]:
            seen.append(out["mismatch_o"] or 0)

    await check_cycles(dut, ArrayModel(g, lanes), rows(), watch)
    assert seen == [2 * g * steps for steps in heights for _ in range(lanes)]


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "array", ArrayModel(params()["GroupBits"], params()["Lanes"]))


@pytest.mark.parametrize(("group_bits", "lanes"), [
    (TINY.group_bits, TINY.lanes), (4, 8), (FULL.group_bits, FULL.lanes)])
def test_array(group_bits: int, lanes: int) -> None:
    simulate("slog_array", __name__, {"GroupBits": group_bits, "Lanes": lanes})
