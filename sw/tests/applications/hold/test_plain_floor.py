# SPDX-License-Identifier: Apache-2.0
"""Floors with little texture, and floors that repeat themselves: the right values, or none."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import cv2
import numpy as np
import pytest
from skimage import data

from signum.applications.hold.level_camera import LevelCamera
from signum.applications.hold.matching import HOLD_RULES, share_above
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import UPRIGHT, Reading
from signum.applications.hold.reference import Reference
from signum.applications.hold.rivals import beats
from signum.applications.hold.search import WholeView
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.measure.measurer import Measurer

SIZE, FOCAL, RANGE_M = (320, 240), 350.0, 2.0
SNOW = 60


@pytest.fixture
def measurer() -> Iterator[Measurer]:
    with GoldenBoard() as board:
        yield Measurer(board, SIZE, 2.0)


@lru_cache(maxsize=1)
def _gravel() -> Floats:
    gravel = cv2.resize(data.gravel().astype(np.float32), (1280, 1280), interpolation=cv2.INTER_CUBIC)
    return np.asarray((gravel - gravel.mean()) / gravel.std(), np.float64)


def _faint(deviation: float) -> Floats:
    """Gravel, enlarged, with a deviation of so many grey levels."""
    return 80 + deviation * _gravel()


def _tiled(seed: int) -> Floats:
    """A floor that recurs every 100 pixels across and every 70 down."""
    tile = cv2.GaussianBlur(np.random.default_rng(seed).normal(0, 1, (70, 100)), (0, 0), 2)
    return np.asarray(np.tile(128 + 300 * tile, (8, 8)), np.float64)


def _seen(floor: Floats, x: int, y: int, seed: int, noise: float = 1.0) -> Image:
    """The view whose top left pixel is (x, y) of the floor, with noise in grey levels, and snow."""
    rng = np.random.default_rng(seed)
    seen = floor[y:y + SIZE[1], x:x + SIZE[0]] + rng.normal(0, noise, SIZE[::-1])
    for cell in rng.choice(12 * 16, SNOW, replace=False):  # apart from one another: two that touch are no flake
        top, left = 20 * np.array(divmod(int(cell), 16)) + rng.integers(4, 14, 2)
        seen[top:top + 3, left:left + 3] = 255
    return np.asarray(np.clip(np.rint(seen), 0, 255), np.uint8)


def test_snow_is_taken_out_and_the_rest_of_the_picture_stays(measurer: Measurer) -> None:
    picture = _seen(_faint(0.5), 400, 400, 0)
    cleared = StationMeter(measurer, FOCAL, RANGE_M, 48).view(picture).picture
    assert picture.max() == 255 and cleared.max() < 95
    assert (cleared == picture).mean() > 0.95


def test_a_floor_far_below_a_grey_level_under_noise_of_one_is_read(measurer: Measurer) -> None:
    floor = _faint(0.4)
    meter = StationMeter(measurer, FOCAL, RANGE_M, 48)
    meter.anchor(meter.view(_seen(floor, 400, 400, 0)))
    readings: list[Reading] = []
    for k in range(1, 9):
        live = meter.view(_seen(floor, 400 + 4 * k, 400 - 3 * k, k))
        readings.append(meter.read(live))
        measurer.release(live)
    assert all(r.valid for r in readings)
    px = np.array([[r.right, r.forward] for r in readings]) * FOCAL / RANGE_M
    assert px == pytest.approx(np.outer(np.arange(1, 9), [4, 3]), abs=1.0)


def test_the_whole_view_is_searched_for_a_yet_fainter_one(measurer: Measurer) -> None:
    floor, meter = _faint(0.2), StationMeter(measurer, FOCAL, RANGE_M, 48)
    for seed in range(4):
        views = [meter.view(_seen(floor, x, 400, seed + x)) for x in (400, 480)]
        search = WholeView(measurer, views[0].picture, 1 + 0j)
        found = search.look(views[1].picture)
        search.release()
        for view in views:
            measurer.release(view)
        assert found and abs(found[0].similarity.shift + 80) < 6


def test_the_places_that_look_like_the_reference_are_those_of_its_pattern(measurer: Measurer) -> None:
    floor = _tiled(1)
    reference = Reference(measurer, LevelCamera(SIZE, FOCAL), measurer.view(_seen(floor, 0, 0, 0)), UPRIGHT, (48, 80),
                          48, HOLD_RULES)
    twins = reference.twins()
    assert len(twins) >= 4
    off = np.abs(twins - np.array([100, 70]) * np.rint(twins / [100, 70]))
    assert (off.max(axis=1) <= 20).mean() >= 0.5  # a cell's half side; the others are of lesser places


def test_of_a_floor_that_repeats_itself_nothing_is_read(measurer: Measurer) -> None:
    floor = _tiled(2)
    meter = StationMeter(measurer, FOCAL, RANGE_M, 48)
    meter.anchor(meter.view(_seen(floor, 0, 0, 0)))
    live = meter.view(_seen(floor, 103, 2, 1))
    assert not meter.read(live).valid
    assert not meter.seek(live).valid


def test_a_place_must_beat_each_other_one_in_the_same_windows() -> None:
    uneven = np.linspace(0.6, 0.9, 12)
    unlike = uneven - 0.05
    assert beats(uneven, np.array([unlike]), 1.0, 3.0)
    assert not beats(uneven, np.array([unlike, uneven - 0.001]), 1.0, 3.0)
    assert not beats(uneven, np.array([unlike]), 0.02, 3.0)  # overlapping windows count less
    unseen = np.where(np.arange(12) < 2, uneven + 0.1, np.nan)
    assert beats(uneven, np.array([unlike, unseen]), 1.0, 3.0)


@pytest.mark.parametrize(("mean", "deviation"), [(0.57, 0.03), (0.56, 0.04), (0.60, 0.05), (0.70, 0.05)])
def test_windows_below_what_is_found_are_reckoned_with(mean: float, deviation: float) -> None:
    """Of faint texture only the better half of the windows is found at the right place: the others are not missed. The
    share is rather too large than too small, so that a part of the floor that recurs is not taken for the whole."""
    scores = np.random.default_rng(5).normal(mean, deviation, 4000)
    found = scores[scores > 0.56]
    true = len(found) / len(scores)
    assert true - 0.03 <= share_above(0.56, 0.56, found) <= 0.35 * true + 0.65
    assert share_above(0.60, 0.56, found) >= (scores > 0.60).mean() - 0.03
