# SPDX-License-Identifier: Apache-2.0
"""`slog_peak` against its cycle model on every clock, and against the frame-level peak search."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.peak.peak import PeakModel
from golden.traffic.peak import PeakTask, PeakTraffic, random_task, refused_task
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate


def _model() -> PeakModel:
    p = params()
    return PeakModel(p["MaxOffsets"], p["ScoreDepth"], p["ResultDepth"])


def _mixed_tasks(rng: random.Random, count: int, widest: int) -> list[PeakTask]:
    """Jobs of all small shapes, ties, refused ones, and one of the largest width."""
    area = 1 << params()["ScoreBits"] - 1
    tasks = []
    for k in range(count):
        if rng.random() < 0.2:
            tasks.append(refused_task(rng))
        else:
            cols, rows = rng.choice(((1, 1), (2, 1), (1, 2), (2, 2), (3, 3), (1, 7), (9, 5), (12, 4), (5, 2)))
            tasks.append(random_task(rng, cols, rows, area, rng.choice((0, 2, area))))
        if k == count // 2:
            tasks.append(random_task(rng, widest, 3, area))
    return tasks


async def _run(dut, traffic: PeakTraffic) -> PeakTraffic:
    clocks = await check_cycles(dut, _model(), traffic.stimulus())
    assert clocks == traffic.clocks > 100
    traffic.check()
    return traffic


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def results_stalled(dut, shape: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    await _run(dut, PeakTraffic(_mixed_tasks(rng, 30, params()["MaxOffsets"]), rng, results=ready_pattern(shape, rng)))


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def surface_stalled(dut, shape: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED + 1)
    await _run(dut, PeakTraffic(_mixed_tasks(rng, 20, params()["MaxOffsets"]), rng, surface=ready_pattern(shape, rng),
                               results=ready_pattern("cyclic", rng)))


@cocotb.test()
@cocotb.parametrize(shape=SHAPES[1:])
async def gaps_between_scores(dut, shape: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED + 2)
    tasks = _mixed_tasks(rng, 20, params()["MaxOffsets"])
    await _run(dut, PeakTraffic(tasks, rng, scores=ready_pattern(shape, rng), latency=3))


@cocotb.test()
async def full_result_queue(dut) -> None:
    """No result is taken for a long time: the queue fills, the array stops, and nothing is lost."""
    rng = random.Random(cocotb.RANDOM_SEED + 3)
    tasks = [random_task(rng, 6, 3, 256) for _ in range(3 * params()["ResultDepth"] + 20)]
    wait = 40 * len(tasks)
    t = await _run(dut, PeakTraffic(tasks, rng, results=iter([0] * wait + [1] * 10**5)))
    assert t.waits > wait // 4


@cocotb.test()
async def equal_jobs_never_wait(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED + 4)
    for cols, rows, period in ((33, 3, 1), (9, 5, 1), (3, 4, 8)):
        tasks = [random_task(rng, cols, rows, 256, latency) for latency in (0, 256) * 5]
        t = await _run(dut, PeakTraffic(tasks, rng, period=period, latency=12))
        assert t.waits <= 8
        assert t.clocks <= 10 * rows * max(cols, period) + 12 + 2 * cols + 48


@cocotb.test()
async def reset_in_mid_work(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED + 5)
    for reset_at in (61, 148, 233):
        await _run(dut, PeakTraffic(_mixed_tasks(rng, 12, 20), rng, reset_at=reset_at,
                                    results=ready_pattern("random", rng)))


@cocotb.test()
async def large_searches(dut) -> None:
    """The widest and the highest searches, with the best at their ends and anywhere."""
    rng = random.Random(cocotb.RANDOM_SEED + 6)
    area = 1 << params()["ScoreBits"] - 1
    widest, highest = params()["MaxOffsets"], 1023
    tasks = [random_task(rng, cols, rows, area, top) for cols, rows, top in (
        (widest, 2, area), (1, highest, area), (widest - 1, 1, area), (1, 3, area), (2, 600, area),
        (widest // 2, 2, area), (widest, 1, 2), (1, 1, area))]
    await _run(dut, PeakTraffic(tasks, rng))


@pytest.mark.parametrize(("max_offsets", "score_bits", "score_depth", "result_depth", "testcase"), [
    (48, 9, 128, 4, None),
    (640, 15, 1024, 64, "results_stalled.*long|full_result_queue|large_searches"),
])
def test_peak(max_offsets: int, score_bits: int, score_depth: int, result_depth: int, testcase: str | None) -> None:
    simulate("slog_peak", __name__,
             {"MaxOffsets": max_offsets, "ScoreBits": score_bits, "ScoreDepth": score_depth,
              "ResultDepth": result_depth}, testcase=testcase)
