# SPDX-License-Identifier: Apache-2.0
"""Figure 5: stereo range on simulated floors, and on scikit-image's motorcycle."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.geometry.calibration import StereoGeometry
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.measurer import Measurer
from signum.measure.stereo import RangeMap, measure_range
from signum.report.page import Bar, Section, figure, paragraph, row, table
from signum.report.ranges import draw_range
from signum.reproduce import OpenBoard, Progress
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.seafloor import Seafloor
from signum.world.world import World

CAMERA = Pinhole(focal=400.0)
SHAPES: dict[str, dict[str, object]] = {
    "plane": {}, "slope": {"slope": (0.2, 0.3)}, "relief": {"relief": 0.1}, "rough": {"relief": 0.15, "feature": 0.5}}
WINDOWS = 16, 32
FLOOR_SEEDS = 3
"""Floors of each shape."""


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """Disparities of simulated floors, without noise, and of the motorcycle pair, against their truth."""
    seeds = 1 if quick else FLOOR_SEEDS
    floors = {n: SHAPES[n] for n in (("plane", "relief") if quick else SHAPES)}
    lines, shown, worst = [], [], {"close": 1.0, "rms": 0.0}
    with open_board() as board, progress("stereo", len(floors) * seeds + 1) as tell:
        for name, shape in floors.items():
            missed: dict[int, list[Floats]] = {w: [] for w in WINDOWS}
            shares: dict[int, list[float]] = {w: [] for w in WINDOWS}
            for k in range(seeds):
                world = World(Seafloor(extent=4.0, texel=0.0025, seed=seed + k, **shape))  # type: ignore[arg-type]
                sight = Sight(np.array([0, 0, -2.0]), rotation(0.05, 0.1, 0.3) @ LOOK_DOWN)
                left, right = world.look_pair(CAMERA, sight, BASELINE_M)
                truth = CAMERA.focal * BASELINE_M / left.depth.astype(np.float64)
                measurer = Measurer(board, CAMERA.size, 1.0)
                views = measurer.pair(left.frame, right.frame)
                for window in WINDOWS:
                    found = measure_range(measurer, *views, (8, 48), (window, window))
                    missed[window].append(_errors(found, truth))
                    shares[window].append(float(found.valid.mean()))
                    if name == "relief" and k == 0 and window == WINDOWS[0]:
                        geometry = StereoGeometry(CAMERA.focal, BASELINE_M, CAMERA.centre)
                        shown = [figure(left.frame, "left"), figure(right.frame, "right"),
                                 figure(draw_range(found, geometry, left.frame), "range, m, on the left picture")]
                tell(name)
            for window in WINDOWS:
                e = np.concatenate(missed[window])
                close = np.abs(e) <= 0.5
                rms = float(np.sqrt(np.mean(e[close] ** 2)))
                worst = {"close": min(worst["close"], float(close.mean())), "rms": max(worst["rms"], rms)}
                lines.append([f"{name}, {window}x{window}", f"{np.mean(shares[window]):.0%}", f"{close.mean():.1%}",
                              f"{rms:.3f}"])
        within, bike = _motorcycle(open_board)
        tell("motorcycle")
    bars = (Bar("simulated floors: valid ones within 0.5 px, worst floor and window", worst["close"], ">=", 0.95),
            Bar("RMS of those, px, worst floor and window", worst["rms"], "<=", 0.15))
    heads = "floor, window", "valid", "of them within 0.5 px", "RMS of those, px"
    return [
        Section("Figure 5: stereo range", paragraph(
            f"A {100 * BASELINE_M:g} cm baseline 2 m above simulated floors, without noise; every disparity is a "
            "one-dimensional search along its row, checked from right to left.")
            + row(shown) + table(heads, lines), bars),
        Section("Stereo on a real pair", paragraph(
            "scikit-image's motorcycle, with its own ground truth; pixels are those of the original pictures.")
            + row(bike), (Bar("motorcycle: valid ones within 1 px", within, ">=", 0.90),))]


def _errors(found: RangeMap, truth: Floats) -> Floats:
    """Disparity errors of the valid measurements that have a truth, pixels."""
    e = found.disparity - truth[np.ix_(found.y.astype(int), found.x.astype(int))]
    return np.asarray(e[np.isfinite(e)], np.float64)


def _motorcycle(open_board: OpenBoard) -> tuple[float, list[str]]:
    from skimage import data

    left, right, truth = data.stereo_motorcycle()
    scale = 640 / left.shape[1]
    size = (640, round(left.shape[0] * scale))
    pair: list[Image] = [np.asarray(cv2.resize(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), size,
                                                 interpolation=cv2.INTER_AREA), np.uint8) for p in (left, right)]
    true = cv2.resize(np.where(np.isfinite(truth), truth, np.nan).astype(np.float32) * scale, size,
                      interpolation=cv2.INTER_NEAREST).astype(np.float64)
    with open_board() as board:
        measurer = Measurer(board, size, 1.0)
        found = measure_range(measurer, *measurer.pair(pair[0], pair[1]), (4, 64))
    e = _errors(found, true)
    shown = figure(draw_range(found, None, pair[0]), f"disparity, px: {found.valid.mean():.0%} of windows valid")
    return float((np.abs(e) <= scale).mean()), [figure(pair[0], "left"), shown]
