# SPDX-License-Identifier: Apache-2.0
"""Quality of dense stereo and dense flow against the truth, clean and as figure 8 degrades it; `make dense-bars`.

    python -m tests.dense_bars [--seed 1]

Stereo: scikit-image's motorcycle scaled to 640 pixels width, windows of 16x16; with truth, clean: 70 % of the pixels
valid, of those 8 % beyond 1 px and 6 % beyond 2 px; figure 8: 60 % valid, 10 % beyond 1 px. Flow: eight photographs
moved by up to 9 px each way, windows of 32x32 at every fourth pixel: 85 % valid, none beyond 1 px, RMS of both
components 0.1 px over all photographs clean, 0.2 px under figure 8; each photograph's own figures are printed. Without
a bar, for comparison: rocket, whose sky is darker and lighter by one grey level only, which moves by whole pixels; and
pairs of boulders on a floor. The status is 1 if a bar is missed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from golden.params import DENSE
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.dense_stereo import measure_dense_range
from signum.measure.measurer import Measurer
from signum.world.degrade import degrade
from tests.measure.relief import relief_pair

PHOTOS = "camera", "coffee", "chelsea", "astronaut", "gravel", "grass", "moon", "coins"
"""Photographs that scikit-image's wheel holds; those with a bar."""
SPARE = 12
"""Pixels that are cut off each side of a moved photograph."""
REACH = 10
Pair = tuple[Image, Image]


def picture(name: str) -> Image:
    """A photograph of scikit-image, grey, uint8."""
    from skimage import data

    photo = np.asarray(getattr(data, name)())
    return np.asarray(photo if photo.ndim == 2 else cv2.cvtColor(photo[..., :3], cv2.COLOR_RGB2GRAY), np.uint8)


def moved_pair(photo: Image, dx: float, dy: float, most: tuple[int, int] = (640, 480)) -> Pair:
    """A photograph and the same moved to the right and down, pixels; no larger than `most` (width, height)."""
    height, width = photo.shape
    moved = cv2.warpAffine(photo, np.array([[1, 0, dx], [0, 1, dy]]), (width, height), flags=cv2.INTER_CUBIC,
                           borderMode=cv2.BORDER_REFLECT)
    part = slice(SPARE, min(height - SPARE, SPARE + most[1])), slice(SPARE, min(width - SPARE, SPARE + most[0]))
    return photo[part].copy(), np.asarray(moved[part], np.uint8)


def murky_pair(pair: Pair, seed: int) -> Pair:
    """Both pictures as figure 8 has them, with other snow in each."""
    return degrade(pair[0], seed), degrade(pair[1], seed + 1)


def motorcycle() -> tuple[Pair, Floats]:
    """scikit-image's pair, 640 pixels wide, and the left one's disparities, NaN where they are not known."""
    from skimage import data

    *both, truth = data.stereo_motorcycle()
    scale = 640 / truth.shape[1]
    size = 640, int(truth.shape[0] * scale)
    left, right = (np.asarray(cv2.resize(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), size, interpolation=cv2.INTER_AREA),
                              np.uint8) for p in both)
    known = np.where(np.isfinite(truth), truth * scale, np.nan)
    return (left, right), np.asarray(cv2.resize(known, size, interpolation=cv2.INTER_NEAREST), np.float64)


def stereo_figures(pair: Pair, truth: NDArray[np.floating], most: int = 64) -> tuple[float, float, float]:
    """Share of the pixels with truth that are valid; of these, the shares more than 1 and 2 pixels off."""
    measurer = Measurer(GoldenBoard(DENSE), (truth.shape[1], truth.shape[0]), 1.0)
    found = measure_dense_range(measurer, *measurer.pair(*pair), (0, most))
    off = np.abs(found.disparity - truth)[found.valid & np.isfinite(truth)]
    return off.size / float(np.isfinite(truth).sum()), float((off > 1).mean()), float((off > 2).mean())


def flow_figures(pair: Pair, moved: tuple[float, float]) -> tuple[float, float, float]:
    """Share of the windows that are valid; RMS of their components' errors, and the largest error, pixels."""
    measurer = Measurer(GoldenBoard(DENSE), (pair[0].shape[1], pair[0].shape[0]), 1.5)
    field = measure_dense_flow(measurer, *measurer.pair(*pair), reach=(REACH, REACH))
    off = np.hypot(field.dx - moved[0], field.dy - moved[1])[field.valid]
    return float(field.valid.mean()), float(np.sqrt(np.mean(off**2) / 2)), float(off.max())


def judge_stereo(seed: int, tell: Callable[[bool | None, str], None]) -> None:
    """Measure and tell the stereo figures."""
    pair, truth = motorcycle()
    scenes: list[tuple[str, Pair, NDArray[np.floating], bool]] = [("motorcycle", pair, truth, True)]
    scenes += [(f"relief {n}", *relief_pair(n), False) for n in (700, 702)]
    for name, both, known, held in scenes:
        for murky in (False, True):
            valid, beyond_1, beyond_2 = stereo_figures(murky_pair(both, seed) if murky else both, known)
            good = valid >= 0.6 and beyond_1 <= 0.1 if murky else valid >= 0.7 and beyond_1 <= 0.08 and beyond_2 <= 0.06
            tell(good if held else None, f"stereo, {name}, {'figure 8' if murky else 'clean'}: {valid:.1%} valid, of "
                 f"these {beyond_1:.1%} beyond 1 px, {beyond_2:.1%} beyond 2 px")


def judge_flow(seed: int, tell: Callable[[bool | None, str], None]) -> None:
    """Measure and tell the flow figures."""
    rng = np.random.default_rng(seed)
    squares: dict[bool, list[float]] = {False: [], True: []}
    for name in (*PHOTOS, "rocket"):
        moved = tuple(rng.uniform(-9, 9, 2).tolist())
        pair = moved_pair(picture(name), *moved)
        for murky in (False, True):
            valid, rms, worst = flow_figures(murky_pair(pair, seed) if murky else pair, moved)
            held = name in PHOTOS
            if held:
                squares[murky].append(rms**2)
            tell(valid >= 0.85 and worst <= 1 if held else None, f"flow, {name} moved by ({moved[0]:.2f}, "
                 f"{moved[1]:.2f}) px, {'figure 8' if murky else 'clean'}: {valid:.1%} valid, RMS {rms:.3f} px, at "
                 f"most {worst:.2f} px")
    for murky, bar in ((False, 0.1), (True, 0.2)):
        rms = float(np.sqrt(np.mean(squares[murky])))
        tell(rms <= bar, f"flow, all photographs, {'figure 8' if murky else 'clean'}: RMS {rms:.3f} px")


def main(arguments: list[str] | None = None) -> int:
    """Measure, print and judge; 1 if a bar is missed."""
    parser = argparse.ArgumentParser(prog="make dense-bars", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    missed = []

    def tell(good: bool | None, line: str) -> None:
        print("no bar" if good is None else "kept" if good else "MISSED", line, sep=": ", flush=True)
        if good is False:
            missed.append(line)

    print(f"seed {given.seed}")
    judge_stereo(given.seed, tell)
    judge_flow(given.seed, tell)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
