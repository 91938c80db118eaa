"""Which windows of a picture are fish: those that are near (range), or that move against the terrain (motion).

Either way one contiguous blob of windows is kept. Scattered single measurements are mostly wrong ones; a fish is in one
piece.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from signum.common.arrays import Floats
from signum.geometry.calibration import StereoGeometry
from signum.measure.flow import FlowField
from signum.measure.measurer import Rules
from signum.measure.stereo import RangeMap

Mask = NDArray[np.bool_]

LEAST_WINDOWS = 3
NEAR_RULES = Rules(min_score=0.7, min_margin=0.02, max_return_px=1.0)
"""For disparities: a window on the outline of a fish may answer either way, contiguity is the second opinion."""
FLOW_RULES = Rules(min_score=0.62, min_margin=0.03, backward=False, texture=False)
"""For flow: what is wrong alone is dropped as no contiguous blob."""
SAME_RANGE = 0.08
"""Relative difference of range within one blob, from window to window."""
AROUND_PX = 70.0
"""How far from where the fish is expected a changed window may be part of it."""
DOMINANT_PX = 1.0
"""By how much terrain may miss the dominant motion: relief moves windows apart."""


@dataclass(frozen=True, eq=False)
class Blob:
    """A contiguous set of windows.

    Attributes:
        x, y: their middle, pixels. width, height: of what they span, pixels.
        windows: how many; sure: how many of these measured as fish, the others have merely changed.
        mask: (ny, nx), which of the grid's.
        range_m: their median range where it was measured, else NaN.
    """

    x: float
    y: float
    width: float
    height: float
    windows: int
    sure: int
    mask: Mask
    range_m: float = float("nan")


@dataclass(frozen=True, eq=False)
class Segmented:
    """What a segmentation says of a grid of windows with centres x (nx,), y (ny,), pixels: which are fish (ny, nx),
    which have been measured at all (ny, nx), which look like nothing they should look like, as a fish does that turns
    (ny, nx), and their range (ny, nx), metres, NaN where unknown."""

    x: Floats
    y: Floats
    fish: Mask
    known: Mask
    changed: Mask
    range_m: Floats


def by_range(found: RangeMap, geometry: StereoGeometry, nearer: float) -> Segmented:
    """Fish is what is nearer than `nearer` metres."""
    depth = geometry.depth(found.disparity)
    return Segmented(found.x, found.y, np.asarray(depth < nearer), found.valid, np.zeros_like(found.valid), depth)


def by_motion(field: FlowField, size: tuple[int, int], disagree_px: float = 1.5) -> Segmented:
    """Fish is what moves otherwise than the picture as a whole, by more than `disagree_px`.

    The whole picture's motion is the homography that most windows agree on (RANSAC): that of the terrain, as long as it
    is fairly flat and fills the larger part of the view, however the camera turns. With fewer than twelve measured
    windows nothing is fish. A window that terrain would have kept inside the picture of `size` (width, height), yet
    matches nowhere, has changed.
    """
    known = field.valid
    u, v = np.meshgrid(field.x, field.y)
    at = np.stack([u[known], v[known]], axis=-1)
    to = at + np.stack([field.dx[known], field.dy[known]], axis=-1)
    fish, changed = np.zeros(known.shape, bool), np.zeros(known.shape, bool)
    if len(at) >= 12:
        model, agree = cv2.findHomography(at, to, cv2.RANSAC, DOMINANT_PX)
        if model is not None and agree.sum() >= 0.4 * len(at):
            everywhere = np.stack([u, v], axis=-1).astype(np.float64)
            ground = cv2.perspectiveTransform(everywhere, model)
            fish[known] = np.linalg.norm(to - ground[known], axis=1) > disagree_px
            margin = field.x[0]
            inside = (ground > margin).all(axis=-1) & (ground < np.array(size) - 1 - margin).all(axis=-1)
            changed = ~known & inside
    return Segmented(field.x, field.y, fish, known, changed, np.full(known.shape, np.nan))


def _connected(fish: Mask, range_m: Floats) -> tuple[int, NDArray[np.int64]]:
    """How many contiguous sets of windows there are, and each window's, -1 for none. Neighbours whose ranges differ are
    apart: snow flakes side by side are no fish."""
    rows, columns = np.nonzero(fish)
    near = np.log(range_m[rows, columns])
    joined = ((np.abs(rows[:, None] - rows) <= 1) & (np.abs(columns[:, None] - columns) <= 1)
              & ~(np.abs(near[:, None] - near) > SAME_RANGE))
    count, found = connected_components(csr_array(joined), directed=False)
    labels = np.full(fish.shape, -1, np.int64)
    labels[rows, columns] = found
    return int(count), labels


def one_blob(seen: Segmented, near: tuple[float, float] | None = None, least: int = LEAST_WINDOWS) -> Blob | None:
    """The contiguous blob of fish windows (corners touch) that is kept: the largest, or of several the one that is
    large for its distance from `near`, to which changed windows around belong too.

    Args:
        near: where the fish is expected, pixels; None for anywhere.
        least: windows a blob must have.

    Returns:
        None if there is none.
    """
    fish = seen.fish
    if near is not None:
        around = np.hypot(*np.meshgrid(seen.x - near[0], seen.y - near[1])) < AROUND_PX
        fish = fish | (seen.changed & around)
    count, labels = _connected(fish, seen.range_m)
    step = float(seen.x[1] - seen.x[0]) if seen.x.size > 1 else 1.0
    best: tuple[float, Blob] | None = None
    for label in range(count):
        mask = np.asarray(labels == label)
        rows, columns = np.nonzero(mask)
        if len(rows) < least:
            continue
        sure = int(seen.fish[mask].sum())
        xs, ys = seen.x[columns], seen.y[rows]
        ranges = seen.range_m[mask]
        blob = Blob(float(xs.mean()), float(ys.mean()), float(np.ptp(xs)) + step, float(np.ptp(ys)) + step, len(rows),
                    sure, mask, float(np.median(ranges)) if np.isfinite(ranges).all() else float("nan"))
        away = float(np.hypot(xs - near[0], ys - near[1]).min()) / (3 * step) if near else 0.0
        worth = (1 + sure + len(rows)) / (1 + away**2)
        if best is None or worth > best[0]:
            best = worth, blob
    return best[1] if best else None
