# SPDX-License-Identifier: Apache-2.0
"""Stereo: scikit-image's motorcycle, and rendered floors with boulders, with their true disparities."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.measure.measurer import Measurer
from signum.measure.stereo import measure_range
from signum.report.page import Section, figure, row
from tests.compare.table import WATERS, Column, Task, Tell, in_water
from tests.measure.relief import relief_pair

NEAREST = 64
"""Largest disparity searched for, pixels; the least is 4."""
STEP = 8
Range = Callable[[Image, Image], Floats]
"""(left, right) -> disparities of the left picture, (H, W) or on the grid of `grid`, NaN where refused."""
Scene = tuple[Image, Image, Floats]
"""Left, right, true disparity of the left one's pixels, NaN where unknown."""


def by_signum(left: Image, right: Image) -> tuple[Floats, Floats, Floats]:
    """The golden board: x, y, disparity (ny, nx) on its grid."""
    with GoldenBoard() as board:
        measurer = Measurer(board, (left.shape[1], left.shape[0]), 1.0)
        found = measure_range(measurer, *measurer.pair(left, right), (4, NEAREST), step=STEP)
    return found.x, found.y, found.disparity


def by_blocks(left: Image, right: Image) -> Floats:
    """StereoBM, windows of 15, its usual checks of uniqueness and speckles."""
    matcher = cv2.StereoBM.create(NEAREST, 15)
    matcher.setUniquenessRatio(10)
    matcher.setSpeckleWindowSize(100)
    matcher.setSpeckleRange(2)
    return _disparity(matcher.compute(left, right))


def semi_global(left: Image, right: Image) -> Floats:
    """StereoSGBM, blocks of 5, with the penalties that OpenCV's manual gives, left-right check, speckle filter."""
    matcher = cv2.StereoSGBM.create(0, NEAREST, 5, 8 * 25, 32 * 25, 1, 0, 10, 100, 2)
    return _disparity(matcher.compute(left, right))


def _disparity(found: np.ndarray) -> Floats:
    return np.where(found < 16, np.nan, found / 16.0)


METHODS: dict[str, Range] = {"StereoBM": by_blocks, "StereoSGBM": semi_global}


def motorcycle() -> Scene:
    """The pair at 640x431."""
    from skimage import data

    left, right, truth = data.stereo_motorcycle()
    scale = 640 / left.shape[1]
    size = 640, round(left.shape[0] * scale)
    pair = [np.asarray(cv2.resize(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), size, interpolation=cv2.INTER_AREA), np.uint8)
            for p in (left, right)]
    known = np.where(np.isfinite(truth), truth, np.nan).astype(np.float32) * scale
    return pair[0], pair[1], cv2.resize(known, size, interpolation=cv2.INTER_NEAREST).astype(np.float64)


def _figures(off: list[Floats]) -> tuple[float, float, float]:
    """Share measured, of those with truth the shares beyond 1 and 2 pixels."""
    every = np.concatenate(off)
    good = every[np.isfinite(every)]
    return len(good) / len(every), float((good > 1).mean()), float((good > 2).mean())


def compare_stereo(seed: int, quick: bool, tell: Tell) -> list[tuple[Task, Section]]:
    """All methods on the motorcycle, then on rendered floors."""
    floors = [(*pictures, truth.astype(np.float64))
              for pictures, truth in (relief_pair(800 + 10 * seed + k) for k in range(1 if quick else 6))]
    sets: dict[str, list[Scene]] = {"scikit-image's motorcycle": [] if quick else [motorcycle()],
                                    "rendered floors with boulders": floors}
    out = []
    for title, scenes in sets.items():
        if not scenes:
            continue
        task = Task(f"Stereo: {title}", (
            Column("points measured", "{:.0%}", "more"), Column("of them beyond 1 px", "{:.1%}", "less"),
            Column("beyond 2 px", "{:.1%}", "less")))
        shown = []
        for water in WATERS:
            off: dict[str, list[Floats]] = {name: [] for name in ("Signum", *METHODS)}
            for k, (left, right, truth) in enumerate(scenes):
                a, b = (in_water(p, water, 8000 * seed + 2 * k + i) for i, p in enumerate((left, right)))
                with task.timed("Signum"):
                    x, y, own = by_signum(a, b)
                here = np.ix_(y.astype(int), x.astype(int))
                known = np.isfinite(truth[here])
                maps = {"Signum": own}
                for name, method in METHODS.items():
                    with task.timed(name):
                        maps[name] = method(a, b)[here]
                for name, found in maps.items():
                    off[name].append(np.abs(found - truth[here])[known])
                    if k == 0:
                        shown.append(figure(_drawn(found), f"{name}, {water}"))
                if k == 0:
                    shown.insert(-3, figure(a, f"left, {water}"))
            for name, errors in off.items():
                task.note(name, water, *_figures(errors))
                tell(f"{name}, {water}")
        text = (f"{len(scenes)} pair{'s' if len(scenes) > 1 else ''} of 640x431, disparities of 4 to {NEAREST} pixels, "
                "judged where the truth is known at the centres of Signum's windows, every "
                f"{STEP} pixels. A point that only one eye sees has a truth, too: to refuse it is right.")
        out.append((task, task.section(text, row(shown[:4]) + row(shown[4:]))))
    return out


def _drawn(disparity: Floats) -> Image:
    """Disparities in colours, black where there are none."""
    level = np.clip(np.nan_to_num(disparity) * (255 / NEAREST), 0, 255).astype(np.uint8)
    drawn = np.asarray(cv2.applyColorMap(level, cv2.COLORMAP_TURBO), np.uint8)
    drawn[~np.isfinite(disparity)] = 0
    return drawn
