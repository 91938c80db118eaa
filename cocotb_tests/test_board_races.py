# SPDX-License-Identifier: Apache-2.0
"""`slog_board` (`tiny`) while captures race searches and peeks of a slot, against its cycle model on every clock.

A result is of the frame before, of the new one, or refused because the slot is invalid; a word read back is of either
frame. The assertion of `slog_board` that the correlator reads no slot partly written is live.
"""

import random
from collections import Counter
from collections.abc import Generator
from functools import partial

import cocotb
import numpy as np

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.host import Host, Script
from golden.correlate import Job, Plane, Result, Status, run
from golden.cycle.board import RESET_START, BoardModel
from golden.log import sign
from golden.params import TINY
from golden.traffic.store import plane_words
from golden.traffic.video import texture
from sim.coverage.record import met
from sim.registers.map import address, fields, word
from sim.testbench.runner import AXI_PORTS, simulate

SIGMA = 1.5
SIZE = 21, 19
SLOT = 1
"""The slot that captures and searches race for; slot 0 keeps its frame."""
AROUND = range(-5, 6)
"""Clocks from the capture's clearing of the slot to the moment a job marks its slots as busy."""


def _show(h: Host, camera: int, slot: int) -> Generator[None, None, Plane]:
    """Arm a camera and show it a frame; the frame's sign plane."""
    image = texture(h.rng, *SIZE)
    yield from h.arm(camera, slot)
    h.show(camera, image)
    return sign(image, SIGMA, TINY.radius)


def _prepare(h: Host) -> Generator[None, None, dict[int, Plane]]:
    """Frames in slot 0 and SLOT; their planes."""
    planes: dict[int, Plane] = {}
    yield from h.set_up(SIGMA, SIZE)
    for slot in (0, SLOT):
        planes[slot] = yield from _show(h, 0, slot)
        yield from h.captured()
    return planes


def _job(rng: random.Random, tag: int) -> Job:
    """A job that reads SLOT for longer than a capture takes to write its first words."""
    slots = rng.choice(((0, SLOT), (SLOT, 0), (SLOT, SLOT)))
    return Job(slots[0], rng.randrange(5), rng.randrange(3), 16, 16, slots[1], 0, 0, 6, 4, tag)


def _load(h: Host, job: Job) -> Script:
    """Write a job's registers but for the submit; a grid of one."""
    for register, values in (
            ("job.tpl", {"slot": job.tpl_slot, "x": job.tpl_x, "y": job.tpl_y}),
            ("job.window", {"width": job.width, "height": job.height}),
            ("job.search", {"slot": job.search_slot, "x": job.search_x, "y": job.search_y}),
            ("job.offsets", {"across": job.offsets_x, "down": job.offsets_y}),
            ("job.grid", {"across": 1, "down": 1})):
        yield from h.write(register, **values)


def _searches(h: Host, model: BoardModel, seen: Counter[str]) -> Script:
    """One capture into SLOT for each clock of AROUND, and one when the camera is idle again; a job races each.

    The clocks from the start of the frame to the capture's clearing, and from the submit to the job's mark, are
    measured first, on a race won by far.
    """
    planes = yield from _prepare(h)
    channel, fetch = model.capture.channels[0], model.correlator.fetch
    clears = marks = 0
    for tag, shift in enumerate((None, *AROUND)):
        job = _job(h.rng, tag)
        yield from _load(h, job)
        old = dict(planes)
        yield from h.arm(0, SLOT)
        other = None
        if tag % 3 == 2:  # the other camera writes slot 2 at the same time
            other = yield from _show(h, 1, 2)
        image = texture(h.rng, *SIZE)
        h.show(0, image)
        new = {**planes, SLOT: sign(image, SIGMA, TINY.radius)}
        submitted = False
        cleared = marked = None
        for t in range(4000):
            if not submitted and t == (300 if shift is None else clears - marks + shift):
                h.master.write(address("job.submit"), word("job.submit", tag=tag, go=1))
                submitted, asked = True, t
            if channel.clears and cleared is None:
                cleared = t
            if submitted and fetch.state == "mark":
                marked = t
            yield
            if marked is not None and cleared is not None and not (model.capture.outputs()["writing_o"] or h.beats[0]):
                break
        assert cleared is not None and marked is not None, "the capture or the job never began"
        if shift is None:
            clears, marks = cleared, marked - asked
        else:
            assert marked - cleared == shift, f"the job is marked {marked - cleared} clocks after the clearing"
        yield from h.collect(1)
        result = h.results.pop()
        if result == Result(tag, Status.BAD_SLOT):
            seen["refused"] += 1
        else:
            assert result == run(job, old, TINY, SIZE), f"job marked {shift} clocks from the clearing: {result}"
            seen["old frame"] += 1
        if (yield from h.read("slot_status.armed")) & 1:
            seen["capture gave way"] += 1  # its request waits for the next frame
            h.show(0, image)
        yield from h.captured()
        planes = new if other is None else {**new, 2: other}
        if tag % 4 == 3:
            yield from h.submit(job)
            yield from h.collect(1)
            assert h.results.pop() == run(job, planes, TINY, SIZE)
            seen["new frame"] += 1
    for slot, plane in planes.items():
        assert np.array_equal((yield from h.plane(slot)), plane), f"slot {slot}"


def _peeks(h: Host, model: BoardModel, seen: Counter[str]) -> Script:
    """The host reads back the slot that is being written, near the word being written, and the untouched slot 0."""
    c = TINY
    planes = yield from _prepare(h)
    first = SLOT * c.slot_words
    channel = model.capture.channels[0]
    for _ in range(3):
        old = plane_words(planes[SLOT], c)
        planes[SLOT] = yield from _show(h, 0, SLOT)
        new = plane_words(planes[SLOT], c)
        kept = plane_words(planes[0], c)
        while channel.armed:
            row = (channel.row - first) // c.words_per_row + h.rng.randint(-1, 2) if channel.writing else 0
            row = min(max(row, 0), SIZE[1] - 1)
            yield from h.write("peek_address", word=first + row * c.words_per_row, go=1)
            for k in range(row * c.words_per_row, row * c.words_per_row + 3):
                access = h.master.read(address("peek_data"))
                yield from h.until(partial(getattr, access, "done"), "read of peek_data")
                if access.data is not None:  # undefined if read in the clock in which it was written
                    assert access.data in (old[k], new[k]), f"word {k} is {access.data:#x}"
                    seen["old word" if access.data == old[k] else "new word"] += 1
            if h.rng.random() < 0.3:
                at = h.rng.randrange(19) * c.words_per_row
                yield from h.write("peek_address", word=at, go=1)
                assert (yield from h.read("peek_data.value")) == kept[at], f"word {at} of slot 0"
        yield from h.captured()
        assert np.array_equal((yield from h.plane(SLOT)), planes[SLOT])


@cocotb.test()
async def searches(dut) -> None:
    seen: Counter[str] = Counter()
    model = BoardModel(TINY, fields())
    h = Host(TINY, random.Random(cocotb.RANDOM_SEED))
    await check_cycles(dut, model, h.play(_searches(h, model, seen)), reset_clocks=RESET_START)
    dut._log.info(f"{dict(seen)}")
    met("captures racing jobs", seen)
    assert min(seen[what] for what in ("refused", "old frame", "new frame", "capture gave way")) >= 3, seen


@cocotb.test()
async def peeks(dut) -> None:
    seen: Counter[str] = Counter()
    model = BoardModel(TINY, fields())
    h = Host(TINY, random.Random(cocotb.RANDOM_SEED))
    await check_cycles(dut, model, h.play(_peeks(h, model, seen)), reset_clocks=RESET_START)
    dut._log.info(f"{dict(seen)}")
    met("captures racing peeks", seen)
    assert seen["old word"] >= 10 and seen["new word"] >= 10, seen


def test_races() -> None:
    simulate("slog_board", __name__, ports=AXI_PORTS)
