# SPDX-License-Identifier: Apache-2.0
"""`slog_frontend` against its cycle model on every clock."""

import itertools
import random

import cocotb
import numpy as np

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.frontend.fir import adder_levels
from golden.cycle.frontend.frontend import FrontendModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.log import Coefs, binarise, kernels
from golden.params import TINY
from golden.traffic.stalls import SHAPES, ready_pattern
from golden.traffic.video import BAD_KINDS, Item, VideoRecord, bad, good, play, settings_of, stray, texture
from sim.testbench.runner import simulate


def _kernels(sigma: float) -> tuple[Coefs, Coefs]:
    return kernels(sigma, params()["Radius"])


def _settings(width: int, height: int, sigma: float) -> Inputs:
    return settings_of(width, height, *_kernels(sigma))


def _model() -> FrontendModel:
    p = params()
    return FrontendModel(p["MaxWidth"], p["Radius"], p["GroupBits"])


def _video(rng: random.Random, items: list[Item], common: Inputs, source: str, gap: int = 0) -> Stimulus:
    """`items` played, the settings one clock before them."""
    yield common
    yield from play(items, common, ready_pattern(source, rng), rng, gap=gap)


@cocotb.test()
@cocotb.parametrize(size=((18, 18), (18, 36), (48, 18), (41, 23)))
async def sizes(dut, size: tuple[int, int]) -> None:
    """Frames without any blanking are never stalled and give the right planes, the first word after the latency."""
    p = params()
    rng = random.Random(cocotb.RANDOM_SEED)
    sigma = rng.choice((1.0, 3.3))
    items = [good(texture(rng, *size)) for _ in range(3)]
    seen = VideoRecord(p["GroupBits"], size[0])
    sent: list[int] = []

    def watch(i: Inputs, out: Outputs) -> None:
        if i["tvalid_i"] and out["tready_o"] and i["tlast_i"]:
            sent.append(seen.clock)
        seen.observe(i, out)

    await check_cycles(dut, _model(), _video(rng, items, _settings(*size, sigma), "none"), watch)
    seen.check(items, *_kernels(sigma))
    assert seen.stalled == 0
    latency = 38 + p["Radius"] + 2 * adder_levels(p["Radius"]) + p["GroupBits"]
    rows = [sent[frame * size[1] + p["Radius"]] for frame in range(3)]
    assert [b - a for a, b in zip(rows, seen.first_word, strict=True)] == [latency] * 3


@cocotb.test()
@cocotb.parametrize(source=SHAPES)
async def bad_frames(dut, source: str) -> None:
    """Every kind of bad frame between good ones, directly after them or after a pause."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width, height, sigma = 23, 18, 1.7
    gap = 0 if source in ("none", "random") else 200
    items = [stray(rng, 5)]
    for kind in rng.sample(BAD_KINDS, len(BAD_KINDS)):
        items += [good(texture(rng, width, height)), bad(kind, texture(rng, width, height), rng)]
    items += [good(texture(rng, width, height)), stray(rng, 40), good(texture(rng, width, height))]
    seen = VideoRecord(params()["GroupBits"], width)
    await check_cycles(dut, _model(), _video(rng, items, _settings(width, height, sigma), source, gap), seen.observe)
    seen.check(items, *_kernels(sigma))


@cocotb.test()
async def dropped_within_an_output_row(dut) -> None:
    """The words of a row whose frame is dropped while the row is issued: the border stays where it was."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width, height, radius = 23, 18, params()["Radius"]
    common = _settings(width, height, 1.7)
    words = 0

    def stimulus() -> Stimulus:
        yield common
        for row, column in itertools.product((1, 3, radius - 1), range(13, 21)):
            image = np.random.default_rng(rng.getrandbits(32)).integers(0, 256, (height, 1), np.uint8).repeat(width, 1)
            # The line is issued while the next one arrives, whose start of frame drops the frame.
            for data, user, last in good(image).beats[:width * (radius + row + 1) + column]:
                yield {**common, "tvalid_i": 1, "tdata_i": data, "tuser_i": user, "tlast_i": last}
            yield {**common, "tvalid_i": 1, "tuser_i": 1, "tlast_i": 1}
            for _ in range(120):
                yield common

    def watch(_: Inputs, out: Outputs) -> None:
        nonlocal words
        words += out["word_valid_o"] or 0

    await check_cycles(dut, _model(), stimulus(), watch)
    assert words > 100


@cocotb.test()
async def settings_change_in_hold(dut) -> None:
    """Size and coefficients change between frames while hold keeps the next frame out, which waits 1 to 21 clocks."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width = 20
    runs = [(width, 18, 1.0), (width, 30, 2.0), (width, 18, 4.0), (width, 20, 1.5)]
    waits = 20, 0, 5  # clocks, and one more from the end of the hold
    items = [[good(texture(rng, w, h)) for _ in range(2)] for w, h, _ in runs]
    seen = VideoRecord(params()["GroupBits"], width)

    def stimulus() -> Stimulus:
        yield _settings(*runs[0])
        for run, batch in enumerate(items):
            now = _settings(*runs[run])
            yield from play(batch, now, ready_pattern("cyclic", rng), rng)
            if run == len(waits):
                return
            data, user, last = items[run + 1][0].beats[0]
            yield {**now, "hold_i": 1}
            for n in range(20):
                common = now if n < 18 else _settings(*runs[run + 1])
                out = yield {**common, "hold_i": 1, "tvalid_i": int(n >= 20 - waits[run]), "tdata_i": data,
                             "tuser_i": user, "tlast_i": last}
                assert not out["tready_o"]

    await check_cycles(dut, _model(), stimulus(), seen.observe)
    planes = [binarise(i.good, *_kernels(s)) for batch, (_, _, s) in zip(items, runs, strict=True)
              for i in batch if i.good is not None]
    assert len(seen.planes) == len(planes) == 8
    for got, want in zip(seen.planes, planes, strict=True):
        np.testing.assert_array_equal(got, want)


@cocotb.test()
async def reset_in_mid_frame(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    width, height, sigma = 18, 19, 2.0
    common = _settings(width, height, sigma)
    last = [good(texture(rng, width, height)) for _ in range(2)]
    seen = VideoRecord(params()["GroupBits"], width)

    def stimulus() -> Stimulus:
        yield common
        for _ in range(8):
            run = play([good(texture(rng, width, height)) for _ in range(2)], common, ready_pattern("none", rng), rng)
            i = next(run)
            for _ in range(rng.randint(1, 2 * width * height)):
                i = run.send((yield i))
            yield {**common, "rst_i": 1, "tvalid_i": 1}
        seen.planes.clear()
        seen.accepted = seen.drops = seen.starts = seen.aborts = 0
        yield from play(last, common, ready_pattern("none", rng), rng)

    await check_cycles(dut, _model(), stimulus(), seen.observe)
    seen.check(last, *_kernels(sigma))


@cocotb.test()
@cocotb.parametrize(how=("abort", "cut"))
async def dropped_after_a_pause(dut, how: str) -> None:
    """A frame is dropped after all pixels of its begun output have left: the unit is busy until the abort is out."""
    rng = random.Random(cocotb.RANDOM_SEED)
    width, height, radius = 18, 20, params()["Radius"]
    common = _settings(width, height, 1.5)
    aborts = gaps = 0

    def stimulus() -> Stimulus:
        nonlocal aborts, gaps
        yield common
        for more in range(6):
            for data, user, last in good(texture(rng, width, height)).beats[:width * (radius + 2 + more % 2) + more]:
                yield {**common, "tvalid_i": 1, "tdata_i": data, "tuser_i": user, "tlast_i": last}
            for _ in range(150):
                yield common
            yield {**common, "abort_i": 1} if how == "abort" else {**common, "tvalid_i": 1, "tlast_i": 1}
            was = aborts
            for _ in range(80):
                out = yield common
                aborts += out["frame_abort_o"] or 0
                gaps += aborts == was and not out["busy_o"]

    await check_cycles(dut, _model(), stimulus())
    assert aborts == 6 and not gaps


def test_frontend() -> None:
    simulate("slog_frontend", __name__,
             {"MaxWidth": TINY.max_width, "Radius": TINY.radius, "GroupBits": TINY.group_bits})
