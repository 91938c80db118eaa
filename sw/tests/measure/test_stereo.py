# SPDX-License-Identifier: Apache-2.0
"""Stereo range against the truth of simulated planes and relief, and of scikit-image's motorcycle pair."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from signum.boards.golden import GoldenBoard
from signum.geometry.calibration import StereoGeometry
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.measurer import Measurer
from signum.measure.stereo import RangeMap, measure_range
from signum.report.ranges import write_ply
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.world import World

BASELINE = 0.12
CAMERA = Pinhole(focal=400.0)
FLOORS = {"plane": {}, "slope": {"slope": (0.2, 0.3)}, "relief": {"relief": 0.1, "seed": 2},
          "rough": {"relief": 0.15, "feature": 0.5, "seed": 3}}


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


def test_motorcycle() -> None:
    from skimage import data

    left, right, truth = data.stereo_motorcycle()
    scale = 640 / left.shape[1]
    size = (640, round(left.shape[0] * scale))
    pair = [np.asarray(cv2.resize(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), size, interpolation=cv2.INTER_AREA), np.uint8)
            for p in (left, right)]
    truth = np.where(np.isfinite(truth), truth, np.nan).astype(np.float32) * scale
    measurer = Measurer(GoldenBoard(), size, 1.0)
    found = measure_range(measurer, *measurer.pair(*pair), (4, 64))
    e, share = errors(found, cv2.resize(truth, size, interpolation=cv2.INTER_NEAREST))
    within = float((np.abs(e) <= scale).mean())  # one pixel of the original picture
    print(f"motorcycle: {share:.0%} valid, {within:.1%} within 1 px")
    assert share > 0.3
    assert within >= 0.90


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
