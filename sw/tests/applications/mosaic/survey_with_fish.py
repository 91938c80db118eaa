# SPDX-License-Identifier: Apache-2.0
"""Frames of a flat floor, evenly bright, as a survey back and forth shows it: uneven light, changing exposure, fish.

The floor is known, and where every frame lies, so that a mosaic's light, fish and sharpness can be measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.mosaic.simulate import back_and_forth
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity
from signum.world.seafloor import photograph, quilt

SIZE = 192, 144
STEP = 0.5
ROOM = 150
"""Pixels of the floor around the frames' centres."""


@dataclass(frozen=True, eq=False)
class Lit:
    """A survey.

    Attributes:
        frames: uint8 (144, 192). even: the same without fish, noise, uneven light. places: pixels -> floor.
        floor: (H, W), grey levels. fished: uint8 (H, W), 1 where a fish hides the floor in some frame.
        seen: uint8 (H, W), number of frames that show each place.
    """

    frames: list[Image]
    even: list[Image]
    places: list[Similarity]
    floor: Floats
    fished: Image
    seen: Image


def lit_survey(seed: int, rows: int = 6, columns: int = 6, fish: float = 0.4, drift: float = 0.8, lean: float = 0.3,
               sand: float = 0.0, scale: float = 1.0) -> Lit:
    """A survey.

    Args:
        seed: of texture, places, fish and noise.
        rows, columns: frames.
        fish: share of the frames that show one.
        drift: logarithm of the exposure, from one corner of the survey to the opposite one.
        lean: the same from a frame's middle to its side, beside the light cone's fall.
        sand: by how much a round patch of the floor as large as a frame is brighter, logarithm.
        scale: of the photograph.
    """
    rng = np.random.default_rng([seed, 17])
    width, height = (round(STEP * n) for n in SIZE)
    extent = 2 * ROOM + columns * width, 2 * ROOM + rows * height
    floor = quilt(photograph("gravel", scale), max(extent), rng, 128)[: extent[1], : extent[0]].astype(np.float64)
    x, y = np.meshgrid(np.arange(extent[0]) - extent[0] / 2, np.arange(extent[1]) - extent[1] / 2)
    floor *= np.exp(sand / (1 + np.exp((np.hypot(x, y) - 70) / 3)))
    u, v = np.meshgrid(np.linspace(-1, 1, SIZE[0]), np.linspace(-1, 1, SIZE[1]))
    light = np.exp(-0.5 * ((u - 0.15) ** 2 + 0.6 * (v + 0.1) ** 2) + lean * u)
    frames, even, places = [], [], []
    fished, seen = np.zeros(floor.shape, np.uint8), np.zeros(floor.shape, np.uint8)
    for row, column in back_and_forth(rows, columns):
        factor = rng.uniform(0.97, 1.03) * np.exp(1j * np.radians(rng.normal(0, 3) + 180 * (column % 2)))
        at = complex(ROOM + (column + 0.5) * width, ROOM + (row + 0.5) * height) + complex(*rng.normal(0, 4, 2))
        place = Similarity(complex(factor), at - factor * complex(*((n - 1) / 2 for n in SIZE)))
        clear = cv2.warpAffine(floor, place.matrix, SIZE, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
        mask = np.zeros(SIZE[::-1], np.uint8)
        if rng.random() < fish:
            middle = tuple(int(n) for n in rng.uniform((30, 30), (SIZE[0] - 30, SIZE[1] - 30)))
            cv2.ellipse(mask, middle, (28, 12), float(rng.uniform(0, 180)), 0, 360, 1, -1)
        skin = np.asarray(cv2.GaussianBlur(rng.standard_normal(SIZE[::-1]), (0, 0), 1))
        body = rng.choice([40.0, 200.0]) + 12 * skin
        gain = np.exp(drift * ((row / rows + column / columns) / 2 - 0.5) + rng.normal(0, 0.06))
        view = np.where(mask > 0, body, clear) * light * gain
        frames.append(np.clip(np.rint(view + rng.normal(0, 1.5, view.shape)), 0, 255).astype(np.uint8))
        even.append(np.clip(np.rint(clear), 0, 255).astype(np.uint8))
        places.append(place)
        for onto, what in ((fished, mask), (seen, np.ones_like(mask))):
            onto += np.asarray(cv2.warpAffine(what, place.matrix, onto.shape[::-1], flags=cv2.INTER_NEAREST), np.uint8)
    return Lit(frames, even, places, floor, (fished > 0).astype(np.uint8), seen)


@dataclass(frozen=True)
class Looks:
    """How a mosaic of such a survey looks beside its floor.

    Attributes:
        slope: change of brightness from one side of the survey to the other by the fitted plane, share.
        uneven: standard deviation of the brightness averaged over a quarter of a frame, share.
        fish: share of the area where fish swam over places that several frames show that is off by more than 15 %.
        sharp: mean squared gradient over that of the floor, where no fish swam.
    """

    slope: float
    uneven: float
    fish: float
    sharp: float

    def __str__(self) -> str:
        return (f"brightness slopes by {self.slope:.1%} and varies by {self.uneven:.1%}; {self.fish:.1%} of the fish "
                f"are left; gradient energy {self.sharp:.1%}")


def judge_looks(survey: Lit, picture: Image, origin: tuple[float, float]) -> Looks:
    """Compare a mosaic, its corner at `origin` of the floor, with the floor."""
    x, y = (int(n) for n in origin)
    here = np.s_[y:y + picture.shape[0], x:x + picture.shape[1]]
    floor, seen, fished = survey.floor[here], survey.seen[here], survey.fished[here]
    whole = cv2.erode((seen > 0).astype(np.uint8), np.ones((25, 25), np.uint8), borderValue=0) > 0
    shown = picture.astype(np.float64)
    ratio = np.log(_averaged(shown, whole, 12) / _averaged(floor, whole, 12))
    v, u = np.nonzero(whole)
    terms = np.column_stack([u / np.ptp(u), v / np.ptp(v), np.ones(len(u))])
    slopes = np.linalg.lstsq(terms, ratio[whole], rcond=None)[0][:2]
    level = float(np.median(ratio[whole]))
    near = [np.log(np.maximum(_averaged(p, whole, 2.5), 1)) for p in (shown, floor)]
    off = np.abs(near[0] - near[1] - level)
    swum = whole & (fished > 0) & (seen > 2)
    calm = whole & (cv2.dilate(fished, np.ones((9, 9), np.uint8)) == 0)
    sharp = _energy(shown, calm) / _energy(floor, calm) / np.exp(2 * level)
    left = float((off > 0.15)[swum].sum() / max(swum.sum(), 1))
    return Looks(float(np.abs(slopes).max()), float(ratio[whole].std()), left, float(sharp))


def _averaged(picture: Floats, where: NDArray[np.bool_], width: float) -> Floats:
    share = cv2.GaussianBlur(where.astype(np.float64), (0, 0), width)
    return np.asarray(cv2.GaussianBlur(picture * where, (0, 0), width) / np.maximum(share, 1e-3) + 1e-3)


def _energy(picture: Floats, where: NDArray[np.bool_]) -> float:
    """Mean squared gradient."""
    return float((cv2.Sobel(picture, cv2.CV_64F, 1, 0) ** 2 + cv2.Sobel(picture, cv2.CV_64F, 0, 1) ** 2)[where].mean())
