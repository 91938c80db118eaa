# SPDX-License-Identifier: Apache-2.0
"""`slog_board` (`tiny`) against its cycle model on every clock, its results against the frame level."""

import random
from collections import deque
from collections.abc import Generator
from dataclasses import replace

import cocotb
import numpy as np
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.host import Host, Script
from cocotb_tests.env.offers import offers_at_every_moment
from golden.correlate import Job, Plane, Status, grid, run, surface
from golden.cycle.board import RESET_START, BoardModel
from golden.log import sign
from golden.params import TINY
from golden.traffic.peak import surface_beats
from golden.traffic.stalls import SHAPES
from golden.traffic.video import BAD_KINDS, bad, texture
from sim.registers.map import address, fields, word
from sim.testbench.runner import AXI_PORTS, simulate

SIGMA = 1.5
SIZE = 21, 19


def _random_job(rng: random.Random, tag: int, size: tuple[int, int], slots: int = 2) -> Job:
    """A good job of any kind."""
    width, height = (rng.randint(TINY.min_window, TINY.max_window) for _ in range(2))
    across, down = rng.randint(1, min(8, size[0] - width + 1)), rng.randint(1, min(5, size[1] - height + 1))
    return Job(rng.randrange(slots), rng.randint(0, size[0] - width), rng.randint(0, size[1] - height), width, height,
               rng.randrange(slots), rng.randint(0, size[0] - width - across + 1),
               rng.randint(0, size[1] - height - down + 1), across, down, tag, rng.random() < 0.5)


def _refused_jobs(tag: int) -> list[Job]:
    """One job per reason to refuse it."""
    good = {"tpl_slot": 0, "tpl_x": 0, "tpl_y": 0, "width": 4, "height": 4, "search_slot": 1, "search_x": 0,
            "search_y": 0, "offsets_x": 2, "offsets_y": 2}
    wrong = ({"width": TINY.max_window + 1}, {"height": TINY.min_window - 1}, {"offsets_x": 0}, {"offsets_y": 0},
             {"tpl_slot": 5}, {"search_slot": 7}, {"tpl_x": SIZE[0] - 3}, {"search_y": SIZE[1] - 4})
    return [Job(**{**good, **w}, tag=tag + k) for k, w in enumerate(wrong)]  # type: ignore[arg-type]


def _capture_pair(h: Host, planes: dict[int, Plane], slots: tuple[int, int]) -> Script:
    """A frame from each camera at the same time, read back and compared with the frame-level LoG."""
    for camera, slot in enumerate(slots):
        image = texture(h.rng, *h.size)
        planes[slot] = sign(image, SIGMA, TINY.radius)
        yield from h.arm(camera, slot)
        h.show(camera, image)
    yield from h.captured()
    for slot in slots:
        assert np.array_equal((yield from h.plane(slot)), planes[slot]), f"plane of slot {slot}"


def _check_results(h: Host, jobs: list[Job], planes: dict[int, Plane]) -> None:
    """Results and streamed surfaces against the frame level."""
    for result, job in zip(h.results, jobs, strict=True):
        assert result == run(job, planes, TINY, h.size), f"{result} of {job}"
    streamed = deque(h.streamed)
    for job, result in zip(jobs, h.results, strict=True):
        if job.surface and result.status is Status.OK:
            want = surface_beats(surface(planes[job.tpl_slot], planes[job.search_slot], job))
            assert [streamed.popleft() for _ in want] == want, f"surface of job {job.tag}"
    assert not streamed
    h.results.clear()
    h.streamed.clear()


def _jobs_during_captures(h: Host, planes: dict[int, Plane], jobs: list[Job], frames: int) -> Script:
    """Jobs run while camera 1 fills slot 2 repeatedly; results are taken as they arrive."""
    waiting = list(jobs)
    shown = 0
    yield from h.write("irq_enable", capture=1)
    while waiting or len(h.results) < len(jobs):
        if waiting and (yield from h.read("job.status.ready")):
            yield from h.submit(waiting.pop(0))
        if (yield from h.read("result.head.valid")):
            yield from h.collect(1)
        if shown < frames and not (yield from h.read("slot_status.armed")):
            yield from h.arm(1, 2)
            image = texture(h.rng, *h.size)
            planes[2] = sign(image, SIGMA, TINY.radius)
            h.show(1, image)
            shown += 1
            yield from h.until(lambda: not h.beats[1] or len(waiting) > 2, "frame")
    yield from h.captured()
    assert h.irq and shown == frames
    yield from h.write("irq_status", capture=1)
    yield from h.pause(4)
    assert not h.irq
    assert np.array_equal((yield from h.plane(2)), planes[2])


def _busy_until_the_result(h: Host) -> Script:
    """The status of a single job and of a grid, read all the time from their submission on, and once after their
    results. The single one may have ended before a slow bus answers."""
    for count in ((1, 1), (4, 3)):
        yield from h.submit(Job(0, 1, 1, 6, 5, 1, 2, 2, 4, 3, tag=90), count, (2, 1))
        seen = []
        for _ in range(40):
            seen.append((yield from h.read("job.status.busy")))
        yield from h.collect(count[0] * count[1])
        assert (yield from h.read("job.status.busy")) == 0
    assert 1 in seen
    h.results.clear()


def _busy_at_once(h: Host) -> Script:
    """The status in the access that follows a submit to the idle board without a pause, on a bus without stalls: the
    job is in the queue, but not yet at its end, and nothing else tells of it."""
    yield from h.submit(Job(0, 1, 1, 6, 5, 1, 2, 2, 4, 3, tag=92))
    yield from h.collect(1)
    assert (yield from h.read("job.status.busy")) == 0
    status = fields()["job.status.busy"]
    h.master.overlap = 3
    h.master.write(address("job.submit"), word("job.submit", tag=93, go=1))
    # Reads and writes take turns, so one read may come before the submit; the other follows it.
    reads = [h.master.read(status.address) for _ in range(2)]
    yield from h.until(lambda: h.master.idle, "submit")
    h.master.overlap = 1
    assert status.unpack(reads[1].data or 0) == 1
    yield from h.collect(1)
    h.results.clear()


def _everyday(h: Host) -> Script:
    """Captures on both cameras, good and refused jobs, captures during work."""
    planes: dict[int, Plane] = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes, (0, 1))
    large = Job(0, 2, 3, 7, 6, 1, 0, 0, 9, 8, tag=14, surface=True)  # whatever is drawn, some scores are stalled
    jobs = [replace(_random_job(h.rng, tag, SIZE), surface=tag < 5) for tag in range(6)] + _refused_jobs(6) + [large]
    h.rng.shuffle(jobs)
    yield from _jobs_during_captures(h, planes, jobs, 2)
    _check_results(h, jobs, {s: planes[s] for s in (0, 1)})
    assert (yield from h.read("counter.jobs.value")) == 7
    assert (yield from h.read("counter.refused.value")) == 8
    assert (yield from h.read("counter.frames[0].value")) == 1
    assert (yield from h.read("counter.frames[1].value")) == 3
    scores = sum(j.offsets_x * j.offsets_y for j in jobs if run(j, planes, TINY, SIZE).status is Status.OK)
    assert (yield from h.read("counter.scores.value")) == scores
    yield from _busy_until_the_result(h)


def _full_queues(h: Host) -> Script:
    """No result is taken until every queue is full; nothing is lost but the submit counted as an overflow."""
    planes: dict[int, Plane] = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes, (0, 1))
    yield from _busy_at_once(h)
    yield from h.write("irq_enable", result=1)
    assert not h.irq
    job = Job(0, 1, 2, 5, 4, 1, 0, 1, 3, 2, tag=65533)
    laid = grid(job, (5, 3), (2, 1))
    yield from h.submit(job, (5, 3), (2, 1))
    jobs = list(laid)
    while True:
        extra = _random_job(h.rng, len(jobs), SIZE)
        ready = yield from h.read("job.status.ready")
        if ready:
            jobs.append(extra)
            yield from h.submit(extra)
            continue
        # Not ready: for a moment, or until a result is taken because everything is full.
        before = yield from h.read("counter.scores.value")
        yield from h.pause(300)
        if not (yield from h.read("job.status.ready")) and (yield from h.read("counter.scores.value")) == before:
            yield from h.submit(extra)
            break
    assert (yield from h.read("counter.overflows.value")) == 1
    assert (yield from h.read("irq_status.overflow")) == 1
    assert (yield from h.read("result.pop.waiting")) == TINY.result_depth
    assert (yield from h.read("job.status.waiting")) == TINY.job_depth
    assert h.irq
    yield from h.collect(len(jobs))
    _check_results(h, jobs, planes)
    yield from h.pause(5)
    assert not h.irq and len(jobs) > TINY.result_depth + TINY.job_depth


def _resets(h: Host) -> Script:
    """Reset in mid-frame, in mid-job and during a read; afterwards the board works as new each time."""
    for moment in range(3):
        planes: dict[int, Plane] = {}
        yield from h.set_up(SIGMA, SIZE)
        yield from _capture_pair(h, planes, (moment, 4))
        jobs = [Job(moment, 2, 3, 7, 6, 4, 0, 0, 9, 8, tag, True) for tag in range(3)]
        for job in jobs:
            yield from h.submit(job)
        if moment == 2:
            yield from h.collect(3)
            _check_results(h, jobs, planes)
            return
        yield from h.arm(0, 5)
        h.show(0, texture(h.rng, *SIZE))
        yield from h.pause(60 + 70 * moment)
        h.master.read(address("peek_data"))
        yield from h.pause(moment)
        assert h.beats[0], "the reset comes too late to be in mid-frame"
        yield from h.reset(1 + moment)
        assert (yield from h.read("slot_status.valid")) == 0
        assert (yield from h.read("counter.frames[0].value")) == 0
        assert (yield from h.read("image_active.width")) == TINY.max_width
        assert not (yield from h.read("job.status.busy"))


def _drop_broken_frames(h: Host, kinds: tuple[str, ...]) -> Script:
    """Each kind of broken frame before a good one: dropped and counted, and the good one is captured."""
    planes: dict[int, Plane] = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from h.write("irq_enable", drop=1)
    for n, kind in enumerate(kinds):
        camera, slot = n % 2, n
        yield from h.arm(camera, slot)
        h.beats[camera].extend(bad(kind, texture(h.rng, *SIZE), h.rng).beats)
        image = texture(h.rng, *SIZE)
        planes[slot] = sign(image, SIGMA, TINY.radius)
        h.show(camera, image)
        yield from h.until(lambda: not any(h.beats), "video")
        yield from h.captured()
        assert h.irq
        yield from h.write("irq_status", drop=1)
    drops = yield from h.read("counter.drops[0].value")
    drops += yield from h.read("counter.drops[1].value")
    assert drops == len(kinds)
    for slot, plane in planes.items():
        got = yield from h.plane(slot)
        assert np.array_equal(got, plane), f"slot {slot} after {kinds[slot]}"
    # A request cancelled in mid-frame leaves its slot invalid; a slot is granted to one camera only.
    yield from h.arm(0, 0)
    yield from h.write("capture", camera=1, slot=0, go=1)
    assert (yield from h.read("slot_status.refused"))
    h.show(0, texture(h.rng, *SIZE))
    while not (yield from h.read("slot_status.writing")):
        pass
    yield from h.write("capture", camera=0, cancel=1, go=1)
    yield from h.until(lambda: not any(h.beats), "video")
    assert not (yield from h.read("slot_status.armed"))
    assert not (yield from h.read("slot_status.valid")) & 1


def _accesses(h: Host) -> Generator[None, None, None]:
    """Random reads of every register, and harmless writes, during frames and jobs."""
    planes: dict[int, Plane] = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from _capture_pair(h, planes, (0, 1))
    jobs = [_random_job(h.rng, tag, SIZE) for tag in range(5)]
    for job in jobs:
        yield from h.submit(job)
    places = sorted({f.address for f in fields().values()})
    harmless = [address(r) for r in ("job.tpl", "job.window", "job.search", "job.offsets", "irq_enable", "irq_status")]
    h.master.overlap = 6
    reads = 0
    for _ in range(1700):
        if not h.beats[0]:
            h.show(0, texture(h.rng, *SIZE))
        if len(h.master.waiting) < 6:
            if h.rng.random() < 0.7:
                h.master.read(h.rng.choice(places))
                reads += 1
            else:
                h.master.write(h.rng.choice(harmless), h.rng.getrandbits(32), h.rng.getrandbits(4))
        yield
    yield from h.until(lambda: h.master.idle, "bus")
    h.master.overlap = 1
    assert reads > 100
    yield from h.write("irq_enable")
    yield from h.collect(len(jobs))
    _check_results(h, jobs, planes)


def _offers(h: Host) -> Script:
    """None of the offers is lost, and frames come in afterwards."""
    yield from h.set_up(SIGMA, SIZE)
    yield from offers_at_every_moment(h)
    yield from _capture_pair(h, {}, (0, 1))


async def _scenario(dut, script, video: str = "none", sink: str = "none", bus: str = "none") -> Host:
    rng = random.Random(cocotb.RANDOM_SEED)
    host = Host(TINY, rng, video, sink, bus)
    clocks = await check_cycles(dut, BoardModel(TINY, fields()), host.play(script(host)),
                                reset_clocks=RESET_START)
    assert clocks > 2000 and host.master.finished > 100
    return host


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def everyday_work(dut, shape: str) -> None:
    host = await _scenario(dut, _everyday, shape, shape, shape)
    assert shape == "none" or host.stalls["stream"] > 10


@cocotb.test()
async def queues_full(dut) -> None:
    await _scenario(dut, _full_queues, sink="random")


@cocotb.test()
async def reset_in_the_middle(dut) -> None:
    await _scenario(dut, _resets, video="random")


@cocotb.test()
@cocotb.parametrize((("shape", "kinds"), [("none", BAD_KINDS[:3]), ("random", BAD_KINDS[3:])]))
async def broken_frames(dut, shape: str, kinds: tuple[str, ...]) -> None:
    await _scenario(dut, lambda h: _drop_broken_frames(h, kinds), video=shape)


@cocotb.test()
async def access_during_work(dut) -> None:
    await _scenario(dut, _accesses, video="cyclic", sink="long", bus="random")


@cocotb.test()
async def offers(dut) -> None:
    await _scenario(dut, _offers)


@pytest.mark.slow
def test_board() -> None:
    simulate("slog_board", __name__, ports=AXI_PORTS)


@pytest.mark.slow
def test_board_with_gated_clocks() -> None:
    """Stopping the clocks of idle blocks, as the fast build does, changes no output."""
    simulate("slog_board", __name__, ports=AXI_PORTS, defines={"SLOG_CLOCK_GATE": "1"},
             testcase="everyday_work/shape=random|reset_in_the_middle|broken_frames/shape=none|access_during_work")
