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
from golden.cycle.dense.structs import BAD_SLOT, CANCELLED, LOST, NO_SUM, OK
from golden.params import TINY_DENSE
from golden.traffic.dense_block import DenseBlockTraffic, PassOutcome, Start, any_job, bad_job, build_of, verify
from golden.traffic.live import FATES, CameraRequest
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
    return Start(start.job, start.planes, start.size, clocks if how == "cancel" else None,
                 clocks if how == "reset" else None, start.sink)


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


PACES = {"faster than the pass": (1, 9), "slower than the pass": (90, 150), "any pace": (1, 150)}
"""Clocks between rows of a camera, at least and at most; those of the pass are 65 or more apart."""
LIVE = ("left frame later", "right frame later", "one request only", "both frames there", "one slot", "aborted, seen",
        "request gone, seen", "size changed, seen", "request gone before it began, seen", "lost after the last row",
        "cancelled while waiting", "refused", "old frame", "frame begun before", "down", "up", "step", *PACES)
"""What live passes must have met."""


def _live(rng: random.Random, easy: bool = False) -> tuple[Start, set[str]]:
    """A live start, and what it is a case of: frames that come before, during or long after it, or not at all."""
    size = rng.choice(((18, 9), (20, 10), (48, 12)))
    job = {**any_job(rng, TINY_DENSE, size[0]), "live": 1, "window": rng.choice((4, 8))}
    job["down"] = rng.choice((0, 0, 1, -1, rng.randint(-9, 9), rng.randint(-size[1], size[1])))
    if rng.random() < 0.5:
        job.update(start=rng.randint(-12, 4), step_x=1, step_y=1)
    if rng.random() < 0.85 and job["left_slot"] == job["right_slot"]:
        job["right_slot"] = (job["left_slot"] + 1) % BUILD.slots
    planes = _planes(rng, size, job)
    slots = [job["left_slot"], job["right_slot"]]
    rng.shuffle(slots)
    if slots[0] == slots[1]:
        slots.pop()
    pace = rng.choice(list(PACES))
    cases = {pace, *(name for name, met in (("down", job["down"] > 0), ("up", job["down"] < 0),
                                            ("step", job["step_y"] > 1)) if met)}
    requests: list[CameraRequest | None] = [None, None]
    before = rng.choice((0, 0, 25, 300))
    for c, slot in enumerate(slots):
        if rng.random() < (0.9 if len(slots) == 2 else 1.0):
            fate = "whole" if easy or rng.random() < 0.7 else rng.choice(FATES)
            requests[c] = CameraRequest(slot, size[1], PACES[pace], rng.choice((0, 30, 200, 1500)), fate,
                                  rng.randint(0, size[1]), rng.choice((0, 40, 40 if before else None)), 5 + c)
    asked = {one.slot for one in requests if one}
    old = {slot: 1 - planes[slot] for slot in asked if rng.random() < 0.5}
    clear = rng.choice((1, 2, rng.randint(3, 900))) if not easy and rng.random() < 0.15 else None
    cancel = rng.randint(1, 2500) if not easy and rng.random() < 0.15 else None
    if not easy and rng.random() < 0.1:
        planes = {slot: plane for slot, plane in planes.items() if slot in asked}
    return Start(job, planes, size, cancel, sink=rng.choice(SHAPES), requests=(requests[0], requests[1]), old=old,
                 before=before, clear=clear), cases


def _seen(start: Start, outcome: PassOutcome) -> set[str]:
    """What a live start met, in the words of LIVE."""
    job, asked = start.job, {one.slot: one for one in start.requests if one}
    sent = (-(-start.size[1] // job["step_y"]) - 1) * job["step_y"] + 1
    left, right = asked.get(job["left_slot"]), asked.get(job["right_slot"])
    fates = {one.fate: one for one in asked.values()}
    good, lost = outcome.status == OK, outcome.status == LOST
    begun = any(one.fate == "whole" and one.wait < start.before for one in asked.values())
    gone = [one for one in asked.values() if one.fate in ("cancel", "move")]
    return {name for name, met in (
        ("left frame later", good and left and right and left.wait > right.wait + 100),
        ("right frame later", good and left and right and right.wait > left.wait + 100),
        ("one request only", good and len(asked) == 1 and job["left_slot"] != job["right_slot"]),
        ("both frames there", good and not asked), ("one slot", good and job["left_slot"] == job["right_slot"]),
        ("aborted, seen", lost and set(fates) == {"abort"} and start.clear is None),
        ("request gone, seen", lost and gone and gone[0].at and start.clear is None),
        ("request gone before it began, seen", lost and gone and not gone[0].at and start.clear is None),
        ("size changed, seen", lost and start.clear is not None and set(fates) <= {"whole"}),
        ("lost after the last row", lost and outcome.rows == sent),
        ("cancelled while waiting", outcome.status == CANCELLED), ("refused", outcome.status == BAD_SLOT),
        ("old frame", good and start.old), ("frame begun before", good and begun)) if met}


@cocotb.test()
async def live_every_clock(dut) -> None:
    """A few live passes, whole and lost."""
    rng = random.Random(cocotb.RANDOM_SEED)
    starts = [_live(rng, easy=number % 2 == 0)[0] for number in range(6)]
    traffic = DenseBlockTraffic(starts, TINY_DENSE, rng)
    await check_cycles(dut, DenseBlockModel(BUILD), traffic.stimulus())
    _check(traffic)


@cocotb.test()
async def live(dut) -> None:
    """Live passes of every kind: what ends well is the map of the whole frames, each row searched when it is there and
    not before; no other ends well, and none hangs."""
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: Counter[str] = Counter()
    while len(seen) < len(LIVE):
        drawn = [_live(rng) for _ in range(60)]
        traffic = DenseBlockTraffic([start for start, _ in drawn], TINY_DENSE, rng)
        await drive(dut, DenseBlockModel.INPUTS, DenseBlockModel.OUTPUTS, traffic.stimulus())
        _check(traffic)
        for (start, cases), outcome in zip(drawn, traffic.outcomes, strict=True):
            seen.update(_seen(start, outcome) | (cases if outcome.status == OK else set()))
            wanted = start.clear is not None or any(one and one.fate != "whole" for one in start.requests)
            assert wanted or outcome.status != LOST, start
    met("live passes", {name: seen[name] for name in LIVE})


@cocotb.test()
async def live_ends_soon(dut) -> None:
    """Behind slow cameras the map ends a fixed time after their last row, in whatever order they come; and a row that
    waits for them does not count as stalled."""
    rng = random.Random(cocotb.RANDOM_SEED)
    job = {**EASY, "live": 1}
    for late in (0, 1):
        requests = [CameraRequest(slot, 12, (120, 120), 400 + 60 * (slot == late)) for slot in (0, 1)]
        start = Start(job, _planes(rng, (20, 12), job), (20, 12), requests=(requests[0], requests[1]))
        traffic = DenseBlockTraffic([start], TINY_DENSE, rng)
        await drive(dut, DenseBlockModel.INPUTS, DenseBlockModel.OUTPUTS, traffic.stimulus())
        _check(traffic)
        outcome = traffic.outcomes[0]
        last = 460 + 7 + 12 * 121
        assert outcome.status == OK and outcome.stalls == 0
        assert last < outcome.clocks < last + LIVE_END, (outcome.clocks, last)


LIVE_END = 20 + 3 * BUILD.offsets + 49 + 24
"""Clocks from the camera's last row to the end of a pass 20 columns wide."""


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
