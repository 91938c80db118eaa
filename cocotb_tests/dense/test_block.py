# SPDX-License-Identifier: Apache-2.0
"""`slog_dense` against its cycle model on every clock, and its maps against the frame level."""

import random
from collections import Counter
from dataclasses import replace
from itertools import cycle

import cocotb
import numpy as np

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.drive import drive
from golden.correlate import Plane
from golden.cycle.dense.block import DenseBlockModel
from golden.cycle.dense.structs import CANCELLED, NO_SUM, OK
from golden.params import TINY_DENSE
from golden.traffic.dense_block import DenseBlockTraffic, PassOutcome, Start, any_job, bad_job, build_of, verify
from golden.traffic.stalls import SHAPES
from sim.coverage.record import met
from sim.testbench.runner import simulate

OUT_DEPTH = 256
BUILD = build_of(TINY_DENSE, OUT_DEPTH)
PARAMETERS = {"Width": BUILD.width, "MaxWidth": BUILD.max_width, "MaxHeight": BUILD.max_height,
              "WordsPerRow": BUILD.words_per_row, "Slots": BUILD.slots, "Offsets": BUILD.offsets, "Lanes": BUILD.lanes,
              "MaxWindow": BUILD.max_window, "Sizes": BUILD.sizes, "OutDepth": OUT_DEPTH}
EASY = {"left_slot": 0, "right_slot": 1, "window": 8, "offsets": 16, "start": 0, "down": 0, "step_x": 1, "step_y": 1,
        "most": NO_SUM, "margin": 0, "check": 0, "live": 0}


def _planes(rng: random.Random, size: tuple[int, int], job: dict[str, int]) -> dict[int, Plane]:
    """Planes in every slot that resemble each other somewhere in the search range; or the job's, or one of it, only."""
    dice = np.random.default_rng(rng.getrandbits(32))
    shape = size[1], size[0]
    left = (dice.random(shape) < rng.choice((0.5, 0.03))).astype(np.uint8)
    right = np.roll(left, (-job["down"], -job["start"] - rng.randrange(max(1, job["offsets"]))), (0, 1))
    right ^= (dice.random(shape) < rng.choice((0.0, 0.1))).astype(np.uint8)
    planes: dict[int, Plane] = {slot: dice.integers(0, 2, shape, np.uint8) for slot in range(BUILD.slots)}
    return {**planes, job["left_slot"]: left, job["right_slot"]: right}


def _start(rng: random.Random, size: tuple[int, int], **chosen: int) -> Start:
    """A start of a job that differs from the easy one by `chosen`, and takes its slots by chance."""
    job = {**EASY, "left_slot": rng.randrange(3), "right_slot": rng.randrange(3), **chosen}
    return Start(job, _planes(rng, size, job), size, sink=rng.choice(SHAPES))


def _bad(rng: random.Random) -> list[Start]:
    """Starts that are refused: for their numbers, for an image smaller than the window, for a slot without a frame."""
    numbers = [bad_job(rng, TINY_DENSE, 48) for _ in range(16)]
    starts = [Start(job, _planes(rng, (48, 36), job), (48, 36)) for job in numbers]
    starts += [_start(rng, (16, 7)), _start(rng, (48, 3), window=4)]
    for name in ("left_slot", "right_slot"):
        start = _start(rng, (20, 10), left_slot=0, right_slot=1)
        starts.append(Start(start.job, {n: p for n, p in start.planes.items() if n != start.job[name]}, start.size))
    return [Start(start.job, {n: p for n, p in start.planes.items() if n < BUILD.slots}, start.size)
            for start in starts]


def _any(rng: random.Random) -> Start:
    """An acceptable start."""
    size = rng.choice((18, 48, rng.randint(18, 48))), rng.choice((8, 36, rng.randint(8, 36)))
    job = any_job(rng, TINY_DENSE, size[0])
    return Start(job, _planes(rng, size, job), size, sink=rng.choice(SHAPES))


def _ended(start: Start, rng: random.Random, how: str) -> Start:
    """The same start, cancelled or reset somewhere on its way."""
    clocks = rng.choice((rng.randint(1, 110), rng.randint(110, 70 * start.size[1])))
    return Start(start.job, start.planes, start.size, **{how: clocks}, sink=start.sink)


def _check(traffic: DenseBlockTraffic) -> int:
    """Hold every start that was not reset against the frame level; returns how many maps ended early."""
    early = 0
    for start, outcome in zip(traffic.starts, traffic.outcomes, strict=True):
        if start.reset is None or outcome.status >= 0:
            early += verify(start, outcome, TINY_DENSE)
    return early


def _end(start: Start, outcome: PassOutcome) -> str:
    """How a start ended, in the words of the functional plan."""
    if outcome.status == CANCELLED:
        return "cancelled early"
    if outcome.status == OK:
        return "whole" if start.cancel is None or start.cancel > outcome.clocks else "cancelled too late"
    return "reset" if outcome.status < 0 else "refused"


@cocotb.test()
async def every_clock(dut) -> None:
    """Small images, and a cancel and a reset among them."""
    rng = random.Random(cocotb.RANDOM_SEED)
    starts = [_start(rng, (20, 10)), _start(rng, (17, 9), start=-30, down=2, step_x=3, window=4),
              _ended(_start(rng, (20, 12)), rng, "cancel"), _ended(_start(rng, (20, 9), start=5), rng, "reset"),
              _start(rng, (16, 9), start=4, down=-1, step_y=2, check=1), *_bad(rng)[-3:]]
    # The longest stalls meet the first map, which is whole.
    starts = [replace(start, sink=shape) for start, shape in zip(starts, cycle(reversed(SHAPES)), strict=False)]
    traffic = DenseBlockTraffic(starts, TINY_DENSE, rng)
    await check_cycles(dut, DenseBlockModel(BUILD), traffic.stimulus())
    _check(traffic)


@cocotb.test()
async def maps(dut) -> None:
    """Every kind of start against the frame level, every word of every map."""
    rng = random.Random(cocotb.RANDOM_SEED)
    starts = [*_bad(rng), *(_any(rng) for _ in range(24))]
    starts += [_ended(_any(rng), rng, how) for how in ("cancel", "reset") for _ in range(8)]
    rng.shuffle(starts)
    # The largest maps, and sinks that take fewer words than a row sends: the memory fills.
    starts += [replace(_start(rng, (48, 36), start=start), sink="long") for start in (-16, 0, 40)]
    # A cancel before the first row, and one after the only row that has words.
    starts += [Start(start.job, start.planes, start.size, cancel=clocks)
               for start, clocks in ((_start(rng, (20, 12)), 20), (_start(rng, (20, 30), step_y=40), 150))]
    traffic = DenseBlockTraffic(starts, TINY_DENSE, rng)
    await drive(dut, DenseBlockModel.INPUTS, DenseBlockModel.OUTPUTS, traffic.stimulus())
    assert 0 < _check(traffic) < 10
    assert [outcome.status for outcome in traffic.outcomes[-2:]] == [CANCELLED, OK]
    ends = Counter(_end(start, outcome) for start, outcome in zip(traffic.starts, traffic.outcomes, strict=True))
    stalled = sum(outcome.stalls > 0 for outcome in traffic.outcomes)
    windows = Counter(f"window {start.job['window']}" for start, outcome in
                      zip(traffic.starts, traffic.outcomes, strict=True) if outcome.status == OK)
    met("dense passes", {**ends, **windows, "start while busy": traffic.pushed, "stalled by the sink": stalled})
    assert traffic.pushed > 50
    assert sum(outcome.stalls for outcome in traffic.outcomes) > 100


@cocotb.test()
async def resets(dut) -> None:
    """A reset of one clock in every clock of two rows; the pass after it is whole."""
    rng = random.Random(cocotb.RANDOM_SEED)
    easy = Start(EASY, _planes(rng, (16, 8), EASY), (16, 8))
    begin, pitch = 3 * 16 + 16 + 24, 16 + 2 * 8 + 1
    starts = [start for clocks in range(begin + pitch, begin + 3 * pitch)
              for start in (Start(EASY, easy.planes, easy.size, reset=clocks), easy)]
    traffic = DenseBlockTraffic(starts, TINY_DENSE, rng)
    await drive(dut, DenseBlockModel.INPUTS, DenseBlockModel.OUTPUTS, traffic.stimulus())
    _check(traffic)
    assert [outcome.status for outcome in traffic.outcomes[1::2]] == [OK] * (2 * pitch)


@cocotb.test()
async def never_waits(dut) -> None:
    """A sink that is always ready: no row waits, whatever the offset of the planes."""
    rng = random.Random(cocotb.RANDOM_SEED)
    starts = [Start(start.job, start.planes, start.size) for start in
              (_start(rng, (48, 36), start=begin) for begin in (-15, -4, 0, 47))]
    traffic = DenseBlockTraffic(starts, TINY_DENSE, rng)
    await drive(dut, DenseBlockModel.INPUTS, DenseBlockModel.OUTPUTS, traffic.stimulus())
    _check(traffic)
    assert [outcome.stalls for outcome in traffic.outcomes] == [0] * len(starts)
    pitch, flush, drain = 48 + 2 * 8 + 1, 3 * 16 + 8 + 8, 4 * 16 + 150
    assert all(outcome.clocks < 36 * pitch + flush + drain for outcome in traffic.outcomes)


def test_block() -> None:
    simulate("slog_dense", __name__, PARAMETERS)
