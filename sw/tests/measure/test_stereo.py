# SPDX-License-Identifier: Apache-2.0
"""Stereo range against the truth of simulated planes and relief, of floors with boulders, and of
scikit-image's motorcycle pair."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.geometry.calibration import StereoGeometry
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.measurer import Measurer
from signum.measure.stereo import RangeMap, measure_range
from signum.report.ranges import write_ply
from signum.world.camera import Pinhole
from signum.world.degrade import degrade
from signum.world.seafloor import Seafloor
from signum.world.world import World
from tests.measure.relief import HEIGHT, WIDTH, relief_pair

BASELINE = 0.12
CAMERA = Pinhole(focal=400.0)
FLOORS = {"plane": {}, "slope": {"slope": (0.2, 0.3)}, "relief": {"relief": 0.1, "seed": 2},
          "rough": {"relief": 0.15, "feature": 0.5, "seed": 3}}

Pair = tuple[tuple[Image, Image], np.ndarray]
"""Left and right picture, and the true disparity of the left one's pixels."""


def errors(found: RangeMap, truth: np.ndarray) -> tuple[np.ndarray, float]:
    """Disparity errors of the valid measurements with truth, and their share of the grid."""
    e = found.disparity - truth[np.ix_(found.y.astype(int), found.x.astype(int))]
    return e[np.isfinite(e)], float(np.isfinite(e).mean())


@pytest.mark.parametrize("name", FLOORS)
@pytest.mark.parametrize("window", [16, 32])
def test_simulated_floors(name: str, window: int) -> None:
    world = World(Seafloor(extent=4.0, texel=0.0025, **FLOORS[name]))  # type: ignore[arg-type]
    left, right = world.look_pair(CAMERA, Sight(np.array([0, 0, -2.0]), rotation(0.05, 0.1, 0.3) @ LOOK_DOWN), BASELINE)
    measurer = Measurer(GoldenBoard(), CAMERA.size, 1.0)
    found = measure_range(measurer, *measurer.pair(left.frame, right.frame), (8, 48), (window, window))
    e, share = errors(found, CAMERA.focal * BASELINE / left.depth)
    close = np.abs(e) <= 0.5
    rms = float(np.sqrt(np.mean(e[close] ** 2)))
    print(f"{name} W={window}: {share:.0%} valid, {close.mean():.1%} within 0.5 px, RMS {rms:.3f} px")
    assert share > 0.6
    assert close.mean() >= 0.95
    assert rms <= 0.15


def _judged(pairs: list[Pair], what: str) -> tuple[float, float, float]:
    """Share of the windows that are valid; of these with truth, the shares that are more than 1 and 2 pixels off."""
    valid, off = [], []
    for (left, right), truth in pairs:
        measurer = Measurer(GoldenBoard(), (left.shape[1], left.shape[0]), 1.0)
        found = measure_range(measurer, *measurer.pair(left, right), (4, 64), step=8)
        valid.append(found.valid.mean())
        off.append(np.abs(errors(found, truth)[0]))
    wrong = np.concatenate(off)
    figures = float(np.mean(valid)), float((wrong > 1).mean()), float((wrong > 2).mean())
    print("{}: {:.1%} valid, of them {:.1%} beyond 1 px, {:.1%} beyond 2 px".format(what, *figures))
    return figures


def _degraded(pairs: list[Pair], seed: int) -> list[Pair]:
    """As figure 8 has it, with other snow in every picture."""
    return [((degrade(left, seed + 2 * k), degrade(right, seed + 2 * k + 1)), truth)
            for k, ((left, right), truth) in enumerate(pairs)]


@pytest.fixture(scope="module")
def motorcycle() -> list[Pair]:
    from skimage import data

    left, right, truth = data.stereo_motorcycle()
    scale = 640 / left.shape[1]
    size = 640, round(left.shape[0] * scale)
    first, second = (np.asarray(cv2.resize(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), size, interpolation=cv2.INTER_AREA),
                                np.uint8) for p in (left, right))
    known = np.where(np.isfinite(truth), truth, np.nan).astype(np.float32) * scale
    return [((first, second), cv2.resize(known, size, interpolation=cv2.INTER_NEAREST))]


@pytest.fixture(scope="module")
def relief() -> list[Pair]:
    return [relief_pair(seed) for seed in range(700, 710)]


@pytest.mark.parametrize("scene", ["motorcycle", "relief"])
def test_clear_pairs(scene: str, request: pytest.FixtureRequest) -> None:
    valid, beyond_1, beyond_2 = _judged(request.getfixturevalue(scene), scene)
    assert valid >= 0.65 and beyond_1 <= 0.07 and beyond_2 <= 0.05


@pytest.mark.parametrize("scene", ["motorcycle", "relief"])
def test_murky_pairs(scene: str, request: pytest.FixtureRequest) -> None:
    valid, beyond_1, _ = _judged(_degraded(request.getfixturevalue(scene), 11), f"{scene}, figure 8")
    assert valid >= 0.55 and beyond_1 <= 0.08


def test_windows_at_the_border_are_as_good_as_others(relief: list[Pair]) -> None:
    """Though a window twice as large, which must agree, does not fit round them."""
    rims, inside, off = [], [], []
    for (left, right), truth in relief:
        measurer = Measurer(GoldenBoard(), (WIDTH, HEIGHT), 1.0)
        found = measure_range(measurer, *measurer.pair(left, right), (4, 64), step=8)
        rims.append(found.valid[[0, -1]].mean())
        inside.append(found.valid[1:-1].mean())
        off.append((found.disparity - truth[np.ix_(found.y.astype(int), found.x.astype(int))])[[0, -1]].ravel())
    wrong = np.abs(np.concatenate(off))
    print(f"{np.mean(rims):.1%} valid at the border, {np.mean(inside):.1%} inside")
    assert np.mean(rims) >= 0.9 * np.mean(inside)
    assert (wrong[np.isfinite(wrong)] > 1).mean() <= 0.07


def test_pairs_that_have_nothing_in_common(relief: list[Pair]) -> None:
    lefts, rights = zip(*(pictures for pictures, _ in relief), strict=True)
    strangers = [((left, right), np.zeros_like(relief[0][1])) for left, right in zip(lefts, (*rights[1:], rights[0]),
                                                                                  strict=True)]
    valid, *_ = _judged(strangers, "unlike pairs")
    assert valid <= 0.02


def test_a_window_of_stripes_along_the_rows_is_refused() -> None:
    """It has no texture along its row, and looks unlike itself above and below."""
    stripes = np.repeat(np.random.default_rng(1).integers(0, 256, (108, 1), dtype=np.uint8), 4, 0)[:HEIGHT]
    picture = np.repeat(stripes, WIDTH, 1)
    measurer = Measurer(GoldenBoard(), (WIDTH, HEIGHT), 1.0)
    found = measure_range(measurer, *measurer.pair(picture, picture), (4, 64), step=16)
    assert not found.valid.any()


def test_points_lie_on_the_plane(tmp_path: Path) -> None:
    geometry = StereoGeometry(CAMERA.focal, BASELINE, CAMERA.centre)
    world = World(Seafloor(extent=4.0, texel=0.0025))
    left, right = world.look_pair(CAMERA, Sight(np.array([0, 0, -2.0]), LOOK_DOWN), BASELINE)
    measurer = Measurer(GoldenBoard(), CAMERA.size, 1.0)
    points = measure_range(measurer, *measurer.pair(left.frame, right.frame), (8, 48), (32, 32)).points(geometry)
    assert len(points) > 100
    assert points[:, 2] == pytest.approx(2.0, abs=0.02)
    write_ply(tmp_path / "floor.ply", points)
    lines = (tmp_path / "floor.ply").read_text().splitlines()
    assert f"element vertex {len(points)}" in lines and len(lines) == 7 + len(points)
