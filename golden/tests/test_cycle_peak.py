# SPDX-License-Identifier: Apache-2.0
"""The peak unit's cycle model against the frame-level peak search; its rate; its queues when full."""

import random
from collections.abc import Callable
from itertools import repeat

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.cycle.model import Inputs, Outputs, run_model
from golden.cycle.peak.peak import PeakModel
from golden.traffic.peak import PeakTask, PeakTraffic, random_task, refused_task
from golden.traffic.stalls import coin

MAX_OFFSETS, SCORE_DEPTH, RESULT_DEPTH, AREA = 48, 128, 4, 256


def _drive(traffic: PeakTraffic, model: PeakModel | None = None,
           observe: Callable[[Inputs, Outputs], None] | None = None) -> PeakTraffic:
    """Run `traffic` against a model and check all results."""
    model = model or PeakModel(MAX_OFFSETS, SCORE_DEPTH, RESULT_DEPTH)
    model.step(dict.fromkeys(PeakModel.INPUTS, 0) | {"rst_i": 1})
    run_model(model, traffic.stimulus(), observe)
    traffic.check()
    return traffic


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 12), st.integers(1, 12), st.sampled_from([0, 1, 5, 256]),
       st.sampled_from([0.5, 1.0]), st.sampled_from([0.1, 0.5, 1.0]), st.sampled_from([0.2, 1.0]))
def test_any_jobs_any_stalls(seed: int, cols: int, rows: int, top: int, scores: float, results: float,
                             surface: float) -> None:
    """Every result and every surface is the frame-level model's, in job order."""
    rng = random.Random(seed)
    tasks = [refused_task(rng) if rng.random() < 0.2 else
             random_task(rng, rng.randint(1, cols), rng.randint(1, rows), AREA, top) for _ in range(12)]
    _drive(PeakTraffic(tasks, rng, scores=coin(scores, rng), results=coin(results, rng), surface=coin(surface, rng)))


@pytest.mark.parametrize(("cols", "rows", "period"), [
    (48, 1, 1), (48, 3, 1), (33, 5, 8), (17, 17, 1), (9, 4, 1), (5, 9, 8), (4, 2, 8), (1, 6, 8), (1, 1, 16)])
def test_equal_jobs_never_wait(cols: int, rows: int, period: int) -> None:
    """Back-to-back jobs of equal size run at the array's own rate, refused ones between."""
    rng = random.Random(1)
    # The room for a row of MaxOffsets is reserved; as on the full board the latency is well within the rest.
    tasks = [random_task(rng, cols, rows, AREA) for _ in range(24)]
    t = _drive(PeakTraffic(tasks, rng, period=period), PeakModel(MAX_OFFSETS, 2 * SCORE_DEPTH, 64))
    steps = 24 * rows * max(cols, period)
    # Only the first row waits, for its context and grant; the search of the last row follows.
    assert t.waits <= 8, f"{t.waits} clocks without a grant"
    assert t.clocks <= steps + t.latency + 2 * cols + 48


def test_unequal_jobs_wait_and_lose_nothing() -> None:
    """Wide jobs of few rows before narrow ones: the search falls behind, so grants must stop."""
    rng = random.Random(2)
    tasks = [random_task(rng, *((48, 2), (3, 4), (48, 1), (1, 1), (2, 9))[k % 5], AREA) for k in range(40)]
    t = _drive(PeakTraffic(tasks, rng, latency=5))
    assert t.waits > 0


def test_full_result_queue_stops_everything() -> None:
    """While no result is taken, the queue is full and stays so; then all the others follow."""
    rng = random.Random(3)
    tasks = [random_task(rng, 6, 3, AREA) for _ in range(40)]
    model = PeakModel(MAX_OFFSETS, SCORE_DEPTH, RESULT_DEPTH)
    levels: list[int] = []
    t = _drive(PeakTraffic(tasks, rng, results=iter([0] * 3000 + [1] * 10**5)), model,
               lambda _, out: levels.append(out["res_level_o"]))
    assert set(levels[1000:3000]) == {RESULT_DEPTH}
    assert t.waits > 1500


def test_stopped_surface_stops_everything() -> None:
    rng = random.Random(4)
    tasks = [PeakTask(random_task(rng, 8, 4, AREA).scores, AREA, surface=k % 2 == 0, tag=k) for k in range(20)]
    t = _drive(PeakTraffic(tasks, rng, surface=iter([0] * 2000 + [1] * 10**5)))
    assert t.clocks > 2000 and t.waits > 1000


def test_reset_in_mid_work() -> None:
    rng = random.Random(5)
    tasks = [random_task(rng, 7, 5, AREA) for _ in range(12)]
    for reset_at in range(150, 190, 7):
        _drive(PeakTraffic(tasks, rng, reset_at=reset_at))


def test_traffic_notices_a_wrong_answer() -> None:
    """A model whose neighbours are swapped fails."""
    rng = random.Random(6)
    model = PeakModel(MAX_OFFSETS, SCORE_DEPTH, RESULT_DEPTH)
    model.collect.COLUMNS = (("near_west_i", (2, 4, 7)), ("near_centre_i", (1, None, 6)),
                             ("near_east_i", (0, 3, 5)))
    with pytest.raises(AssertionError, match="job"):
        _drive(PeakTraffic([random_task(rng, 7, 5, AREA) for _ in range(5)], rng, results=repeat(1)), model)


def test_ties_take_the_first() -> None:
    flat = PeakTask(np.full((4, 5), 9, dtype=np.int32), 16)
    assert _drive(PeakTraffic([flat] * 3, random.Random(7))).packed_results == [flat.result()] * 3
