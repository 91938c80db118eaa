# SPDX-License-Identifier: Apache-2.0
"""The similarity between two views of a floor that is nearly flat and level, by robust least squares.

A point of height h over the floor moves by t h / Z besides, where t is the shift of the picture's centre and Z the
range. Over a part of the floor with a slope, that has the gradient t slope / f: half of it looks like a rotation and a
scale, of up to a degree where half of the view has gone, and half of it is a shear, which shows. So the slope is fitted
too, with the prior that it is small:

    q = F p + t (1 + slope . (p - p0) / f),    p0 the middle of the windows that agree.

A slope of what is not displaced, t = 0, has no effect and adds no error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity

SLOPE = 0.1
"""Standard deviation of a floor's slope over what two views share."""
RELIEF = 0.01
"""Standard deviation of its mean height over what two views share, as a share of the range: unseen by the fit."""
LEAST_NOISE_PX = 0.3
"""Lower bound of the windows' noise in the fit, pixels."""
ROUNDS = 8


@dataclass(frozen=True, eq=False)
class GroundFit:
    """A fit.

    Attributes:
        points: (n, 2) pixels p.
        similarity: p -> q.
        agree: bool (n,), the pairs within the tolerance.
        misses: (n,) distances from the fit, pixels.
        noise: standard deviation of the agreeing pairs' misses, pixels a coordinate.
        spread: (6, 6) covariance of F, t (real and imaginary) and the slope for noise of one pixel, with the prior.
    """

    points: Floats
    similarity: Similarity
    agree: NDArray[np.bool_]
    misses: Floats
    noise: float
    spread: Floats

    def sloping(self, focal: float) -> bool:
        """Whether a slope could move the windows by a pixel, as far as they lie from one another."""
        extent = float(np.hypot(*np.ptp(self.points, axis=0))) / 2
        return abs(self.similarity.shift) * SLOPE * extent / focal > 1

    def errors(self, least_px: float) -> tuple[float, float]:
        """Standard errors: of the rotation, radians, and of the scale as a share; of -t / F, the camera's place on the
        ground, pixels of the present view, in each direction.

        Args:
            least_px: lower bound of the noise, pixels.
        """
        factor, shift = self.similarity.factor, self.similarity.shift
        cov = self.spread * max(self.noise, least_px) ** 2
        turn = float(np.sqrt((cov[0, 0] + cov[1, 1]) / 2)) / abs(factor)
        below = -shift / factor
        lever = np.array([[below.real, -below.imag, 1, 0], [below.imag, below.real, 0, 1]])
        place = float(np.sqrt(np.trace(lever @ cov[:4, :4] @ lever.T) / 2))
        return turn, float(np.hypot(place, RELIEF * abs(shift) / np.sqrt(2)))  # it acts along the shift only


def fit_ground(p: Floats, q: Floats, start: Similarity, focal: float, tolerance: float) -> GroundFit:
    """Least squares with Tukey weights from a good start, agreeing pairs chosen anew each round.

    Args:
        p, q: (n, 2) level pixels from the picture's centre, n >= 3.
        start: a similarity that is about right.
        focal: pixels.
        tolerance: pixels at which a pair's weight reaches zero.
    """
    unknown = np.array([start.factor.real, start.factor.imag, start.shift.real, start.shift.imag, 0.0, 0.0])
    rows = _rows(p, start.shift, p.mean(axis=0), focal)
    noise, spread, unknowns = tolerance / 2, np.eye(6), 4.0
    for _ in range(ROUNDS):
        misses = np.hypot(*(q - rows @ unknown).T)
        agree = misses <= tolerance
        if agree.sum() < 3:
            break
        weight = np.where(agree, (1 - (misses / tolerance) ** 2) ** 2 + 1e-9, 0.0)
        noise = max(LEAST_NOISE_PX, float(np.sqrt((weight * misses**2).sum() / max(2 * weight.sum() - unknowns, 1.0))))
        shift, middle = complex(unknown[2], unknown[3]), p[agree].mean(axis=0)
        rows = _rows(p, shift, middle, focal)
        normal = np.einsum("nij,n,nik->jk", rows, weight, rows)
        prior = (noise / SLOPE) ** 2
        normal[[4, 5], [4, 5]] += prior
        spread = np.linalg.pinv(normal, hermitian=True)
        unknowns = 6 - prior * float(spread[4, 4] + spread[5, 5])
        unknown = spread @ np.einsum("nij,n,ni->j", rows, weight, q)
    misses = np.hypot(*(q - rows @ unknown).T)
    agree = misses <= tolerance
    found = Similarity(complex(unknown[0], unknown[1]), complex(unknown[2], unknown[3]))
    return GroundFit(p, found, agree, misses, noise, spread)


def _rows(p: Floats, shift: complex, middle: Floats, focal: float) -> Floats:
    """(n, 2, 6): q is these times the unknowns."""
    rows = np.zeros((len(p), 2, 6))
    rows[:, 0, 0], rows[:, 0, 1] = p[:, 0], -p[:, 1]
    rows[:, 1, 0], rows[:, 1, 1] = p[:, 1], p[:, 0]
    rows[:, 0, 2] = rows[:, 1, 3] = 1
    rows[:, :, 4:] = np.array([shift.real, shift.imag])[:, None] * ((p - middle) / focal)[:, None, :]
    return rows
