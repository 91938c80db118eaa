# SPDX-License-Identifier: Apache-2.0
"""Disparities of all pixels: a sample of `make dense-bars`, strangers, stripes, ranges longer than the engine."""

from __future__ import annotations

import numpy as np
import pytest

from golden.params import DENSE, FULL
from signum.boards.board import BoardError
from signum.boards.golden import GoldenBoard
from signum.measure.dense_stereo import measure_dense_range
from signum.measure.measurer import Measurer
from tests.dense_bars import motorcycle, murky_pair, stereo_figures
from tests.measure.relief import relief_pair


def test_motorcycle() -> None:
    pair, truth = motorcycle()
    valid, beyond_1, beyond_2 = stereo_figures(pair, truth)
    print(f"clean: {valid:.1%} valid, {beyond_1:.1%} beyond 1 px, {beyond_2:.1%} beyond 2 px")
    assert valid >= 0.7 and beyond_1 <= 0.08 and beyond_2 <= 0.06
    valid, beyond_1, beyond_2 = stereo_figures(murky_pair(pair, 11), truth, 160)  # in two passes, and two back
    print(f"figure 8: {valid:.1%} valid, {beyond_1:.1%} beyond 1 px, {beyond_2:.1%} beyond 2 px")
    assert valid >= 0.6 and beyond_1 <= 0.1


def test_a_floor_with_boulders() -> None:
    valid, beyond_1, _ = stereo_figures(*relief_pair(702))
    assert valid >= 0.8 and beyond_1 <= 0.01


def test_pairs_that_have_nothing_in_common() -> None:
    (left, _), _ = relief_pair(702)
    (_, right), _ = relief_pair(704)
    measurer = Measurer(GoldenBoard(DENSE), (left.shape[1], left.shape[0]), 1.0)
    found = measure_dense_range(measurer, *measurer.pair(left, right), (4, 64))
    print(f"strangers: {found.valid.mean():.1%} valid")
    assert found.valid.mean() <= 0.04


def test_step_reasons_and_stripes() -> None:
    """Stripes along the rows have no texture along them; a map of every fourth pixel is the map of all, thinned out."""
    rng = np.random.default_rng(1)
    scene = rng.integers(0, 256, (96, 140), dtype=np.uint8)
    left, right = scene[:, 10:130].copy(), scene[:, 16:136].copy()  # disparity 6
    left[:40] = right[:40] = np.repeat(rng.integers(0, 256, (10, 1), dtype=np.uint8), 4, 0)
    measurer = Measurer(GoldenBoard(DENSE), (120, 96), 1.0)
    views = measurer.pair(left, right)
    whole, thin = (measure_dense_range(measurer, *views, (0, 15), step=step) for step in (1, 4))
    assert not whole.valid[:30].any() and whole.valid[56:80, 40:100].mean() > 0.95
    assert np.nanmedian(whole.disparity) == pytest.approx(6, abs=0.1)
    assert np.array_equal(thin.disparity, whole.disparity[::4, ::4], equal_nan=True)
    assert np.array_equal(thin.x, np.arange(0, 120, 4)) and np.array_equal(thin.y, np.arange(0, 96, 4))
    for found in (whole, thin):
        assert sum(found.refused.values()) == (~found.valid).sum()


def test_what_cannot_be_measured_is_said() -> None:
    picture = np.random.default_rng(1).integers(0, 256, (96, 120), dtype=np.uint8)
    for config, disparities, window, error, message in (
            (FULL, (0, 9), 16, BoardError, "no dense engine"), (DENSE, (0, 9), 64, ValueError, "window is 64"),
            (DENSE, (3, 4), 16, ValueError, "at least three"),
            (DENSE, (0, 512), 16, ValueError, "must lie in -511..511"),
            (DENSE, (-512, 9), 16, ValueError, "must lie in -511..511")):
        measurer = Measurer(GoldenBoard(config), (120, 96), 1.0)
        with pytest.raises(error, match=message):
            measure_dense_range(measurer, *measurer.pair(picture, picture), disparities, window)
    measurer = Measurer(GoldenBoard(DENSE), (120, 96), 1.0)
    with pytest.raises(ValueError, match="step is 0: must be 1 or more"):
        measure_dense_range(measurer, *measurer.pair(picture, picture), (0, 9), step=0)
