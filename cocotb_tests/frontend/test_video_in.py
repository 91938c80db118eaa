# SPDX-License-Identifier: Apache-2.0
"""`slog_video_in` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.frontend.video_in import VideoInModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY
from golden.traffic.stalls import SHAPES, ready_pattern
from golden.traffic.video import BAD_KINDS, Beat, bad, good, play, stray, texture
from sim.coverage.record import met
from sim.testbench.runner import simulate

WIDTH, HEIGHT = 19, 18


@cocotb.test()
@cocotb.parametrize(source=SHAPES, held=(False, True))
async def every_clock(dut, source: str, held: bool) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    kinds = rng.sample(BAD_KINDS, len(BAD_KINDS))
    items = [stray(rng, 30)]
    for kind in kinds:
        items += [good(texture(rng, WIDTH, HEIGHT)) for _ in range(rng.randint(int(kind == kinds[0]), 1))]
        items.append(bad(kind, texture(rng, WIDTH, HEIGHT), rng))
    items += [good(texture(rng, WIDTH, HEIGHT)), stray(rng, 3), good(texture(rng, WIDTH, HEIGHT))]
    counts = {"accepted_o": 0, "dropped_o": 0, "px_start_o": 0, "px_abort_o": 0, "px_done_o": 0}

    def count(i: Inputs, out: Outputs) -> None:
        for name in counts:
            counts[name] += out[name] or 0

    met("video", {f"{kind}, {how}": 1 for kind in kinds for how in (f"source {source}", f"held {held}")})
    hold = ready_pattern("long", rng) if held else None
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    await check_cycles(dut, VideoInModel(params()["Radius"]),
                       play(items, settings, ready_pattern(source, rng), rng, gap=40, hold=hold), count)
    if not held:  # under hold, surplus lines wait until the frame before has left
        assert counts["accepted_o"] == sum(i.good is not None for i in items)
    assert counts["dropped_o"] == sum(i.drops for i in items)
    assert counts["px_done_o"] == counts["accepted_o"] >= 3
    assert counts["px_start_o"] == counts["px_done_o"] + counts["px_abort_o"]


@cocotb.test()
async def reset_in_mid_frame(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    frame = WIDTH * HEIGHT
    done = 0

    def stimulus() -> Stimulus:
        for _ in range(8):
            items = [good(texture(rng, WIDTH, HEIGHT)) for _ in range(3)]
            run = play(items, settings, ready_pattern("random", rng), rng)
            i = next(run)
            try:
                for _ in range(rng.randint(1, 5 * frame)):
                    i = run.send((yield i))
            except StopIteration:
                pass
            yield {**settings, "rst_i": 1, "tvalid_i": 1, "tdata_i": 3, "tuser_i": rng.getrandbits(1)}
        frames = [good(texture(rng, WIDTH, HEIGHT)) for _ in range(3)]
        yield from play(frames, settings, ready_pattern("none", rng), rng)

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal done
        done += out["px_done_o"] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]), stimulus(), count)
    assert done >= 3


@cocotb.test()
@cocotb.parametrize(clocks=(1, 2))
async def resets_around_first_output_row(dut, clocks: int) -> None:
    """After a reset in any clock around the start of the first output row the unit is idle, and a frame passes."""
    rng = random.Random(cocotb.RANDOM_SEED)
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    first_row = (params()["Radius"] + 1) * WIDTH  # beats before the frame's first output row can start
    done = 0

    def stimulus() -> Stimulus:
        for moment in range(first_row - 6, first_row + WIDTH + 12):
            run = play([good(texture(rng, WIDTH, HEIGHT))], settings, ready_pattern("none", rng), rng)
            i = next(run)
            for _ in range(moment):
                i = run.send((yield i))
            for _ in range(clocks):
                yield {**settings, "rst_i": 1, "tvalid_i": rng.getrandbits(1), "tdata_i": 3}
            for _ in range(8):
                out = yield settings
                assert not out["busy_o"] and not out["px_valid_o"]
        yield from play([good(texture(rng, WIDTH, HEIGHT))], settings, ready_pattern("none", rng), rng)

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal done
        done += out["px_done_o"] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]), stimulus(), count)
    assert done == 1


@cocotb.test()
@cocotb.parametrize(frames=(1, 2, 3))
async def cut_by_frames_of_one_beat(dut, frames: int) -> None:
    """Frames of one beat directly after each other and after the frame they cut: each is a drop of its own."""
    rng = random.Random(cocotb.RANDOM_SEED)
    items = [good(texture(rng, WIDTH, HEIGHT))]
    for _ in range(4):
        items.append(bad("cut_frame", texture(rng, WIDTH, HEIGHT), rng))
        items += [bad("one_beat", texture(rng, WIDTH, HEIGHT), rng) for _ in range(frames)]
        items += [good(texture(rng, WIDTH, HEIGHT)) for _ in range(rng.randint(0, 1))]
    items.append(good(texture(rng, WIDTH, HEIGHT)))
    counts = {"dropped_o": 0, "px_done_o": 0}

    def count(i: Inputs, out: Outputs) -> None:
        for name in counts:
            counts[name] += out[name] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]),
                       play(items, {"width_i": WIDTH, "height_i": HEIGHT}, ready_pattern("none", rng), rng), count)
    assert counts == {"dropped_o": 4 * (1 + frames), "px_done_o": sum(i.good is not None for i in items)}


@cocotb.test()
@cocotb.parametrize(source=("none", "random"))
async def aborts_at_any_time(dut, source: str) -> None:
    """Aborts in and between frames, good and bad: each frame that is begun to be output is either done or aborted.

    What becomes of the good frames is not left to chance: in turn they pass, are aborted before or after their output
    begins, or are followed by an abort. Bad frames are aborted or not.
    """
    rng = random.Random(cocotb.RANDOM_SEED)
    items = [stray(rng, 30)]
    for kind in (*BAD_KINDS, *BAD_KINDS):
        items += [good(texture(rng, WIDTH, HEIGHT)), bad(kind, texture(rng, WIDTH, HEIGHT), rng)]
    items.append(good(texture(rng, WIDTH, HEIGHT)))
    counts = {"accepted_o": 0, "dropped_o": 0, "px_start_o": 0, "px_abort_o": 0, "px_done_o": 0}
    in_frames = clock = starts = 0
    plan, due = "pass", -1

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal in_frames, clock, starts, plan, due
        clock += 1
        in_frames += i["abort_i"] and out["busy_o"]
        for name in counts:
            counts[name] += out[name] or 0
        if i["tvalid_i"] and i["tuser_i"] and out["tready_o"]:  # one start of frame in each item but the stray pixels
            good_plan = ("pass", "early", "late", "after")[starts // 2 % 4]
            plan = rng.choice(("pass", "early")) if starts % 2 else good_plan
            starts += 1
            due = clock + rng.randrange(150) if plan == "early" else -1
        elif (plan == "late" and out["px_start_o"]) or (plan == "after" and out["accepted_o"]):
            due = clock + rng.randrange(120)

    aborts = (int(clock == due) for _ in iter(int, 1))
    await check_cycles(dut, VideoInModel(params()["Radius"]),
                       play(items, {"width_i": WIDTH, "height_i": HEIGHT}, ready_pattern(source, rng), rng, gap=40,
                            abort=aborts), count)
    met("video", {"abort in a frame": in_frames, "abort of a frame being output": counts["px_abort_o"]})
    assert in_frames >= 6 and counts["px_abort_o"] >= 3
    assert counts["dropped_o"] >= 6 + len(BAD_KINDS)
    assert counts["px_done_o"] == counts["accepted_o"] >= 2
    assert counts["px_start_o"] == counts["px_done_o"] + counts["px_abort_o"]


@cocotb.test()
async def abort_of_a_frame_that_never_ends(dut) -> None:
    """A camera stops after any number of beats: under hold the unit stays busy until the abort, then it is free.

    The frame counts as one drop, the rest of it is ignored, and the next frame passes.
    """
    rng = random.Random(cocotb.RANDOM_SEED)
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    frame = WIDTH * HEIGHT
    stops = [1, WIDTH - 1, WIDTH, WIDTH + 1, frame - 1, *rng.sample(range(1, frame), 6)]
    dropped = done = 0

    def send(beats: list[Beat]) -> Stimulus:
        for data, user, last in beats:
            yield {**settings, "tvalid_i": 1, "tdata_i": data, "tuser_i": user, "tlast_i": last}

    def stimulus() -> Stimulus:
        for stop in stops:
            beats = good(texture(rng, WIDTH, HEIGHT)).beats
            yield from send(beats[:stop])
            for _ in range(60):
                out = yield {**settings, "hold_i": 1}
            assert out["busy_o"], "a frame that is not complete"
            yield {**settings, "hold_i": 1, "abort_i": 1}
            for _ in range(60):
                out = yield {**settings, "hold_i": 1}
            assert not out["busy_o"], f"busy after the abort of a frame of {stop} beats"
            yield from send(beats[stop:])
            yield from play([good(texture(rng, WIDTH, HEIGHT))], settings, ready_pattern("none", rng), rng)

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal dropped, done
        dropped += out["dropped_o"] or 0
        done += out["px_done_o"] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]), stimulus(), count)
    assert dropped == done == len(stops)


def _send(settings: Inputs, beats: list[Beat]) -> Stimulus:
    """Beats without gaps."""
    for data, user, last in beats:
        yield {**settings, "tvalid_i": 1, "tdata_i": data, "tuser_i": user, "tlast_i": last}


@cocotb.test()
@cocotb.parametrize(how=("abort", "start", "last"))
async def breaks_around_first_output_row(dut, how: str) -> None:
    """A frame breaks in any clock around the start of its first output row: it is output never, or until its abort."""
    rng = random.Random(cocotb.RANDOM_SEED)
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    first_row = (params()["Radius"] + 1) * WIDTH
    moments = range(first_row - 3, first_row + 8)
    counts = dict.fromkeys(("px_start_o", "px_abort_o", "px_done_o", "dropped_o"), 0)

    def stimulus() -> Stimulus:
        for moment in moments:
            beats = good(texture(rng, WIDTH, HEIGHT)).beats
            yield from _send(settings, beats[:moment])
            if how == "abort":
                yield {**settings, "abort_i": 1}
            elif how == "start":
                yield from _send(settings, good(texture(rng, WIDTH, HEIGHT)).beats)
            else:
                yield from _send(settings, [(0, 0, int(moment % WIDTH != WIDTH - 1))])
            for _ in range((params()["Radius"] + 2) * WIDTH):
                yield settings

    def count(i: Inputs, out: Outputs) -> None:
        for name in counts:
            counts[name] += out[name] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]), stimulus(), count)
    assert counts["dropped_o"] == len(moments)
    assert counts["px_done_o"] == len(moments) * (how == "start")
    assert 0 < counts["px_abort_o"] == counts["px_start_o"] - counts["px_done_o"] < len(moments)


@cocotb.test()
async def last_line_ends_early(dut) -> None:
    """The last line ends early and stray pixels follow: one drop, because they still belong to the dropped frame."""
    rng = random.Random(cocotb.RANDOM_SEED)
    settings = {"width_i": WIDTH, "height_i": HEIGHT}
    dropped = 0

    def stimulus() -> Stimulus:
        for left in range(1, WIDTH):
            beats = good(texture(rng, WIDTH, HEIGHT)).beats[:-left]
            yield from _send(settings, [*beats[:-1], (*beats[-1][:2], 1), *[(1, 0, 0)] * 5, (1, 0, 1), (1, 0, 0)])

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal dropped
        dropped += out["dropped_o"] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]), stimulus(), count)
    assert dropped == WIDTH - 1


@cocotb.test()
async def tall_frame(dut) -> None:
    """A frame of more than 512 rows."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width, height = 2 * params()["Radius"] + 2, 515
    done = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal done
        done += out["px_done_o"] or 0

    await check_cycles(dut, VideoInModel(params()["Radius"]),
                       play([good(texture(rng, width, height))], {"width_i": width, "height_i": height},
                            ready_pattern("none", rng), rng), count)
    assert done == 1


@cocotb.test()
async def latency(dut) -> None:
    """From idle, the first pixel of a line follows its last beat by 6 clocks."""
    rng = random.Random(cocotb.RANDOM_SEED)
    last_in: list[int] = []
    first_out: list[int] = []
    clock = 0

    def watch(i: Inputs, out: Outputs) -> None:
        nonlocal clock
        if i["tvalid_i"] and out["tready_o"] and i["tlast_i"]:
            last_in.append(clock)
        if out["px_valid_o"] and out["px_first_o"] and len(first_out) < HEIGHT:
            first_out.append(clock)
        clock += 1

    items = [good(texture(rng, WIDTH, HEIGHT))]
    await check_cycles(dut, VideoInModel(params()["Radius"]),
                       play(items, {"width_i": WIDTH, "height_i": HEIGHT}, ready_pattern("none", rng), rng), watch)
    assert len(last_in) == HEIGHT
    assert [b - a for a, b in zip(last_in, first_out, strict=True)] == [VideoInModel.LATENCY] * HEIGHT


def test_video_in() -> None:
    simulate("slog_video_in", __name__, {"MaxWidth": TINY.max_width, "Radius": TINY.radius})
