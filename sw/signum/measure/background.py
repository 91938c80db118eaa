# SPDX-License-Identifier: Apache-2.0
"""The motion that most of a field of flow has: that of the background, for any turn and motion of the camera over a
fairly flat scene."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.measure.flow import FlowField

MOST_PX = 1.0
"""Farthest that a window of the background lies from the common motion, by errors and by relief, pixels. Dense flow
lies at most 0.6 pixels from the truth in figure 8, see `tests.dense_bars`."""
LEAST_SHARE = 0.4
"""Least share of the valid windows that a common motion must have."""
LEAST_WINDOWS = 12
"""Fewest windows that have it."""
LEAST_SPREAD = 0.5
"""Least extent of these windows across and down, as a share of the field's: beyond it a homography says little."""
TO_DEVIATION = 1.4826
"""Standard deviation of normal errors as a multiple of their median size."""


@dataclass(frozen=True, eq=False)
class Background:
    """The motion of the background between two pictures.

    Attributes:
        matrix: (3, 3) homography, pixels of the first picture -> of the second.
        noise_px: standard deviation of a component of the windows' displacements from it.
        share: of the valid windows that have it.
    """

    matrix: Floats
    noise_px: float
    share: float

    def __call__(self, points: Floats) -> Floats:
        """Where the background's points (n, 2) of the first picture lie in the second."""
        return np.asarray(cv2.perspectiveTransform(points[None].astype(np.float64), self.matrix)[0], np.float64)


def find_background(field: FlowField) -> Background | None:
    """The homography that most valid windows of a field agree on; None where too few do, or only in a part of the view.

    RANSAC finds it, least squares over those that agree refine it.
    """
    u, v = np.meshgrid(field.x, field.y)
    valid = field.valid
    at = np.stack([u[valid], v[valid]], -1)
    to = at + np.stack([field.dx[valid], field.dy[valid]], -1)
    if len(at) < LEAST_WINDOWS:
        return None
    matrix, agreed = cv2.findHomography(at, to, cv2.RANSAC, MOST_PX)
    if matrix is None:
        return None
    agree = agreed[:, 0] > 0
    extent = [float(np.ptp(np.percentile(at[agree, k], (2, 98)))) / max(float(np.ptp(side)), 1.0)
              for k, side in enumerate((field.x, field.y))]
    if agree.sum() < max(LEAST_WINDOWS, LEAST_SHARE * len(at)) or min(extent) < LEAST_SPREAD:
        return None
    found = Background(np.asarray(matrix, np.float64), 0.0, float(agree.mean()))
    off = np.abs(to - found(at))[agree]
    return Background(found.matrix, TO_DEVIATION * float(np.median(off)), found.share)
