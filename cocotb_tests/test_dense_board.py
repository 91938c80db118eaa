# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_board` (`tiny_dense`) against its cycle model on every clock, its maps against the frame level.

Cameras and the sink of maps are stalled in every shape, each in another scenario, because the model takes long.
"""

from dataclasses import replace
from functools import partial

import cocotb
import pytest

from cocotb_tests.env.dense_host import DenseHost
from cocotb_tests.env.dense_script import (
    OTHER,
    SIGMA,
    SIZE,
    Planes,
    capture_pair,
    check_map,
    random_job,
    run_pass,
    run_scenario,
)
from cocotb_tests.env.host import Script
from cocotb_tests.env.offers import offers_at_every_moment
from golden.cycle.dense.structs import CANCELLED
from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseStatus
from golden.log import sign
from golden.params import TINY_DENSE
from golden.traffic.video import texture
from sim.registers.map import address, dense_fields, fields, word
from sim.testbench.runner import AXI_PORTS, simulate

NO_ARRAY = ("counter.scores.value", "counter.jobs.value", "counter.refused.value", "job.status.waiting",
            "job.status.ready", "job.status.busy", "result.pop.waiting", "irq_status.result")
"""Fields of the array's jobs and results, 0 on a board without it."""

def _everyday(h: DenseHost) -> Script:
    """Captures on both cameras, good and refused passes, captures during a pass, counters and interrupt."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    yield from h.write("dense.irq_enable", done=1)
    job = DenseJob(0, 1, DensePass(8, 16, -4), check=True)
    jobs = [job, random_job(h.rng)]
    yield from h.load(job)
    yield from h.go()
    yield from h.load(jobs[1])  # during the pass
    yield from h.arm(1, 2)
    image = texture(h.rng, *SIZE)
    h.show(1, image)
    planes[2] = sign(image, SIGMA, TINY_DENSE.radius)
    check_map(h, job, planes, SIZE, (yield from h.finished()))
    assert h.irq
    yield from h.write("dense.irq_status", done=1)
    yield from h.pause(4)
    assert not h.irq
    yield from h.go()
    check_map(h, jobs[1], planes, SIZE, (yield from h.finished()))
    rows = sum((SIZE[1] - 1) // each.step[1] * each.step[1] + 1 for each in jobs)  # up to the last that the map has
    assert (yield from h.read("dense.rows.value")) == rows
    yield from h.captured()
    assert (yield from h.read("counter.frames[1].value")) == 2
    yield from run_pass(h, DenseJob(2, 1, DensePass(4, 16, -6), (3, 2)), planes)
    busy = yield from h.read("counter.busy.value")
    assert busy > 2 * SIZE[0] * SIZE[1]
    for name in NO_ARRAY:
        assert (yield from h.read(name)) == 0, name


def _refused(h: DenseHost) -> Script:
    """Every reason to refuse a pass; a start during a pass; a job for the array, which there is not."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    good = DenseJob(0, 1, DensePass(4, 9, -2), (3, 2))
    wrong: list[tuple[DenseStatus, DenseJob, dict[str, int]]] = [
        (DenseStatus.BAD_WINDOW, good, {"window": 16}), (DenseStatus.BAD_WINDOW, good, {"window": 6}),
        (DenseStatus.BAD_OFFSETS, good, {"offsets": 0}), (DenseStatus.BAD_OFFSETS, good, {"offsets": 17}),
        (DenseStatus.BAD_SLOT, replace(good, left=2), {}), (DenseStatus.BAD_SLOT, replace(good, right=3), {}),
        (DenseStatus.BAD_STEP, replace(good, step=(0, 1)), {}), (DenseStatus.BAD_STEP, replace(good, step=(1, 0)), {})]
    for status, job, raw in wrong:
        yield from h.load(job, **raw)
        yield from h.go()
        assert (yield from h.finished()) == status
        assert not h.streamed
        assert (yield from h.read("dense.irq_status.done"))
        yield from h.write("dense.irq_status", done=1)
    yield from h.load(good)
    yield from h.go()
    assert (yield from h.read("dense.run.busy"))
    yield from h.load(replace(good, left=2))
    yield from h.go()
    assert (yield from h.read("dense.irq_status.lost"))
    check_map(h, good, planes, SIZE, (yield from h.finished()))
    yield from h.write("job.submit", go=1)
    assert (yield from h.read("counter.overflows.value")) == 1
    assert not (yield from h.read("job.status.ready"))


def _under_way(h: DenseHost, words: int) -> bool:
    """Whether a map has so many words, and camera 1 has sent a part of its frame."""
    return len(h.streamed) >= words and len(h.beats[1]) < 300


def _resets(h: DenseHost) -> Script:
    """Reset in mid-frame, in mid-pass and with its map under way; afterwards the board works as new each time."""
    for moment in range(3):
        planes: Planes = {}
        yield from h.set_up(SIGMA, SIZE)
        yield from capture_pair(h, planes)
        job = replace(random_job(h.rng), step=(1, 1))
        if moment == 2:
            yield from run_pass(h, job, planes)
            return
        yield from h.load(job)
        yield from h.go()
        yield from h.arm(1, 2)
        h.show(1, texture(h.rng, *SIZE))
        enough = 60 * moment  # words of the map
        yield from h.until(partial(_under_way, h, enough), "map and frame")
        assert h.beats[1] and (yield from h.read("dense.run.busy"))
        yield from h.reset(1 + moment)
        assert (yield from h.read("slot_status.valid")) == 0
        assert not (yield from h.read("dense.run.busy"))
        assert (yield from h.read("dense.limits.most")) == 0x7FF
        assert (yield from h.read("dense.rows.value")) == 0
        yield from h.pause(100)
        assert not h.streamed


def _changes(h: DenseHost) -> Script:
    """The image size changes during a pass, which ends as it began; then frames and passes of the new size."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(8, 12, -3), (2, 1))
    yield from h.load(job)
    yield from h.go()
    yield from h.set_up(SIGMA, OTHER)
    assert (yield from h.read("slot_status.valid")) == 0 and (yield from h.read("dense.run.busy"))
    check_map(h, job, planes, SIZE, (yield from h.finished()))
    yield from run_pass(h, job, {})  # no slot holds a frame
    planes.clear()
    yield from capture_pair(h, planes)
    yield from run_pass(h, job, planes)
    # Cancelled: whole rows, and the end.
    yield from h.load(replace(job, step=(1, 1)))
    yield from h.go()
    yield from h.until(lambda: len(h.streamed) > 2 * OTHER[0], "two rows")
    yield from h.write("dense.run", cancel=1)
    assert (yield from h.finished()) == CANCELLED
    words = h.take_map()
    assert 2 * OTHER[0] < len(words) < OTHER[0] * OTHER[1] and len(words) % OTHER[0] == 1
    yield from run_pass(h, random_job(h.rng), planes)


def _busy_slots(h: DenseHost) -> Script:
    """Captures into the slots of a pass, begun at any time: the map is of the old frames or, if the capture came
    first, the pass is refused; the frame that gave way is taken the next time it is shown."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(4, 16, -8), (4, 3))
    yield from h.load(job)
    seen = dict.fromkeys(DenseStatus, 0)
    for tag in range(4):
        image = texture(h.rng, *SIZE)
        yield from h.arm(0, 0)
        h.show(0, image)
        yield from h.pause((0, 250, 350, 600)[tag])
        yield from h.go()
        status = DenseStatus((yield from h.finished()))
        seen[status] += 1
        check_map(h, job, planes if status is DenseStatus.OK else {}, SIZE, status if status is DenseStatus.OK else 3)
        yield from h.until(lambda: not h.beats[0], "frame")
        if (yield from h.read("slot_status.armed")):
            h.show(0, image)
        yield from h.captured()
        planes[0] = sign(image, SIGMA, TINY_DENSE.radius)
    yield from run_pass(h, job, planes)
    assert seen[DenseStatus.OK] and seen[DenseStatus.BAD_SLOT], seen


def _accesses(h: DenseHost) -> Script:
    """Random reads of every register of both maps, and harmless writes, during frames and a pass: to the array's
    registers, which a board without it keeps, too."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(8, 16, -4))
    yield from h.load(job)
    yield from h.go()
    places = sorted({f.address for f in (*fields().values(), *dense_fields().values())} | {0xCC, 0xFC})
    harmless = [address(r) for r in ("dense.planes", "dense.search", "dense.vertical", "dense.limits", "irq_enable",
                                     "dense.irq_enable", "dense.irq_status", "job.tpl", "job.window", "job.search",
                                     "job.offsets", "job.grid", "job.step")]
    h.master.overlap = 6
    for _ in range(900):
        if not h.beats[0]:
            h.show(0, texture(h.rng, *SIZE))
        if len(h.master.waiting) < 6:
            if h.rng.random() < 0.6:
                h.master.read(h.rng.choice(places))
            else:
                h.master.write(h.rng.choice(harmless), h.rng.getrandbits(32), h.rng.getrandbits(4))
        yield
    yield from h.until(lambda: h.master.idle, "bus")
    h.master.overlap = 1
    check_map(h, job, planes, SIZE, (yield from h.finished()))
    h.master.write(address("irq_enable"), word("irq_enable"))
    yield from h.write("dense.irq_enable")
    yield from run_pass(h, random_job(h.rng), planes)


def _offers(h: DenseHost) -> Script:
    """None of the offers is lost, and a pass of new frames is right afterwards."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from offers_at_every_moment(h)
    yield from capture_pair(h, planes)
    yield from run_pass(h, random_job(h.rng), planes)


@cocotb.test()
@cocotb.parametrize((("video", "sink", "bus"), [("none", "none", "none"), ("long", "random", "cyclic")]))
async def everyday_work(dut, video: str, sink: str, bus: str) -> None:
    host = await run_scenario(dut, _everyday, video, sink, bus)
    assert sink == "none" or host.stalls["stream"] > 10


@cocotb.test()
async def passes_refused(dut) -> None:
    await run_scenario(dut, _refused, sink="random", bus="long")


@cocotb.test()
async def reset_in_the_middle(dut) -> None:
    await run_scenario(dut, _resets, video="random", sink="cyclic")


@cocotb.test()
async def changes_between_frames(dut) -> None:
    await run_scenario(dut, _changes, video="cyclic", sink="cyclic", bus="random")


@cocotb.test()
async def captures_into_busy_slots(dut) -> None:
    await run_scenario(dut, _busy_slots)


@cocotb.test()
async def access_during_work(dut) -> None:
    await run_scenario(dut, _accesses, video="cyclic", sink="long", bus="random")


@cocotb.test()
async def offers(dut) -> None:
    await run_scenario(dut, _offers)


@pytest.mark.slow
def test_dense_board() -> None:
    simulate("slog_dense_board", __name__, ports=AXI_PORTS, config="tiny_dense")
