# SPDX-License-Identifier: Apache-2.0
"""Flow of windows all over the picture: a sample of `make dense-bars`, turn and zoom, something small, strangers."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from golden.params import DENSE
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.flow import FlowField
from signum.measure.measurer import Measurer
from tests.dense_bars import flow_figures, moved_pair, murky_pair, picture

SIZE = (288, 224)


def _field(before: Image, after: Image, reach: int = 10) -> FlowField:
    measurer = Measurer(GoldenBoard(DENSE), (before.shape[1], before.shape[0]), 1.5)
    return measure_dense_flow(measurer, *measurer.pair(before, after), step=8, reach=(reach, reach))


@pytest.mark.parametrize(("name", "moved"), [("coffee", (5.42, 1.48)), ("coins", (-8.4, 6.3))])
def test_photographs(name: str, moved: tuple[float, float]) -> None:
    pair = moved_pair(picture(name), *moved)
    for both, bar in ((pair, 0.1), (murky_pair(pair, 3), 0.2)):
        valid, rms, worst = flow_figures(both, moved)
        print(f"{name}: {valid:.1%} valid, RMS {rms:.3f} px, at most {worst:.2f} px")
        assert valid >= 0.85 and rms <= bar and worst <= 1


def test_a_turn_with_a_zoom() -> None:
    photo = picture("gravel")[:224, :288].copy()
    matrix = cv2.getRotationMatrix2D((144, 112), 2.0, 1.03)
    field = _field(photo, np.asarray(cv2.warpAffine(photo, matrix, SIZE, flags=cv2.INTER_CUBIC), np.uint8))
    x, y = np.meshgrid(field.x, field.y)
    there = np.tensordot(matrix, np.stack([x, y, np.ones_like(x)]), 1)
    off = np.hypot(field.dx - (there[0] - x), field.dy - (there[1] - y))[field.valid]
    print(f"{field.valid.mean():.1%} valid, at most {off.max():.2f} px off")
    assert field.valid.mean() >= 0.9 and off.max() <= 0.3


def test_something_small_that_moves_by_itself_does_not_count_as_ground() -> None:
    before = picture("gravel")[:224, :288].copy()
    after = np.roll(before, (1, 2), (0, 1))
    thing = picture("coffee")[100:148, 200:248]
    before[80:128, 100:148], after[77:125, 106:154] = thing, thing
    field = _field(before, after)
    inside = ((field.y > 90) & (field.y < 118))[:, None] & (field.x > 110) & (field.x < 138)
    away = ((field.y < 50) | (field.y > 160))[:, None] & np.ones(field.x.shape, bool)
    assert inside.any() and not (field.valid & inside & (np.abs(field.dx - 2) < 1)).any()
    assert field.valid[away].mean() > 0.9 and field.dominant() == pytest.approx((2, 1), abs=0.05)


def test_centres_strangers_and_reasons() -> None:
    gravel, grass = (picture(n)[:120, :160].copy() for n in ("gravel", "grass"))
    field = _field(gravel, grass, 6)
    assert (field.x[0], field.y[0]) == (17, 17) and field.x[1] - field.x[0] == 8 and field.x[-1] <= 160 - 15
    assert not field.valid.any() and field.dominant() == (0.0, 0.0)
    assert sum(field.refused.values()) == field.valid.size
    same = _field(gravel, gravel, 6)
    assert same.valid.all() and np.abs(same.dx).max() < 0.02 and not same.refused


def test_a_window_larger_than_the_picture_and_a_negative_reach_are_refused() -> None:
    measurer = Measurer(GoldenBoard(DENSE), (40, 34), 1.5)
    views = measurer.pair(*(np.zeros((34, 40), np.uint8),) * 2)
    with pytest.raises(ValueError, match="no window of 64x64"):
        measure_dense_flow(measurer, *views, window=64)
    with pytest.raises(ValueError, match="reach is"):
        measure_dense_flow(measurer, *views, reach=(3, -1))
