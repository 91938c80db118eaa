# SPDX-License-Identifier: Apache-2.0
"""Sub-pixel fits of peaks with a known position."""

from typing import Literal

import numpy as np
import pytest

from signum.measure.subpixel import line_offsets, peak_offsets


@pytest.mark.parametrize("fit", ["cone", "parabola"])
def test_fits_find_their_own_shape(fit: Literal["cone", "parabola"]) -> None:
    rng = np.random.default_rng(1)
    tips = rng.uniform(-0.5, 0.5, (200, 2))
    (a, b), c = rng.uniform(0.03, 0.12, (2, 200, 1, 1)), rng.uniform(-0.04, 0.04, (200, 1, 1))
    y, x = np.mgrid[-1:2, -1:2]
    x, y = x - tips[:, :1, None], y - tips[:, 1:, None]
    squared = (a * x + c * y) ** 2 + (b * y) ** 2
    fall = np.sqrt(squared + 0.1 * (a**2 + b**2)) if fit == "cone" else squared
    found = peak_offsets(4000 - 4096 * fall, 4096.0, fit)
    assert np.abs(found - tips).max() < (0.01 if fit == "cone" else 1e-9)
    before, best, after = np.array([[0.8, 0.9, 0.8], [0.5, 0.5, 0.5], [0.6, 0.9, 0.7]]).T
    along = line_offsets(before, best, after, np.full(3, fit == "cone")).tolist()
    assert along == pytest.approx([0, 0, 0.05 / 0.3 if fit == "cone" else 0.05 / 0.5])


def test_a_sharp_round_cone_is_found_by_the_blunt_one() -> None:
    tips = np.random.default_rng(2).uniform(-0.5, 0.5, (200, 2))
    y, x = np.mgrid[-1:2, -1:2]
    sharp = 4000 - 300 * np.hypot(x - tips[:, :1, None], y - tips[:, 1:, None])
    assert np.abs(peak_offsets(sharp, 4096.0, "cone") - tips).max() < 0.04


def test_a_patch_without_a_peak_keeps_its_integer_place() -> None:
    flat, edge = np.full((3, 3), 3000), np.tile([2000, 3000, 2000], (3, 1))
    found = peak_offsets(np.stack([flat, edge]), 4096.0, "cone")
    assert np.abs(found).max() < 1e-6
