# SPDX-License-Identifier: Apache-2.0
"""Which windows of a picture are fish: those that are near (range), or that move against the terrain (motion).

Of these one contiguous blob of windows is kept: isolated windows are mostly wrong measurements.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from signum.common.arrays import Floats
from signum.geometry.calibration import StereoGeometry
from signum.measure.flow import FlowField
from signum.measure.moving import Moving
from signum.measure.stereo import STEREO_RULES, RangeMap
from signum.measure.validity import Rules

Mask = NDArray[np.bool_]

LEAST_WINDOWS = 3
"""Least number of windows of a blob."""
NEAR_RULES = replace(STEREO_RULES, min_margin=0.02, max_return_px=1.0)
"""For disparities: a fish fills few windows, and one on its outline may match the fish or its background. Contiguity
decides."""
FLOW_RULES = Rules(min_score=0.62, min_margin=0.03, backward=False, texture=False)
"""For flow: isolated wrong measurements are rejected by contiguity."""
SAME_RANGE = 0.08
"""Largest relative difference of range between neighbouring windows of one blob."""
AROUND_PX = 70.0
"""Largest distance of a changed window from the fish's expected position at which it may belong to it."""
DOMINANT_PX = 1.0
"""Largest residual of terrain from the dominant motion, caused by relief."""


@dataclass(frozen=True, eq=False)
class Blob:
    """A contiguous set of windows.

    Attributes:
        x, y: their mean centre, pixels. width, height: of their bounding box, pixels.
        windows: their number; sure: number of these measured as fish, the others have only changed.
        mask: (ny, nx), the grid's windows that belong to it.
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
    """A segmented grid of windows.

    Attributes:
        x, y: centres (nx,), (ny,), pixels.
        fish: (ny, nx), windows that are fish.
        known: (ny, nx), windows with a valid measurement.
        changed: (ny, nx), windows that should be in view but match nowhere, as on a fish that turns.
        range_m: (ny, nx) metres, NaN where unknown.
    """

    x: Floats
    y: Floats
    fish: Mask
    known: Mask
    changed: Mask
    range_m: Floats


def segment_by_range(found: RangeMap, geometry: StereoGeometry, nearer: float) -> Segmented:
    """Windows nearer than `nearer` metres are fish."""
    depth = geometry.depth(found.disparity)
    return Segmented(found.x, found.y, np.asarray(depth < nearer), found.valid, np.zeros_like(found.valid), depth)


def segment_by_motion(field: FlowField, size: tuple[int, int], disagree_px: float = 1.5) -> Segmented:
    """Windows whose motion differs from the dominant one by more than `disagree_px` are fish.

    The dominant motion is the homography that most windows agree on (RANSAC): that of the terrain, for any rotation of
    the camera, if the terrain is fairly flat and fills most of the view. With fewer than twelve measured windows there
    is no fish. A window that the dominant motion keeps inside the picture of `size` (width, height), yet matches
    nowhere, has changed.
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


def segment_by_mask(moving: Moving, x: Floats, y: Floats) -> Segmented:
    """Places of a grid, x (nx,) and y (ny,), that something which moves by itself covers are fish."""
    fish = moving.labels[np.ix_(y.astype(int), x.astype(int))] > 0
    known = np.full(fish.shape, moving.background is not None)
    return Segmented(x, y, fish, known, np.zeros_like(fish), np.full(fish.shape, np.nan))


def _connected(fish: Mask, range_m: Floats) -> tuple[int, NDArray[np.int64]]:
    """Number of contiguous sets of windows, and each window's set, -1 for none. Neighbours of different range are not
    connected: adjacent snow flakes are not a fish."""
    rows, columns = np.nonzero(fish)
    near = np.log(range_m[rows, columns])
    joined = ((np.abs(rows[:, None] - rows) <= 1) & (np.abs(columns[:, None] - columns) <= 1)
              & ~(np.abs(near[:, None] - near) > SAME_RANGE))
    count, found = connected_components(csr_array(joined), directed=False)
    labels = np.full(fish.shape, -1, np.int64)
    labels[rows, columns] = found
    return int(count), labels


def one_blob(seen: Segmented, near: tuple[float, float] | None = None, least: int = LEAST_WINDOWS) -> Blob | None:
    """The best contiguous blob of fish windows (8-neighbours): the largest, or with `near` the one with the best ratio
    of size to distance from it, including changed windows around it.

    Args:
        near: expected position of the fish, pixels; None for any.
        least: least number of windows.

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
