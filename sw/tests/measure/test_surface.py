# SPDX-License-Identifier: Apache-2.0
"""The fit to the surface that most of an overlap shows: one depth of several, and a slope only where there is one."""

import numpy as np
import pytest

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity
from signum.measure.refine import refine
from signum.measure.surface import densest, settle

SIZE = 400, 270
MIDDLE = (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2
TRUE = Similarity.of(3.0, 0.98, (60.0, 90.0))


def _grid() -> Floats:
    """Centres of 20 by 14 windows, pixels."""
    x, y = np.meshgrid(np.linspace(20, 380, 20), np.linspace(15, 255, 14))
    return np.stack([x.ravel(), y.ravel()], axis=1)


def _seen(p: Floats, high: Floats, seed: int) -> Floats:
    """Where windows are found that relief displaces along the baseline, by `high` pixels, with errors of 0.4 pixels."""
    moved = TRUE(np.array(MIDDLE)) - MIDDLE
    noise = np.random.default_rng(seed).normal(0, 0.4, p.shape)
    return np.asarray(TRUE(p) + high[:, None] * moved / np.hypot(*moved) + noise)


FLOOR_X = 170
"""Where the floor ends."""


def _steps(p: Floats, seed: int) -> Floats:
    """Displacements by a floor and by a hollow and two ridges beside it, which take more of the view than the floor."""
    rng = np.random.default_rng(seed)
    high = np.array([0.0, *(rng.permutation([-5.0, 5.0, 9.0]) + rng.uniform(-1, 1, 3))])
    return np.asarray(high[np.digitize(p[:, 0], [FLOOR_X, 245, 320])])


@pytest.mark.parametrize("seed", range(6))
def test_of_several_depths_that_of_most_windows(seed: int) -> None:
    """Two fifths of the view are a floor: its motion is found to a quarter of a pixel, from a start between the depths.
    The fit that goes on from there with a slope stops between them."""
    p = _grid()
    q = _seen(p, _steps(p, seed), seed)
    about = Similarity(TRUE.factor, TRUE.shift + complex(*(q - TRUE(p)).mean(axis=0)))
    found, sloping = settle(p, q, about, 1.0, SIZE)
    floor = p[:, 0] < FLOOR_X
    off = np.linalg.norm(found.similarity(p[floor]) - TRUE(p[floor]), axis=1)
    assert not sloping and off.max() < 0.5 and off.mean() < 0.25
    assert found.agree[floor].mean() > 0.9
    between = np.linalg.norm(refine(p, q, about, 1.0, SIZE).similarity(p[floor]) - TRUE(p[floor]), axis=1)
    assert between.mean() > 1.0


@pytest.mark.parametrize("seed", range(6))
def test_a_floor_that_slopes_turns_no_pair(seed: int) -> None:
    """A rough floor that slopes by 8 degrees: the slope is taken out, and rotation and scale are the cameras'."""
    p, rng = _grid(), np.random.default_rng(100 + seed)
    slope = 0.05 * np.exp(2j * np.pi * seed / 6)
    high = (np.conj(slope) * ((p - MIDDLE) @ np.array([1, 1j]))).real + rng.normal(0, 0.5, len(p))
    found, sloping = settle(p, _seen(p, high, seed), TRUE, 1.0, SIZE)
    assert sloping and abs(found.similarity.factor / TRUE.factor - 1) < 0.003


def test_the_same_in_every_run() -> None:
    """The pairs of windows that are tried are the same each time, so that a survey can be repeated bit for bit."""
    p = _grid()
    q = _seen(p, _steps(p, 7), 7)
    first, again = (densest(p, q, TRUE, 1.75) for _ in range(2))
    assert first == again


def test_two_windows_determine_a_motion() -> None:
    """As many as a similarity needs."""
    p = np.array([[100.0, 100.0], [300.0, 150.0]])
    assert np.abs(densest(p, TRUE(p), Similarity.of(1.0), 1.75)(p) - TRUE(p)).max() < 1e-6
