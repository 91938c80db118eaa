# SPDX-License-Identifier: Apache-2.0
"""Similarities of the plane: rotation, scale and translation, and their robust least-squares fit to pairs of points.

Pixels, x to the right and y down, so a positive rotation is clockwise on the screen. Points are float64 (..., 2).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Complexes, Floats


@dataclass(frozen=True)
class Similarity:
    """q = factor * p + shift, in complex numbers x + iy: |factor| is the scale, its angle the rotation."""

    factor: complex = 1 + 0j
    shift: complex = 0j

    @classmethod
    def of(cls, rot_deg: float = 0.0, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)) -> Similarity:
        """From a rotation in degrees, a scale and a translation in pixels."""
        return cls(cmath.rect(scale, math.radians(rot_deg)), complex(*shift))

    @property
    def rot_deg(self) -> float:
        """Rotation, degrees, -180..180."""
        return math.degrees(cmath.phase(self.factor))

    @property
    def scale(self) -> float:
        """Scale, above 0."""
        return abs(self.factor)

    @property
    def inverse(self) -> Similarity:
        """The similarity q -> p."""
        return Similarity(1 / self.factor, -self.shift / self.factor)

    @property
    def matrix(self) -> Floats:
        """2x3, as OpenCV's warps take it."""
        a, t = self.factor, self.shift
        return np.array([[a.real, -a.imag, t.real], [a.imag, a.real, t.imag]])

    def __call__(self, points: Floats) -> Floats:
        """The images q of points p, (..., 2)."""
        return _points(self.factor * _complex(points) + self.shift)

    def __matmul__(self, first: Similarity) -> Similarity:
        """`self @ first`: first the right one, then the left one."""
        return Similarity(self.factor * first.factor, self.factor * first.shift + self.shift)


IDENTITY = Similarity()


def corners(size: tuple[int, int]) -> Floats:
    """Centres (4, 2) of the corner pixels of a picture (width, height), clockwise from the top left."""
    right, bottom = size[0] - 1, size[1] - 1
    return np.array([[0, 0], [right, 0], [right, bottom], [0, bottom]], np.float64)


def overlap(similarity: Similarity, size: tuple[int, int]) -> float:
    """Share of a picture b that also shows picture a, 0..1.

    Args:
        similarity: pixels of a -> pixels of b.
        size: width and height of both, pixels.
    """
    frame = corners(size)
    area, _ = cv2.intersectConvexConvex(similarity(frame).astype(np.float32), frame.astype(np.float32))
    return float(area) / ((size[0] - 1) * (size[1] - 1))


@dataclass(frozen=True)
class FitResult:
    """A robust fit.

    Attributes:
        similarity: p -> q.
        agree: bool (n,), the pairs within the tolerance.
        rms_px: of their residuals, (x, y) together.
        turning: whether rotation and scale were fitted; else they are 0 and 1, as the points do not determine them.
    """

    similarity: Similarity
    agree: NDArray[np.bool_]
    rms_px: float
    turning: bool


def vote(
    p: Floats,
    q: Floats,
    tolerance: float,
    max_rot_deg: float,
    max_zoom: float,
    apart: float,
) -> tuple[Similarity, NDArray[np.bool_]]:
    """The similarity most pairs agree on, of all translations by one pair and all similarities by two pairs.

    Args:
        p, q: (n, 2) points and where they were found, n >= 1; most may be wrong.
        tolerance: pixels by which an agreeing pair may miss.
        max_rot_deg, max_zoom: bounds of what is tried; the scale lies between 1/max_zoom and max_zoom.
        apart: least distance of two points that define a similarity, pixels.

    Returns:
        The similarity and which pairs agree, bool (n,). Of equal votes a translation wins, then the first.
    """
    a, b = _complex(p), _complex(q)
    i, j = np.triu_indices(len(a), 1)
    far = np.abs(a[i] - a[j]) >= apart
    i, j = i[far], j[far]
    factors = (b[i] - b[j]) / (a[i] - a[j])
    zoom = np.abs(factors)
    sane = (zoom <= max_zoom) & (zoom * max_zoom >= 1) & (np.abs(np.angle(factors)) <= math.radians(max_rot_deg))
    i, factors = i[sane], factors[sane]
    factors = np.concatenate([np.ones(len(a), complex), factors])
    shifts = np.concatenate([b - a, b[i] - factors[len(a) :] * a[i]])
    agree = np.abs(factors[:, None] * a + shifts[:, None] - b) <= tolerance
    best = int(np.argmax(agree.sum(axis=1)))
    return Similarity(complex(factors[best]), complex(shifts[best])), agree[best]


def least_squares(p: Floats, q: Floats) -> Similarity:
    """The similarity p -> q of least squares, from two or more pairs that are all right; (n, 2) pixels."""
    return _solve(_complex(p), _complex(q), np.ones(len(p)), True)


def fit(p: Floats, q: Floats, start: Similarity, tolerance: float, max_rot_error_deg: float = 1.0) -> FitResult:
    """Least squares with Tukey weights from a good start, agreeing pairs chosen anew each round.

    Rotation and scale are fitted if the agreeing points lie far enough apart for the rotation's standard error to stay
    below `max_rot_error_deg`; else the result is a translation, without the start's rotation and scale.

    Args:
        p, q: (n, 2) pixels.
        start: a similarity that is about right.
        tolerance: pixels at which a pair's weight reaches zero.
        max_rot_error_deg: largest standard error of a fitted rotation.
    """
    a, b = _complex(p), _complex(q)
    found, turning, rms = start, True, 0.0
    agree = np.abs(found.factor * a + found.shift - b) <= tolerance
    for turn in (True, False):
        found = start
        if not turn and agree.any():
            found = Similarity(1 + 0j, complex(np.median((b - a)[agree].real), np.median((b - a)[agree].imag)))
        for _ in range(8):
            residual = np.abs(found.factor * a + found.shift - b)
            agree = residual <= tolerance
            if agree.sum() < 2:
                break
            weight = np.where(agree, (1 - (residual / tolerance) ** 2) ** 2 + 1e-9, 0.0)
            found = _solve(a, b, weight, turn)
        rms = math.sqrt(float(np.mean(residual[agree] ** 2))) if agree.any() else 0.0
        turning = turn
        if turn and agree.sum() >= 3:
            spread = math.sqrt(float(np.sum(np.abs(a[agree] - a[agree].mean()) ** 2)))
            if spread > 0 and math.degrees(max(rms, 0.5) / spread) <= max_rot_error_deg:
                break
    return FitResult(found, agree, rms, turning)


def _solve(a: Complexes, b: Complexes, weight: Floats, turn: bool) -> Similarity:
    weight = weight / weight.sum()
    ca, cb = complex(weight @ a), complex(weight @ b)
    if not turn:
        return Similarity(1 + 0j, cb - ca)
    power = float(weight @ np.abs(a - ca) ** 2)
    factor = complex(weight @ (np.conj(a - ca) * (b - cb))) / power if power > 0 else 1 + 0j
    return Similarity(factor, cb - factor * ca)


def _complex(points: Floats) -> Complexes:
    return np.ascontiguousarray(points, np.float64).view(np.complex128)[..., 0]


def _points(values: Complexes) -> Floats:
    return np.asarray(values, np.complex128)[..., None].view(np.float64)
