# SPDX-License-Identifier: Apache-2.0
"""Evidence that windows agree for another reason than chance, and the motions of a view of two depths."""

import numpy as np
import pytest

from signum.common.arrays import Floats
from signum.measure.agree import Found, motions
from signum.measure.likelihood import MOST_DOUBT, VALID_BY_CHANCE, chance, covered, doubt, evidence, nearby

WINDOW, REACH = 64, 18
CLEAR = np.full(100, 12.0)
PERFECT = 23.0
"""Standard deviations by which peaks exceed chance that nobody doubts, and perfect ones of such windows, sigma 2.5."""


def _grid(across: int, down: int) -> Floats:
    x, y = np.meshgrid(np.arange(across) * 32.0 + 32, np.arange(down) * 32.0 + 32)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def test_overlapping_windows_count_as_the_area_that_they_cover() -> None:
    assert covered(np.zeros((0, 2)), 64) == 0
    assert covered(np.array([[32.0, 32.0]] * 5), 64) == 1
    assert covered(np.array([[32.0, 32.0], [64.0, 32.0]]), 64) == 1.5
    assert covered(np.array([[32.0, 32.0], [320.0, 300.0]]), 64) == 2


def test_chance_does_not_pass_and_many_windows_do() -> None:
    """Windows that are right by chance, at the rate of strangers, in 60 trials."""
    rng, tried = np.random.default_rng(11), _grid(8, 5)
    passed = 0
    for _ in range(60):
        valid = np.flatnonzero(rng.random(len(tried)) < VALID_BY_CHANCE)
        if len(valid) < 2:
            continue
        q = tried[valid] + rng.uniform(-REACH, REACH, (len(valid), 2))
        found = Found(tried[valid], q, tried[valid], CLEAR[:len(q)], PERFECT, tried, WINDOW, REACH, 1.0)
        best = motions(found, 15.0, 1.2, 3.0)[0]
        passed += best.evidence >= 3 and best.agree.sum() >= 4
    assert passed == 0
    p = chance(3.2, REACH)
    proof = [evidence(tried[:k], tried, WINDOW, p) for k in (2, 5, 10, 20, 40)]
    assert proof[1] < 3 < proof[2] and all(np.diff(proof) > 0)
    assert proof[0] == evidence(tried[:0], tried, WINDOW, p) < 0, "two windows always agree"


def test_peaks_as_low_as_those_of_strangers_take_evidence() -> None:
    at = _grid(4, 2)
    assert doubt(at[:0], WINDOW, CLEAR[:0], PERFECT) == doubt(at, WINDOW, CLEAR[:8], PERFECT) == 0
    some, most = (doubt(at, WINDOW, np.full(8, height), PERFECT) for height in (5.0, 2.0))
    assert doubt(at, WINDOW, np.full(8, 2.0), 9.0) == 0, "small windows, whose right peaks are as low"
    assert 0 < some < most == pytest.approx(MOST_DOUBT * covered(at, WINDOW))
    q, height = at + np.array([3.0, -2.0]), np.full(8, 4.8)
    sure, low = (motions(Found(at, q, at, above, PERFECT, at, WINDOW, REACH, 1.0), 15.0, 1.2, 3.0)[0]
                 for above in (CLEAR[:8], height))
    assert sure.evidence - low.evidence == pytest.approx(doubt(at, WINDOW, height, PERFECT))


@pytest.mark.parametrize("seed", [31, 32, 33])
def test_windows_nearby_count_against_a_motion_that_few_of_them_share(seed: int) -> None:
    """By their number: a third of them, scattered, cover most of the area."""
    at = _grid(20, 12)
    order = np.random.default_rng(seed).permutation(len(at))
    few, some, many = (at[order[:round(share * len(at))]] for share in (0.35, 0.45, 0.7))
    assert covered(few, WINDOW) > 0.6 * covered(at, WINDOW)
    assert nearby(at[:0], at, WINDOW) < nearby(few, at, WINDOW) < nearby(some, at, WINDOW) < 0
    assert 0 < nearby(many, at, WINDOW) < nearby(at, at, WINDOW)
    assert nearby(at[:0], at[:0], WINDOW) == 0


@pytest.mark.parametrize("seed", [21, 22, 23])
def test_both_depths_of_a_view_are_returned(seed: int) -> None:
    """Floor and a table that moves twice as much: two motions, the floor's first, and no third."""
    rng, at = np.random.default_rng(seed), _grid(12, 8)
    high = (at[:, 0] > 250) & (at[:, 1] > 150)
    q = at + np.where(high[:, None], (0.0, 40.0), (0.0, 20.0)) + rng.normal(0, 0.5, at.shape)
    stray = rng.random(len(at)) < 0.1
    q[stray] = at[stray] + rng.uniform(-50, 50, (int(stray.sum()), 2))
    found = motions(Found(at, q, at, CLEAR[:len(q)], PERFECT, at, WINDOW, 50, 1.0), 15.0, 1.2, 3.0)
    shifts = [m.similarity(np.array([200.0, 140.0]))[1] - 140 for m in found]
    assert len(found) == 2 and shifts == pytest.approx([20, 40], abs=1.5)
