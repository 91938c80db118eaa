# SPDX-License-Identifier: Apache-2.0
"""Consensus of neighbourhoods: chance matches, gaps, slopes, two motions, and what is not to be overruled."""

from __future__ import annotations

import numpy as np

from signum.measure.consensus import agree_around

SHAPE = (30, 40)
Y, X = np.indices(SHAPE).astype(np.float64)
ALL, NO = np.ones(SHAPE, bool), np.zeros(SHAPE, bool)


def test_chance_matches_and_gaps_take_what_the_neighbours_have() -> None:
    rng = np.random.default_rng(1)
    dx, dy = 3 + rng.normal(0, 0.2, SHAPE), -1 + rng.normal(0, 0.2, SHAPE)
    chance = rng.random(SHAPE) < 0.4
    dx[chance], dy[chance] = rng.uniform(-9, 9, (2, int(chance.sum())))
    measured = rng.random(SHAPE) < 0.8
    dx[~measured] = np.nan
    valid, u, v = agree_around(np.nan_to_num(dx, nan=500.0), dy, measured, NO, 8)
    assert valid[6:-6, 6:-6].mean() > 0.95
    assert np.abs(u[valid] - 3).max() < 0.3 and np.abs(v[valid] + 1).max() < 0.3


def test_a_turn_and_zoom_of_the_whole_stay() -> None:
    dx, dy = 2 + 0.2 * X - 0.3 * Y, 0.3 * X + 0.2 * Y  # much more than is alike, over a neighbourhood
    valid, u, v = agree_around(dx, dy, ALL, NO, 8)
    assert valid.all() and np.abs(u - dx).max() < 0.05 and np.abs(v - dy).max() < 0.05


def test_each_of_two_large_parts_keeps_its_motion() -> None:
    right = X >= 20
    valid, u, _ = agree_around(np.where(right, 4.0, -2.0), 0 * X, ALL, ALL, 6)
    far = np.abs(X - 19.5) > 6
    assert valid[far].all() and np.abs(u - np.where(right, 4.0, -2.0))[valid].max() < 1.0


def test_something_small_is_refused_not_overruled() -> None:
    small = (np.abs(X - 20) < 3) & (np.abs(Y - 15) < 3)
    dx = np.where(small, 6.0, 1.0)
    valid, u, _ = agree_around(dx, 0 * X, ALL, ALL, 8)
    assert not valid[small].any() and valid[~small].all() and np.abs(u[valid] - 1).max() < 0.3
    assert agree_around(dx, 0 * X, ALL, NO, 8)[0].all()  # not sure of it: overruled


def test_a_cluster_in_the_corner_has_not_support_enough() -> None:
    """Windows that overlap find the same false match."""
    measured = (X < 6) & (Y < 6)
    assert not agree_around(0 * X, 0 * X, measured, NO, 8)[0].any()
    assert agree_around(0 * X, 0 * X, (X < 16) & (Y < 16), NO, 8)[0][:6, :6].all()


def test_nothing_measured_or_nothing_alike_is_not_valid() -> None:
    rng = np.random.default_rng(3)
    for measured in (NO, ALL):
        valid, u, _ = agree_around(rng.uniform(-30, 30, SHAPE), rng.uniform(-30, 30, SHAPE), measured, NO, 8)
        assert not valid.any() and u.shape == SHAPE
