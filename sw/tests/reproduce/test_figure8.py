# SPDX-License-Identifier: Apache-2.0
"""Figure 8 on the golden board; the Verilated board computes the same bits (test_boards_identical.py)."""

import cv2
import numpy as np
import pytest
import skimage.data
from scipy import ndimage

from signum.boards.golden import GoldenBoard
from signum.reproduce import figure8
from signum.world.degrade import SNOW, degrade


def test_table_meets_the_paper() -> None:
    with GoldenBoard() as board:
        rows = [row for name, picture in figure8.photographs() for row in figure8.measure(board, name, picture)]
    print("\n" + figure8.as_text(rows))
    assert {r.picture for r in rows} >= set(figure8.PHOTOGRAPHS)
    assert {r.sigma for r in rows} == set(figure8.SIGMAS)
    at = {(r.picture, r.sigma): r for r in rows}
    for name in ("gravel", "grass"):
        assert at[name, 1.5].whole > 0.90 and at[name, 1.5].inner > 0.95
    assert all(0.5 < r.whole < 1 and 0.5 < r.inner < 1 for r in rows)


@pytest.mark.parametrize("name", ["gravel", "grass"])
def test_other_snow(name: str) -> None:
    """The mean over many falls of snow: a single one varies by half a per cent with the flakes in the inner quarter."""
    picture = np.asarray(cv2.resize(getattr(skimage.data, name)(), figure8.SIZE), np.uint8)
    with GoldenBoard() as board:
        rows = [figure8.measure(board, name, picture, [1.5], seed)[0] for seed in range(16)]
    inner = [r.inner for r in rows]
    print(f"{name}: inner quarter {np.mean(inner):.4f} on average of {len(rows)}, {min(inner):.4f} to {max(inner):.4f}")
    assert min(r.whole for r in rows) > 0.90 and np.mean(inner) > 0.95 and min(inner) > 0.94


def test_as_a_float_filter_sees_it() -> None:
    """The board's integers lose nothing against a float64 LoG."""
    picture = np.asarray(cv2.resize(skimage.data.gravel(), figure8.SIZE), np.uint8)
    with GoldenBoard() as board:
        (row,) = figure8.measure(board, "gravel", picture, [1.5])
    planes = [(ndimage.gaussian_laplace(p.astype(np.float64), 1.5, mode="nearest") > 0).astype(np.uint8)
              for p in (picture, degrade(picture))]
    assert (row.whole, row.inner) == pytest.approx(figure8.agreement(planes[0], planes[1]), abs=0.003)


def test_degradation() -> None:
    flat = np.full((480, 640), 200, np.uint8)
    out = degrade(flat, seed=4)
    assert np.array_equal(out, degrade(flat, seed=4)) and not np.array_equal(out, degrade(flat, seed=5))
    snow = out == 255
    assert 0.9 * 9 * SNOW < snow.sum() <= 9 * SNOW
    assert np.all(out[230:250, 310:330][~snow[230:250, 310:330]] == 146)  # 200 / 4 + 96, in full light
    corners = out[[0, 0, -1, -1], [0, -1, 0, -1]]
    assert set(corners) <= {44, 255}  # 30 % of it in the corners


def test_agreement_counts_the_middle() -> None:
    plane = np.zeros((40, 80), np.uint8)
    other = plane.copy()
    other[10:30, 20:60] = 1
    assert figure8.agreement(plane, other) == (0.75, 0.0)
