# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_board` (`tiny_dense`) in live passes, against its cycle model on every clock and the frame level.

Cameras are faster and slower than the pass, early and late, and some break off.
"""

from collections.abc import Callable
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
    pair_of_frames,
    random_job,
    run_pass,
    run_scenario,
    signs_of,
)
from cocotb_tests.env.host import Script
from golden.cycle.dense.structs import CANCELLED, LOST
from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseStatus
from golden.traffic.stalls import coin
from golden.traffic.video import good, texture
from sim.testbench.runner import AXI_PORTS, simulate


def _live_pass(h: DenseHost, job: DenseJob, planes: Planes, later: tuple[int, int], slots: tuple[int, int]) -> Script:
    """A live pass over frames of both cameras, armed for `slots`, shown `later` clocks after the start, or before it if
    negative; then the same pass over the whole frames."""
    frames = pair_of_frames(h)
    for camera in (0, 1):
        yield from h.arm(camera, slots[camera])
        planes[slots[camera]] = signs_of(frames[camera])
    yield from h.load(job)
    begin = max(0, -min(later))
    for clock in range(max(*later, 0) + begin + 1):
        for camera in (0, 1):
            if clock == begin + later[camera]:
                h.show(camera, frames[camera])
        if clock == begin:
            yield from h.go()
        yield
    check_map(h, job, planes, h.size, (yield from h.finished()))
    assert not (yield from h.read("slot_status.armed"))
    yield from run_pass(h, replace(job, live=False), planes)


def _live(h: DenseHost) -> Script:
    """Live passes over frames that come before, during and after the start, faster and slower than the pass, in either
    order and into either slot, of a slot that holds a frame and one that waits, and of one slot."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    before = yield from h.read("dense.stalls.value")
    delays = (0, 0), (-250, -200), (300, 0), (0, 700), (-100, 150)
    for number, later in enumerate(delays):
        job = replace(random_job(h.rng), left=number % 2, right=1 - number % 2, live=True)
        down = (0, 2, -3, h.rng.randint(-20, 20), h.rng.randint(-3, 3))[number]
        job = replace(job, search=replace(job.search, down=down))
        yield from _live_pass(h, job, planes, later, h.rng.choice(((0, 1), (1, 0))))
    assert (yield from h.read("dense.stalls.value")) == before or h.stalls["stream"]
    # Both frames are there; the left one is, and the right one comes over an older one; both planes are one slot.
    yield from run_pass(h, DenseJob(0, 1, DensePass(8, 16, -4), live=True), planes)
    for job in (DenseJob(0, 1, DensePass(4, 12, -4, 1), live=True), DenseJob(1, 1, DensePass(4, 12, -4), live=True)):
        frame = pair_of_frames(h)[1]
        yield from h.arm(1, 1)
        yield from h.load(job)
        yield from h.go()
        yield from h.pause(h.rng.choice((0, 60, 500)))
        h.show(1, frame)
        planes[1] = signs_of(frame)
        check_map(h, job, planes, SIZE, (yield from h.finished()))


def _lost(h: DenseHost) -> Script:
    """Frames of live passes that are cut short, aborted, cancelled or given up for another size: the pass ends, says
    so, and the next one over what the slots hold is right."""
    planes: Planes = {}
    yield from h.set_up(SIGMA, SIZE)
    yield from capture_pair(h, planes)
    job = DenseJob(0, 1, DensePass(8, 16, -4), live=True)
    yield from h.load(replace(job, right=2))
    yield from h.go()
    assert (yield from h.finished()) == DenseStatus.BAD_SLOT and not h.streamed
    yield from h.load(job)
    for how in ("cut_frame", "short_line", "extra_line", "cancelled", "stopped", "moved", "aborted"):
        frames, camera = pair_of_frames(h), h.rng.randrange(2)
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
        yield from capture_pair(h, planes)
        yield from run_pass(h, replace(random_job(h.rng), live=True), planes)
        yield from h.load(job)
    # Another size while the pass waits for the second frame.
    yield from h.arm(0, 0)
    yield from h.arm(1, 1)
    yield from h.go()
    h.show(0, pair_of_frames(h)[0])
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
        job = replace(random_job(h.rng), left=0, right=1, live=True)
        yield from h.arm(0, 0)
        yield from h.arm(1, 1)
        yield from h.load(job)
        yield from h.go()
        for camera, frame in enumerate(pair_of_frames(h)):
            h.show(camera, frame)
        yield from h.pause(clocks)
        assert (yield from h.read("dense.run.busy"))
        yield from h.reset(1)
        assert not (yield from h.read("dense.run.busy"))
        yield from h.set_up(SIGMA, SIZE)
        yield from _live_pass(h, job, planes, (50, 0), (0, 1))


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
    await run_scenario(dut, script, "none" if video == "slow" else video, sink, bus)


@cocotb.test()
@cocotb.parametrize((("video", "sink"), [("none", "none"), ("random", "cyclic")]))
async def live_frames_lost(dut, video: str, sink: str) -> None:
    await run_scenario(dut, _lost, video, sink)


@cocotb.test()
async def live_resets(dut) -> None:
    await run_scenario(dut, _live_resets, "cyclic", "random")


@pytest.mark.slow
def test_dense_live() -> None:
    simulate("slog_dense_board", __name__, ports=AXI_PORTS, config="tiny_dense")
