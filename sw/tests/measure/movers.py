# SPDX-License-Identifier: Apache-2.0
"""Pairs of pictures of a photograph that turns, zooms and shifts, with a textured thing that moves otherwise, and how
well it is found."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from golden.params import DENSE
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.measurer import Measurer
from signum.measure.moving import Moving, segment_moving
from tests.dense_bars import PHOTOS, murky_pair, picture

SIZE = 400, 320
"""Of the pictures, width and height, pixels."""
LARGE = 440
"""Shorter side that small photographs are enlarged to, so that nothing beyond them comes into view."""
THINGS = "gravel", "grass", "brick", "coffee"
"""Photographs that things are cut from."""
TEXTURE = 12.0
"""Least standard deviation of a thing's grey levels from their surroundings: what is plain cannot be seen to move."""


@dataclass(frozen=True, eq=False)
class Scene:
    """A pair of pictures and what moves in it.

    Attributes:
        before, after: uint8 (H, W).
        mask: bool (H, W), the thing in the first picture; all false without one.
        background: motion of the photograph, pixels of the first picture -> of the second.
        own: of the thing's centre in the second picture from where the background would have carried it, pixels.
        label: what the pictures show.
        depth: median difference of the thing's pixels from those around them, grey levels in clear water.
    """

    before: Image
    after: Image
    mask: NDArray[np.bool_]
    background: Similarity
    own: tuple[float, float]
    label: str
    depth: float = 0.0

    @property
    def plain(self) -> bool:
        """Whether figure 8, which leaves a fourth of the contrast, leaves less than a level of most of the thing."""
        return self.depth < 4


def scene(seed: int, side: int | None, murky: bool = False, photo: str | None = None) -> Scene:
    """A scene.

    Args:
        seed: of everything.
        side: of the thing, pixels; None for none.
        murky: whether both pictures are as figure 8 has them, with other snow in each.
        photo: of the background; by the seed where None.
    """
    rng = np.random.default_rng([seed, side or 0])
    name = photo or PHOTOS[seed % len(PHOTOS)]
    ground = large_photo(name)
    middle = np.array([complex(*SIZE) / 2]).view(float)
    turn = Similarity.of(float(rng.uniform(-2, 2)), float(rng.uniform(0.98, 1.02)))
    carried = turn(middle) - middle
    background = Similarity(turn.factor, complex(*(rng.uniform(-6, 6, 2) - carried)))
    start = [float(rng.uniform(12, n - m - 12)) for n, m in zip(ground.shape[::-1], SIZE, strict=True)]
    place = Similarity(shift=-complex(*start))
    before, after = (_seen(ground, motion @ place) for motion in (Similarity(), background))
    mask, own, depth = np.zeros(SIZE[::-1], bool), (0.0, 0.0), 0.0
    if side is not None:
        other = THINGS[int(rng.integers(len(THINGS)))]
        thing, shape = _thing(rng, other, side)
        levels = thing.astype(np.float32)
        depth = float(np.median(np.abs(levels - cv2.GaussianBlur(levels, (0, 0), 2))[shape > 0]))
        centre = [float(rng.uniform(side / 2 + 12, n - side / 2 - 12)) for n in SIZE]
        angle, speed = rng.uniform(0, 2 * math.pi), rng.uniform(4, 9)
        own = float(speed * math.cos(angle)), float(speed * math.sin(angle))
        spin = Similarity.of(float(rng.uniform(-1.5, 1.5)))
        at = Similarity(shift=-complex(side, side) / 2)
        there = background(np.array(centre)) + own
        first = Similarity(shift=complex(*centre)) @ at
        second = Similarity(turn.factor * spin.factor, complex(*there)) @ at
        before, cover = _laid(before, thing, shape, first)
        after, _ = _laid(after, thing, shape, second)
        mask, name = cover > 0.5, f"{other} of {side} px on {name}"
    if murky:
        before, after = murky_pair((before, after), 2 * seed)
    return Scene(before, after, mask, background, own, f"{seed}: {name}{', murky' if murky else ''}", depth)


def large_photo(name: str) -> Image:
    """A photograph of scikit-image, no smaller than LARGE."""
    photo = picture(name)
    scale = LARGE / min(photo.shape)
    if scale <= 1:
        return photo
    return np.asarray(cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC), np.uint8)


def _thing(rng: np.random.Generator, name: str, side: int) -> tuple[Image, Image]:
    """A textured square of a photograph, and its outline: a square or an ellipse, 255 inside."""
    photo = large_photo(name)
    for _ in range(100):
        y, x = (int(rng.integers(0, n - side)) for n in photo.shape)
        thing = photo[y:y + side, x:x + side]
        detail = thing.astype(np.float32)
        if (detail - cv2.GaussianBlur(detail, (0, 0), 4)).std() >= TEXTURE:
            break
    shape = np.full((side, side), 255, np.uint8)
    if rng.random() < 0.5:
        shape[:] = 0
        cv2.ellipse(shape, (side // 2, side // 2), (side // 2 - 1, round(0.4 * side)), 0, 0, 360, 255, -1)
    return thing, shape


def _seen(photo: Image, motion: Similarity) -> Image:
    return np.asarray(cv2.warpAffine(photo, motion.matrix, SIZE, flags=cv2.INTER_CUBIC,
                                     borderMode=cv2.BORDER_REFLECT), np.uint8)


def _laid(ground: Image, thing: Image, shape: Image, motion: Similarity) -> tuple[Image, Floats]:
    """The picture with the thing over it, and the share of each pixel that it covers."""
    laid = cv2.warpAffine(thing, motion.matrix, SIZE, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    cover = np.asarray(cv2.warpAffine(shape, motion.matrix, SIZE, flags=cv2.INTER_LINEAR), np.float64) / 255
    return np.rint(ground * (1 - cover) + laid * cover).astype(np.uint8), cover


def segmented(before: Image, after: Image, reach: int = 16) -> Moving:
    """What moves by itself, by a golden board with the dense engine."""
    with GoldenBoard(DENSE) as board:
        measurer = Measurer(board, (before.shape[1], before.shape[0]), 1.5)
        views = measurer.pair(before, after)
        return segment_moving(measurer, *views, measure_dense_flow(measurer, *views, step=8), reach)


@dataclass(frozen=True)
class MovingFigures:
    """How well a scene's thing is found.

    Attributes:
        overlap: intersection over union of the mask of the object that is most of it; 0 where none is half of it.
        off_px: how far that object's own motion is from the truth.
        edge_px: mean distance of its outline from the true one.
        false: objects of which less than half is the thing.
    """

    overlap: float
    off_px: float
    edge_px: float
    false: int


def moving_figures(seen: Scene) -> MovingFigures:
    """Segment a scene and judge it."""
    found = segmented(seen.before, seen.after)
    overlap, off, edge, false = 0.0, math.inf, math.inf, 0
    for n, one in enumerate(found.objects, 1):
        part = found.labels == n
        common = int((part & seen.mask).sum())
        false += 2 * common < one.area
        union = common / int((part | seen.mask).sum())
        if union > max(overlap, 0.5):
            overlap, off = union, math.hypot(one.own_dx - seen.own[0], one.own_dy - seen.own[1])
            edge = _apart(part, seen.mask)
    return MovingFigures(overlap, off, edge, false)


def _apart(one: NDArray[np.bool_], other: NDArray[np.bool_]) -> float:
    """Mean distance of the outline of a mask from that of another, pixels."""
    rims = [mask & (cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) == 0) for mask in (one, other)]
    far = cv2.distanceTransform((~rims[1]).astype(np.uint8), cv2.DIST_L2, 5)
    return float(far[rims[0]].mean())
