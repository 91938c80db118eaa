# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_board` (`tiny_dense`) against its cycle model on every clock, its maps against the frame level.

Cameras and the sink of maps are stalled in every shape, each in another scenario, because the model takes long.
"""

import random
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import cocotb
import numpy as np
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.dense_host import DenseHost
from cocotb_tests.env.host import Script
from cocotb_tests.env.offers import offers_at_every_moment
from golden.correlate import Plane
from golden.cycle.board import RESET_START
from golden.cycle.dense.structs import CANCELLED, LOST
from golden.cycle.dense_board import DenseBoardModel
from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseResult, DenseStatus, run_dense
from golden.log import Image, sign
from golden.params import TINY_DENSE
from golden.traffic.stalls import coin
from golden.traffic.video import good, texture
from sim.board.dense import map_shape, unpack_map
from sim.registers.map import address, dense_fields, fields, word
from sim.testbench.runner import AXI_PORTS, simulate

SIGMA = 1.5
SIZE = 20, 18
OTHER = 21, 19
"""Another size, for changes between frames."""
FIELDS = tuple(DenseResult.__dataclass_fields__)
NO_ARRAY = ("counter.scores.value", "counter.jobs.value", "counter.refused.value", "job.status.waiting",
            "job.status.ready", "job.status.busy", "result.pop.waiting", "irq_status.result")
"""Fields of the array's jobs and results, 0 on a board without it."""

Planes = dict[int, Plane]


def _random_job(rng: random.Random, slots: int = 2) -> DenseJob:
    """A good job of any kind."""
    one = DensePass(rng.choice(TINY_DENSE.dense_windows), rng.randint(1, TINY_DENSE.dense_offsets),
                    rng.randint(-20, 6), rng.randint(-3, 3))
    return DenseJob(rng.randrange(slots), rng.randrange(slots), one, (rng.choice((1, 1, 2, 5)), rng.choice((1, 1, 3))),
                    rng.randint(4, 40), rng.randint(0, 4), rng.random() < 0.5)


def _capture_pair(h: DenseHost, planes: Planes) -> Script:
    """Frames of one scene from both cameras at the same time into slots 0 and 1, the second one moved."""
    image = texture(h.rng, h.size[0] + 4, h.size[1])
    for camera in (0, 1):
        frame = np.ascontiguousarray(image[:, 4 * camera:4 * camera + h.size[0]])
        planes[camera] = sign(frame, SIGMA, TINY_DENSE.radius)
        yield from h.arm(camera, camera)
        h.show(camera, frame)
    yield from h.captured()


def _check(h: DenseHost, job: DenseJob, planes: Planes, size: tuple[int, int], status: int) -> None:
    """Status and map of a pass against the frame level."""
    wanted, result = run_dense(job, planes, TINY_DENSE, size)
    words = h.take_map()
    assert status == wanted, job
    if result is None:
        assert not words
        return
    shape = map_shape(size, job.step)
    assert len(words) == shape[0] * shape[1]
    found = unpack_map(np.array(words, np.uint64), shape)
    for name in FIELDS:
        assert np.array_equal(getattr(found, name), getattr(result, name)), f"{name} of {job}"


def _pass(h: DenseHost, job: DenseJob, planes: Planes) -> Script:
    yield from h.load(job)
    yield from h.go()
    _check(h, job, planes, h.size, (yield from h.finished()))


def _everyday(h: DenseHost) -> Script:
    """Captures on both cameras, good and refused passes, captures during a pass, counters and interrupt."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes)
    yield from h.write("dense.irq_enable", done=1)
    job = DenseJob(0, 1, DensePass(8, 16, -4), check=True)
    jobs = [job, _random_job(h.rng)]
    yield from h.load(job)
    yield from h.go()
    yield from h.load(jobs[1])  # during the pass
    yield from h.arm(1, 2)
    image = texture(h.rng, *SIZE)
    h.show(1, image)
    planes[2] = sign(image, SIGMA, TINY_DENSE.radius)
    _check(h, job, planes, SIZE, (yield from h.finished()))
    assert h.irq
    yield from h.write("dense.irq_status", done=1)
    yield from h.pause(4)
    assert not h.irq
    yield from h.go()
    _check(h, jobs[1], planes, SIZE, (yield from h.finished()))
    rows = sum((SIZE[1] - 1) // each.step[1] * each.step[1] + 1 for each in jobs)  # up to the last that the map has
    assert (yield from h.read("dense.rows.value")) == rows
    yield from h.captured()
    assert (yield from h.read("counter.frames[1].value")) == 2
    yield from _pass(h, DenseJob(2, 1, DensePass(4, 16, -6), (3, 2)), planes)
    busy = yield from h.read("counter.busy.value")
    assert busy > 2 * SIZE[0] * SIZE[1]
    for name in NO_ARRAY:
        assert (yield from h.read(name)) == 0, name


def _refused(h: DenseHost) -> Script:
    """Every reason to refuse a pass; a start during a pass; a job for the array, which there is not."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes)
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
    _check(h, good, planes, SIZE, (yield from h.finished()))
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
        yield from _capture_pair(h, planes)
        job = replace(_random_job(h.rng), step=(1, 1))
        if moment == 2:
            yield from _pass(h, job, planes)
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
    yield from _capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(8, 12, -3), (2, 1))
    yield from h.load(job)
    yield from h.go()
    yield from h.set_up(SIGMA, OTHER)
    assert (yield from h.read("slot_status.valid")) == 0 and (yield from h.read("dense.run.busy"))
    _check(h, job, planes, SIZE, (yield from h.finished()))
    yield from _pass(h, job, {})  # no slot holds a frame
    planes.clear()
    yield from _capture_pair(h, planes)
    yield from _pass(h, job, planes)
    # Cancelled: whole rows, and the end.
    yield from h.load(replace(job, step=(1, 1)))
    yield from h.go()
    yield from h.until(lambda: len(h.streamed) > 2 * OTHER[0], "two rows")
    yield from h.write("dense.run", cancel=1)
    assert (yield from h.finished()) == CANCELLED
    words = h.take_map()
    assert 2 * OTHER[0] < len(words) < OTHER[0] * OTHER[1] and len(words) % OTHER[0] == 1
    yield from _pass(h, _random_job(h.rng), planes)


def _busy_slots(h: DenseHost) -> Script:
    """Captures into the slots of a pass, begun at any time: the map is of the old frames or, if the capture came
    first, the pass is refused; the frame that gave way is taken the next time it is shown."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes)
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
        _check(h, job, planes if status is DenseStatus.OK else {}, SIZE, status if status is DenseStatus.OK else 3)
        yield from h.until(lambda: not h.beats[0], "frame")
        if (yield from h.read("slot_status.armed")):
            h.show(0, image)
        yield from h.captured()
        planes[0] = sign(image, SIGMA, TINY_DENSE.radius)
    yield from _pass(h, job, planes)
    assert seen[DenseStatus.OK] and seen[DenseStatus.BAD_SLOT], seen


def _accesses(h: DenseHost) -> Script:
    """Random reads of every register of both maps, and harmless writes, during frames and a pass: to the array's
    registers, which a board without it keeps, too."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes)
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
    _check(h, job, planes, SIZE, (yield from h.finished()))
    h.master.write(address("irq_enable"), word("irq_enable"))
    yield from h.write("dense.irq_enable")
    yield from _pass(h, _random_job(h.rng), planes)


def _offers(h: DenseHost) -> Script:
    """None of the offers is lost, and a pass of new frames is right afterwards."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from offers_at_every_moment(h)
    yield from _capture_pair(h, planes)
    yield from _pass(h, _random_job(h.rng), planes)


def _pair(h: DenseHost) -> list[Image]:
    """Two frames of one scene, the second one moved."""
    image = texture(h.rng, h.size[0] + 4, h.size[1])
    return [np.ascontiguousarray(image[:, 4 * camera:4 * camera + h.size[0]]) for camera in (0, 1)]


def _signs(frame: Image) -> Plane:
    return sign(frame, SIGMA, TINY_DENSE.radius)


def _live_pass(h: DenseHost, job: DenseJob, planes: Planes, later: tuple[int, int], slots: tuple[int, int]) -> Script:
    """A live pass over frames of both cameras, armed for `slots`, shown `later` clocks after the start, or before it if
    negative; then the same pass over the whole frames."""
    frames = _pair(h)
    for camera in (0, 1):
        yield from h.arm(camera, slots[camera])
        planes[slots[camera]] = _signs(frames[camera])
    yield from h.load(job)
    begin = max(0, -min(later))
    for clock in range(max(*later, 0) + begin + 1):
        for camera in (0, 1):
            if clock == begin + later[camera]:
                h.show(camera, frames[camera])
        if clock == begin:
            yield from h.go()
        yield
    _check(h, job, planes, h.size, (yield from h.finished()))
    assert not (yield from h.read("slot_status.armed"))
    yield from _pass(h, replace(job, live=False), planes)


def _live(h: DenseHost) -> Script:
    """Live passes over frames that come before, during and after the start, faster and slower than the pass, in either
    order and into either slot, of a slot that holds a frame and one that waits, and of one slot."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    before = yield from h.read("dense.stalls.value")
    delays = (0, 0), (-250, -200), (300, 0), (0, 700), (-100, 150)
    for number, later in enumerate(delays):
        job = replace(_random_job(h.rng), left=number % 2, right=1 - number % 2, live=True)
        down = (0, 2, -3, h.rng.randint(-20, 20), h.rng.randint(-3, 3))[number]
        job = replace(job, search=replace(job.search, down=down))
        yield from _live_pass(h, job, planes, later, h.rng.choice(((0, 1), (1, 0))))
    assert (yield from h.read("dense.stalls.value")) == before or h.stalls["stream"]
    # Both frames are there; the left one is, and the right one comes over an older one; both planes are one slot.
    yield from _pass(h, DenseJob(0, 1, DensePass(8, 16, -4), live=True), planes)
    for job in (DenseJob(0, 1, DensePass(4, 12, -4, 1), live=True), DenseJob(1, 1, DensePass(4, 12, -4), live=True)):
        frame = _pair(h)[1]
        yield from h.arm(1, 1)
        yield from h.load(job)
        yield from h.go()
        yield from h.pause(h.rng.choice((0, 60, 500)))
        h.show(1, frame)
        planes[1] = _signs(frame)
        _check(h, job, planes, SIZE, (yield from h.finished()))


def _lost(h: DenseHost) -> Script:
    """Frames of live passes that are cut short, aborted, cancelled or given up for another size: the pass ends, says
    so, and the next one over what the slots hold is right."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(8, 16, -4), live=True)
    yield from h.load(replace(job, right=2))
    yield from h.go()
    assert (yield from h.finished()) == DenseStatus.BAD_SLOT and not h.streamed
    yield from h.load(job)
    for how in ("cut_frame", "short_line", "extra_line", "cancelled", "stopped", "moved", "aborted"):
        frames, camera = _pair(h), h.rng.randrange(2)
        slots = (0, 1)
        for c in (0, 1):
            yield from h.arm(c, slots[c])
        yield from h.go()
        h.show(1 - camera, frames[1 - camera])
        if how == "moved":
            yield from h.arm(camera, 2)
        elif how in ("cancelled", "stopped", "aborted"):
            h.beats[camera].extend(good(frames[camera]).beats[:SIZE[0] * (SIZE[1] - 1)])
            yield from h.until(partial(_sent, h, camera), "a part of a frame")
            yield from h.pause(200)
            if how == "aborted":
                yield from h.write("filter", **{f"abort_{camera}": 1})
            elif how == "cancelled":
                yield from h.write("capture", camera=camera, cancel=1, go=1)
            else:
                yield from h.write("dense.run", cancel=1)
        else:
            beats = good(frames[camera]).beats
            whole = SIZE[0] * (SIZE[1] if how == "extra_line" else SIZE[1] - 2)
            rest = {"cut_frame": 0, "short_line": h.rng.randint(1, SIZE[0] - 1), "extra_line": SIZE[0]}[how]
            end = [(7, 0, int(n == rest - 1)) for n in range(rest)]
            h.beats[camera].extend([*beats[:whole], *end])
            h.show(camera, texture(h.rng, *SIZE))  # which ends the bad one, and may give way
        status = yield from h.finished()
        assert status == (CANCELLED if how == "stopped" else LOST), (how, status)
        marks = [last for _, _, last in h.streamed]
        assert sum(marks) == marks[-1] == 1 and len(marks) <= SIZE[0] * SIZE[1], how
        h.streamed.clear()
        # A frame that was not ended ends; what is armed gets a frame; then slots and passes are as ever.
        yield from h.until(lambda: not (h.beats[0] or h.beats[1]), "frames")
        if how in ("cancelled", "stopped"):
            yield from h.write("filter", **{f"abort_{camera}": 1})
        yield from h.pause(SIZE[0] * 12)
        for c in (0, 1):
            yield from h.write("capture", camera=c, cancel=1, go=1)
        yield from _capture_pair(h, planes)
        yield from _pass(h, replace(_random_job(h.rng), live=True), planes)
        yield from h.load(job)
    # Another size while the pass waits for the second frame.
    yield from h.arm(0, 0)
    yield from h.arm(1, 1)
    yield from h.go()
    h.show(0, _pair(h)[0])
    yield from h.pause(700)
    yield from h.set_up(SIGMA, OTHER)
    assert (yield from h.finished()) == LOST
    h.streamed.clear()
    yield from h.write("capture", camera=1, cancel=1, go=1)
    planes.clear()
    yield from _live_pass(h, job, planes, (0, 0), (0, 1))


def _sent(h: DenseHost, camera: int) -> bool:
    """Whether a camera has sent all that it was given."""
    return not h.beats[camera]


def _live_resets(h: DenseHost) -> Script:
    """A reset while a live pass waits for its frames, and with one under way; the next live pass is whole."""
    for clocks in (100, 900):
        planes: Planes = {}
        yield from h.set_up(SIGMA, SIZE)
        job = replace(_random_job(h.rng), left=0, right=1, live=True)
        yield from h.arm(0, 0)
        yield from h.arm(1, 1)
        yield from h.load(job)
        yield from h.go()
        for camera, frame in enumerate(_pair(h)):
            h.show(camera, frame)
        yield from h.pause(clocks)
        assert (yield from h.read("dense.run.busy"))
        yield from h.reset(1)
        assert not (yield from h.read("dense.run.busy"))
        yield from h.set_up(SIGMA, SIZE)
        yield from _live_pass(h, job, planes, (50, 0), (0, 1))


async def _scenario(dut, script: Callable[[DenseHost], Script], video: str = "none", sink: str = "none",
                    bus: str = "none") -> DenseHost:
    host = DenseHost(TINY_DENSE, random.Random(cocotb.RANDOM_SEED), video, sink, bus)
    model = DenseBoardModel(TINY_DENSE, fields(), dense_fields())
    clocks = await check_cycles(dut, model, host.play(script(host)), reset_clocks=RESET_START)
    assert clocks > 2000 and host.master.finished > 60
    return host


@cocotb.test()
@cocotb.parametrize((("video", "sink", "bus"), [("none", "none", "none"), ("long", "random", "cyclic")]))
async def everyday_work(dut, video: str, sink: str, bus: str) -> None:
    host = await _scenario(dut, _everyday, video, sink, bus)
    assert sink == "none" or host.stalls["stream"] > 10


def _slowly(script: Callable[[DenseHost], Script], share: float) -> Callable[[DenseHost], Script]:
    """The script, with cameras that offer a pixel in this share of the clocks."""
    def slow(h: DenseHost) -> Script:
        h.offer = [coin(share, h.rng) for _ in h.offer]
        yield from script(h)
    return slow


@cocotb.test()
@cocotb.parametrize((("video", "sink", "bus"), [("none", "none", "none"), ("slow", "random", "none"),
                                               ("long", "long", "random")]))
async def live_passes(dut, video: str, sink: str, bus: str) -> None:
    script = _slowly(_live, 0.3) if video == "slow" else _live
    await _scenario(dut, script, "none" if video == "slow" else video, sink, bus)


@cocotb.test()
@cocotb.parametrize((("video", "sink"), [("none", "none"), ("random", "cyclic")]))
async def live_frames_lost(dut, video: str, sink: str) -> None:
    await _scenario(dut, _lost, video, sink)


@cocotb.test()
async def live_resets(dut) -> None:
    await _scenario(dut, _live_resets, "cyclic", "random")


@cocotb.test()
async def passes_refused(dut) -> None:
    await _scenario(dut, _refused, sink="random", bus="long")


@cocotb.test()
async def reset_in_the_middle(dut) -> None:
    await _scenario(dut, _resets, video="random", sink="cyclic")


@cocotb.test()
async def changes_between_frames(dut) -> None:
    await _scenario(dut, _changes, video="cyclic", sink="cyclic", bus="random")


@cocotb.test()
async def captures_into_busy_slots(dut) -> None:
    await _scenario(dut, _busy_slots)


@cocotb.test()
async def access_during_work(dut) -> None:
    await _scenario(dut, _accesses, video="cyclic", sink="long", bus="random")


@cocotb.test()
async def offers(dut) -> None:
    await _scenario(dut, _offers)


@pytest.mark.slow
def test_dense_board() -> None:
    simulate("slog_dense_board", __name__, ports=AXI_PORTS, config="tiny_dense")
