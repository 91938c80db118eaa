# SPDX-License-Identifier: Apache-2.0
"""Similarities, the vote and the robust fit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from signum.geometry.similarity import IDENTITY, Similarity, fit, vote

similarities = st.builds(Similarity.of, st.floats(-14, 14), st.floats(0.88, 1.15),
                         st.tuples(st.floats(-300, 300), st.floats(-300, 300)))


@given(similarities, similarities)
def test_composition_inverse_and_matrix(a: Similarity, b: Similarity) -> None:
    points = np.array([[0.0, 0.0], [100.0, 0.0], [30.0, -70.0]])
    assert np.allclose((a @ b)(points), a(b(points)))
    assert np.allclose((a.inverse @ a)(points), points)
    assert np.allclose(a(points), points @ a.matrix[:, :2].T + a.matrix[:, 2])


def test_rotation_is_clockwise_on_the_screen() -> None:
    assert np.allclose(Similarity.of(rot_deg=90)(np.array([1.0, 0.0])), [0.0, 1.0])


@given(similarities, st.integers(0, 2**32 - 1))
def test_vote_finds_the_truth_among_mostly_wrong_pairs(truth: Similarity, seed: int) -> None:
    rng = np.random.default_rng(seed)
    p = np.array([[x, y] for y in range(0, 300, 50) for x in range(0, 400, 60)], float)
    q = truth(p) + rng.uniform(-1, 1, p.shape)
    wrong = rng.permutation(len(p))[: len(p) * 6 // 10]
    q[wrong] = rng.uniform(-400, 800, (len(wrong), 2))
    found, agree = vote(p, q, 6.0, 15.0, 1.2, 50.0)
    result = fit(p, q, found, 6.0)
    assert agree.sum() >= len(p) - len(wrong)
    assert result.turning and np.abs(result.similarity(p) - truth(p)).max() < 3.0


def test_rotation_is_not_made_of_too_little() -> None:
    """Windows next to each other do not separate a rotation from noise: only the shift is fitted."""
    rng = np.random.default_rng(2)
    p = rng.uniform(-12, 12, (6, 2))
    q = p + np.array([40.0, 5.0]) + rng.normal(0, 1.0, p.shape)
    result = fit(p, q, Similarity.of(shift=(40.0, 5.0)), 6.0)
    assert not result.turning and result.similarity.rot_deg == 0 and result.similarity.scale == 1
    assert np.allclose(result.similarity(np.zeros(2)), [40, 5], atol=1.5)


@pytest.mark.parametrize("n", [1, 2])
def test_few_points(n: int) -> None:
    p = np.array([[0.0, 0.0], [100.0, 50.0]])[:n]
    result = fit(p, p + 3.0, vote(p, p + 3.0, 2.0, 15.0, 1.2, 20.0)[0], 2.0)
    assert np.allclose(result.similarity(p), p + 3.0, atol=1e-9) and result.agree.sum() == n


def test_nothing_agrees_leaves_the_start() -> None:
    p = np.array([[0.0, 0.0], [100.0, 50.0], [20.0, 80.0]])
    result = fit(p, p + np.array([[50, 0], [0, 90], [-70, 20]]), IDENTITY, 2.0)
    assert not result.agree.any() and np.isfinite(result.similarity.shift)
