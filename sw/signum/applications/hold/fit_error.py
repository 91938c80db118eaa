# SPDX-License-Identifier: Apache-2.0
"""Standard errors of a least-squares similarity, by the residuals of the windows that agree with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity


class FitError(NamedTuple):
    """Of a similarity q = F p + t that is fitted to n pairs, with residuals of standard deviation s a coordinate.

    The fit gives the points' centroid with s / sqrt(n) and F with s / lever, where lever^2 is the sum of the squared
    distances from the centroid. Rotation and scale then have the relative error s / (lever |F|); the ground point above
    which the camera stands, at -t / F, lies |centroid + t / F| from the centroid, by which F's error reaches it.

    Attributes:
        turn: of the rotation, radians, and of the scale as a fraction.
        shift_px: of -t / F, the camera's place on the ground, pixels of the present view, in each direction.
    """

    turn: float
    shift_px: float

    @classmethod
    def of(cls, points: Floats, found: Floats, similarity: Similarity, least_px: float) -> FitError:
        """From the pairs that agree.

        Args:
            points: (n, 2) pixels p, n >= 2.
            found: (n, 2) pixels q.
            similarity: the fit.
            least_px: lower bound of the residuals' standard deviation, pixels.
        """
        n = len(points)
        miss = found - similarity(points)
        noise = max(least_px, float(np.sqrt((miss**2).sum() / max(2 * n - 4, 1))))
        centre = points.mean(axis=0)
        lever = max(float(np.sqrt(((points - centre)**2).sum())), 1e-6)
        below = similarity.shift / similarity.factor
        arm = abs(complex(*centre) + below)
        turn = noise / (lever * similarity.scale)
        return cls(turn, noise * float(np.hypot(1 / np.sqrt(n), arm / lever)))
