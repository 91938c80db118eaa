# SPDX-License-Identifier: Apache-2.0
"""The cycle model of the correlator against the frame level, and the share of clocks with a score."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from golden.correlate import Job
from golden.cycle.correlator.correlator import CorrelatorModel
from golden.cycle.model import run_model
from golden.params import FULL, TINY
from golden.traffic.correlator import CorrelatorTraffic, random_planes
from golden.traffic.jobs import mixed


@pytest.mark.parametrize("repeats", [1, 5])
def test_against_the_frame_level(repeats: int) -> None:
    rng = random.Random(repeats)
    planes = random_planes(TINY, (0, 2, 3, 5), 21, repeats)
    jobs = mixed(rng, TINY, (48, 36), [s in planes for s in range(8)], 24, most_offsets=150)
    traffic = CorrelatorTraffic(TINY, planes, jobs)
    run_model(CorrelatorModel(TINY), traffic.stimulus())
    traffic.check()
    assert traffic.scores > 500 and len(traffic.stream) > 50


def test_full_size_utilisation() -> None:
    """Searches of +-32 with a 64x64 window: a score in 95 % of all clocks from the first job to the last score, the
    first load included, and in 99 % from the first score on."""
    planes = random_planes(FULL, (0, 1), 22)
    job = Job(0, 100, 120, 64, 64, 1, 70, 85, 65, 65)
    jobs = [replace(job, tag=k, tpl_x=100 + 37 * k, search_x=70 + 37 * k) for k in range(3)]
    traffic = CorrelatorTraffic(FULL, planes, jobs)
    run_model(CorrelatorModel(FULL), traffic.stimulus())
    traffic.check()
    assert traffic.scores == 3 * 65 * 65
    assert traffic.first_score is not None
    share = traffic.scores / (traffic.last_score + 1)
    print(f"{share:.3f} of {traffic.last_score + 1} clocks score; "
          f"{traffic.scores / (traffic.last_score + 1 - traffic.first_score):.4f} once begun")
    assert share >= 0.95
    # After the first score hardly a clock is lost between jobs: a row now and then.
    assert traffic.scores / (traffic.last_score + 1 - traffic.first_score) >= 0.99
