# SPDX-License-Identifier: Apache-2.0
"""`slog_correlator` against its cycle model on every clock, and against the frame level."""

import random
from dataclasses import replace
from itertools import chain, count, repeat

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.correlate import Job
from golden.cycle.correlator.correlator import CorrelatorModel
from golden.params import TINY
from golden.traffic.correlator import CorrelatorTraffic, random_planes
from golden.traffic.jobs import mixed
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

SCORE_DEPTH = 2 * TINY.max_width
"""Two rows of the image, so that the score queue grants at once; that of the tiny board holds hardly more than one."""


def _traffic(rng: random.Random, count: int, repeats: int = 1, **ends) -> CorrelatorTraffic:
    planes = random_planes(TINY, (0, 2, 3, 5), rng.getrandbits(16), repeats)
    jobs = mixed(rng, TINY, (TINY.max_width, TINY.max_height), [s in planes for s in range(8)], count, most_offsets=150)
    return CorrelatorTraffic(TINY, planes, jobs, **ends)


@cocotb.test()
@cocotb.parametrize(shape=SHAPES, end=("all", "one"))
async def every_clock(dut, shape: str, end: str) -> None:
    """All ends stalled, and each by itself: the results are those of the frame level."""
    if shape == "none" and end != "all":
        return
    rng = random.Random(cocotb.RANDOM_SEED)
    ends: tuple[str, ...] = ("source", "results_end", "surface_end")
    if end == "one":
        ends = (ends[SHAPES.index(shape) - 1],)
    traffic = _traffic(rng, 8, repeats=rng.choice((1, 4)), **{e: ready_pattern(shape, rng) for e in ends})
    await check_cycles(dut, CorrelatorModel(TINY, params()["SurfaceDepth"]), traffic.stimulus(), None)
    traffic.check()
    assert traffic.scores > 100


@cocotb.test()
@cocotb.parametrize(reset_at=(150, 420, 777))
async def reset_in_mid_job(dut, reset_at: int) -> None:
    """After a reset in mid-job the same jobs give the right results."""
    traffic = _traffic(random.Random(cocotb.RANDOM_SEED), 10)
    traffic.reset_at = reset_at
    await check_cycles(dut, CorrelatorModel(TINY, params()["SurfaceDepth"]), traffic.stimulus(), None)
    traffic.check()
    assert traffic.scores > 100


@cocotb.test()
async def offered_at_any_time(dut) -> None:
    """Refused jobs, each after a pause that is a clock longer: they wait for every time down to none."""
    jobs = [Job(0, 5, 3, 8, 2, 2, 7, 4, 0, 2, tag) for tag in range(40)]
    offers = chain.from_iterable([*repeat(0, pause), 1] for pause in count())
    traffic = CorrelatorTraffic(TINY, random_planes(TINY, (0, 2), 1), jobs, source=offers)
    await check_cycles(dut, CorrelatorModel(TINY, params()["SurfaceDepth"]), traffic.stimulus(), None)
    traffic.check()


@cocotb.test()
async def utilisation(dut) -> None:
    """Equal searches with more offsets than steps in a pass: a score in 95 % of all clocks, the first load included."""
    planes = random_planes(TINY, (0, 1), 22)
    n = 4 * TINY.pitch + 1
    job = Job(0, 3, 1, 8, 8, 1, 5, 2, n, n)
    traffic = CorrelatorTraffic(TINY, planes, [replace(job, tag=k, tpl_x=3 + k, search_x=5 + k) for k in range(10)])
    await check_cycles(dut, CorrelatorModel(TINY, params()["SurfaceDepth"]), traffic.stimulus(), None)
    traffic.check()
    assert traffic.scores == 10 * n * n
    share = traffic.scores / (traffic.last_score + 1)
    cocotb.log.info("%.3f of %d clocks score", share, traffic.last_score + 1)
    assert share >= 0.95


def test_correlator() -> None:
    c = TINY
    simulate("slog_correlator", __name__, {
        "GroupBits": c.group_bits, "Pitch": c.pitch, "Lanes": c.lanes, "ScoreBits": c.score_bits,
        "MaxWidth": c.max_width, "MaxHeight": c.max_height, "WordsPerRow": c.words_per_row, "Slots": c.slots,
        "MinWindow": c.min_window, "MaxWindow": c.max_window, "RingRows": c.ring_rows, "SurfaceDepth": SCORE_DEPTH,
        "ResultDepth": c.result_depth})
