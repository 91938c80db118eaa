# SPDX-License-Identifier: Apache-2.0
"""What moves by itself between two pictures, pixel by pixel, by the dense engine.

The second picture is warped back by the background's motion and captured again: there the background rests, and small
windows that are found elsewhere, side by side and alike, have a motion of their own. For each such motion the second
picture is warped by it too. A pixel belongs to whatever motion the window around it matches best: on an outline half of
the window is the one's and half the other's, so that the outline is sharper than the window.

Two pictures tell motion from rest only as far as one homography holds for all that rests. A stone that is much nearer
than the floor shifts against it when the camera moves, and is found as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from golden.dense import DensePass
from signum.common.arrays import Image
from signum.geometry.similarity import Similarity
from signum.measure.background import Background, find_background
from signum.measure.flow import FlowField
from signum.measure.measurer import Measurer, View
from signum.measure.motions import Residuals, find_motions
from signum.measure.warped import mismatches, stays_in_view, warped
from signum.measure.winners import search_winners

Flags = NDArray[np.bool_]
Whole = NDArray[np.int32]
STRIDES = 4
"""Places of the search for motions in a window's side."""
MOST_LEAN = 3
"""Largest shift of the best place from its row to the next, pixels: one further away is another."""
DETAIL_PX = 2.0
"""Width of the Gaussian that makes a pixel's surroundings."""


@dataclass(frozen=True)
class MovingRules:
    """What counts as moving by itself. Lengths in pixels; scores are matching fractions.

    Attributes:
        least_px: least motion against the background. The field lies up to 0.6 pixels from the truth in murky water
            (`tests.dense_bars`), and so may the background.
        deviations: the same, in standard deviations of the field from the background's motion, which relief enlarges.
        min_score: least score of a window with a motion of its own.
        margin: by how much a motion's score must exceed the background's.
        towards_chance: largest number of mismatches within an outline, as a share of the way from the object's usual
            number to that of chance. On an outline half of the window matches; what the object hides, or has just laid
            open, matches by no motion.
        like_px: largest difference of motions that are the same.
        groups: of each side of windows, in the order of the searches, the fewest that side by side have a motion, in
            windows that do not overlap. The last are those that outlines are drawn with.
        least_area: least area of an object, windows of the smallest side.
        least_share: least share of an object's windows that found its motion by themselves.
        least_depth: least median difference of an object's pixels from those around them, grey levels, if it stays at
            its place in the picture: less may be the steps of light that falls off, which are fixed to the camera.
        most: most motions that are told apart by each search.
    """

    least_px: float = 1.5
    deviations: float = 5.0
    min_score: float = 0.6
    margin: float = 0.06
    towards_chance: float = 0.6
    like_px: float = 1.0
    groups: tuple[tuple[int, float], ...] = ((32, 2.5), (16, 6.0))
    least_area: float = 4.0
    least_share: float = 0.45
    least_depth: float = 0.7
    most: int = 6


@dataclass(frozen=True)
class MovingObject:
    """A connected part of the first picture that moves by itself; pixels.

    Attributes:
        x: its centroid, right.
        y: the same, down.
        left: of its box.
        top: of its box.
        width: of its box.
        height: of its box.
        area: pixels.
        dx: displacement of the centroid to the second picture, right.
        dy: the same, down.
        own_dx: displacement, less that which the background has there, right.
        own_dy: the same, down.
        score: matching fraction of its windows, by its motion.
        margin: by how much this exceeds their matching fraction by the background's motion.
        confidence: 0..100, percentage of its windows at which a search over all displacements found its motion.
    """

    x: float
    y: float
    left: int
    top: int
    width: int
    height: int
    area: int
    dx: float
    dy: float
    own_dx: float
    own_dy: float
    score: float
    margin: float
    confidence: int


@dataclass(frozen=True, eq=False)
class Moving:
    """What moves by itself between two pictures.

    Attributes:
        labels: uint8 (H, W) of the first picture, 0 for the background, n for `objects[n - 1]`.
        objects: the largest first.
        background: what they move against; None where the field has no common motion, and nothing can be told.
    """

    labels: NDArray[np.uint8]
    objects: tuple[MovingObject, ...]
    background: Background | None


def segment_moving(measurer: Measurer, before: View, after: View, field: FlowField, reach: int = 16,
                   rules: MovingRules | None = None) -> Moving:
    """Find what moves by itself.

    Args:
        measurer: took both views, on a board with the dense engine, and can take one more.
        before: the earlier view.
        after: the later one.
        field: the flow between them, from which the background's motion is taken.
        reach: largest motion against the background that is searched for, across and down, pixels.
        rules: what counts.

    Raises:
        BoardError: if the board has no dense engine, or not of these windows.
        RuntimeError: if all slots of the board hold views.
    """
    rules = rules or MovingRules()
    background, side = find_background(field), rules.groups[-1][0]
    if background is None:
        return Moving(np.zeros(before.picture.shape, np.uint8), (), None)
    with warped(measurer, after, background.matrix) as still:
        rest = mismatches(measurer, before, still, side)
        rest[~stays_in_view(background.matrix, before, side)] = 0  # what leaves the view may rest
        own = _own_motions(measurer, (before, still), rest, background, reach, rules)
    counts = [rest]
    for motion, _ in own:
        matrix = background.matrix @ np.vstack([motion.matrix, [0, 0, 1]])
        with warped(measurer, after, matrix) as live:
            counts.append(mismatches(measurer, before, live, side))
        counts[-1][~stays_in_view(matrix, before, side)] = side**2
    best = np.argmin(counts, 0)
    best[np.min(counts, 0) + rules.margin * side**2 > rest] = 0
    depth, parts = _depth(before.picture), []
    for n, (motion, windows) in enumerate(own, 1):
        alike = windows.like(motion, rules.like_px)
        for part in _parts(best == n, counts[n], side, rules):
            inside = part[windows.at[..., 1], windows.at[..., 0]]
            share = float(alike[inside].mean()) if inside.any() else 0.0
            scores = [1 - float(c[part].mean()) / side**2 for c in (rest, counts[n])]
            one = _described(part, motion, background, scores, round(100 * share))
            with_camera = np.hypot(one.dx, one.dy) <= rules.like_px
            if share >= rules.least_share and not (with_camera and np.median(depth[part]) < rules.least_depth):
                parts.append((part, one))
    parts.sort(key=lambda pair: -pair[1].area)
    labels = np.zeros(before.picture.shape, np.uint8)
    for n, (part, _) in enumerate(parts, 1):
        labels[part] = n
    return Moving(labels, tuple(one for _, one in parts), background)


def _own_motions(measurer: Measurer, views: tuple[View, View], rest: Whole, background: Background, reach: int,
                 rules: MovingRules) -> list[tuple[Similarity, Residuals]]:
    """The motions against the background, each with the windows that it was found by."""
    own: list[tuple[Similarity, Residuals]] = []
    least = max(rules.least_px, rules.deviations * background.noise_px)
    for side, group in rules.groups:
        area, step = float(side**2), side // STRIDES
        found = search_winners(measurer, views, side, (-reach, reach), (-reach, reach), step)
        known = found.whole & (np.abs(found.lean) <= MOST_LEAN).all(0)
        dx, dy = (np.where(known, d, np.nan) for d in found.fine(known, area))
        y, x = (np.clip(at * step - side // 2 + 1, 0, size - 1)
                for at, size in zip(np.indices(dx.shape), rest.shape, strict=True))
        resting = measurer.dense(*views, DensePass(side, 1), (step, step)).best
        sure = known & (found.best <= (1 - rules.min_score) * area) & (resting - found.best >= rules.margin * area)
        sure &= (np.hypot(dx, dy) >= least) & (rest[y, x] > 0)
        windows = Residuals(np.stack([x, y], -1), np.stack([dx, dy], -1), sure)
        motions = find_motions(windows, round(group * STRIDES**2), rules.like_px, rules.most, [m for m, _ in own])
        own += [(motion, windows) for motion in motions]
    return own


def _depth(picture: Image) -> NDArray[np.float32]:
    """How much each pixel differs from those around it, grey levels."""
    levels = picture.astype(np.float32)
    return np.asarray(np.abs(levels - cv2.GaussianBlur(levels, (0, 0), DETAIL_PX)), np.float32)


def _parts(mask: Flags, counts: Whole, side: int, rules: MovingRules) -> list[Flags]:
    """The connected parts of a mask that are large enough, without what its motion does not explain, and with holes
    filled that are smaller."""
    usual = float(np.median(counts[mask])) if mask.any() else 0.0
    explained = mask & (counts <= usual + rules.towards_chance * (side**2 / 2 - usual))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side // 2 + 1,) * 2)
    closed = cv2.morphologyEx(explained.astype(np.uint8), cv2.MORPH_CLOSE, disc)
    least = rules.least_area * side**2
    _, holes, stats, _ = cv2.connectedComponentsWithStats(1 - closed, connectivity=4)
    filled = (stats[:, cv2.CC_STAT_AREA] < least)[holes] | (closed > 0)
    count, parts, stats, _ = cv2.connectedComponentsWithStats(filled.astype(np.uint8), connectivity=4)
    return [np.asarray(parts == n) for n in range(1, count) if stats[n, cv2.CC_STAT_AREA] >= least]


def _described(part: Flags, own: Similarity, background: Background, scores: list[float], confidence: int
               ) -> MovingObject:
    """An object's figures; `scores` by the background's motion and by its own."""
    y, x = np.nonzero(part)
    at = np.array([[x.mean(), y.mean()]])
    to = background(own(at))
    (dx, dy), (own_dx, own_dy) = ((to - start)[0].tolist() for start in (at, background(at)))
    width, height = int(np.ptp(x)) + 1, int(np.ptp(y)) + 1
    return MovingObject(float(at[0, 0]), float(at[0, 1]), int(x.min()), int(y.min()), width, height, x.size, dx, dy,
                        own_dx, own_dy, scores[1], scores[1] - scores[0], confidence)
