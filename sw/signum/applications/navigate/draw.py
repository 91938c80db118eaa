# SPDX-License-Identifier: Apache-2.0
"""Pictures of navigation: the mosaic with the path of the frames and the target."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np

from signum.applications.navigate.chart import Chart
from signum.common.arrays import Image
from signum.geometry.similarity import Similarity
from signum.report.draw import GREEN, RED, YELLOW


def draw_path(chart: Chart, centres: Sequence[tuple[float, float]], last: Similarity | None = None,
              frame: tuple[int, int] = (0, 0), target: tuple[float, float] | None = None) -> Image:
    """The mosaic with a path on it.

    Args:
        chart: the mosaic.
        centres: of the frames, pixels of the mosaic, in order; NaN where one was not found, which breaks the line.
        last: the last frame's pixels -> mosaic, whose outline is drawn.
        frame: (width, height) of the frames.
        target: pixels of the mosaic.

    Returns:
        uint8 (H, W, 3) blue, green, red.
    """
    out = np.asarray(cv2.cvtColor(chart.picture, cv2.COLOR_GRAY2BGR), np.uint8)
    thick = max(1, round(max(chart.size) / 900))
    points = np.array(centres, np.float64).reshape(-1, 2)
    for a, b in pairwise(points):
        if np.isfinite(a).all() and np.isfinite(b).all():
            cv2.line(out, _pixel(a), _pixel(b), YELLOW, thick, cv2.LINE_AA)
    known = points[np.isfinite(points).all(axis=1)]
    for point in known[:1]:
        cv2.circle(out, _pixel(point), 4 * thick, YELLOW, thick, cv2.LINE_AA)
    if last is not None:
        w, h = frame[0] - 1, frame[1] - 1
        outline = last(np.array([[0, 0], [w, 0], [w, h], [0, h]], np.float64))
        cv2.polylines(out, [np.rint(outline).astype(np.int32)], True, GREEN, thick, cv2.LINE_AA)
    if target is not None:
        cv2.drawMarker(out, _pixel(np.array(target)), RED, cv2.MARKER_CROSS, 18 * thick, 2 * thick, cv2.LINE_AA)
    return out


def _pixel(point: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> tuple[int, int]:
    return round(float(point[0])), round(float(point[1]))
