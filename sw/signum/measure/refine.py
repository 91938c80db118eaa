# SPDX-License-Identifier: Apache-2.0
"""The motion of the surface that most of an overlap shows, from many small windows around a motion that is known.

Over relief the windows that agree within a wide tolerance are of many depths. A second look with smaller windows, four
times as many, each searched for near its place only, resolves the relief; a robust fit with a narrow scale then follows
the depth that most of the overlap has, as a person who lays one picture on the other would.

With the similarity q = f p + t a part that no similarity has is fitted, g conj(p): the shear by which a surface that is
not parallel to the picture appears. A camera that does not look straight down turns it into apparent rotation and
scale, which `applications.mosaic.level` takes out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Complexes, Floats
from signum.geometry.similarity import Similarity

NARROW = 1.5
"""Scale of the robust fit, pixels of the board: a window's error is under 1, relief displaces by more."""
WIDE = 3.0
"""Scale that it begins with."""
ROUNDS = 12
"""Rounds with each scale."""
LEAST = 8
"""Fewest windows that determine a shear beside the similarity."""
NARROWEST = 8.0
"""Least standard deviation of their places across the line that they lie along, pixels of the board."""
OVERLAPPING = 3.0
"""Number of windows that count as one: neighbours overlap by half each way."""


@dataclass(frozen=True)
class Refined:
    """A motion by many windows.

    Attributes:
        similarity: p -> q, without the shear.
        agree: bool (n,).
        rms_px: of the residuals of those, shear taken out, pixels.
        shear: g, at the centroid of those; 0 where it is not determined.
        shear_error: standard error of its real and imaginary parts; infinite where it is not determined.
    """

    similarity: Similarity
    agree: NDArray[np.bool_]
    rms_px: float
    shear: complex
    shear_error: float


def refine(p: Floats, q: Floats, start: Similarity, pixel: float) -> Refined:
    """Fit a similarity and a shear.

    Args:
        p, q: (n, 2) centres and places of windows near where `start` puts them, pixels, n >= 2.
        start: about right.
        pixel: size of a pixel of the board, pixels.
    """
    a, b = np.asarray(p @ [1, 1j], np.complex128), np.asarray(q @ [1, 1j], np.complex128)
    middle = complex(a.mean())
    sheared = len(a) >= LEAST and _wide(a, pixel)
    columns = _columns(a - middle, sheared)
    values = np.array([start.factor * middle + start.shift, start.factor, 0j][: columns.shape[1]])
    for scale in (WIDE * pixel, NARROW * pixel):
        for _ in range(ROUNDS):
            weight = 1 / (1 + (np.abs(columns @ values - b) / scale) ** 2)
            step: Complexes = np.linalg.lstsq(columns * weight[:, None], b * weight, rcond=None)[0]
            moved = float(np.abs(columns @ (step - values)).max())
            values = step
            if moved < 0.01 * pixel:
                break
    off = np.abs(columns @ values - b)
    agree = off <= NARROW * pixel
    shear, error = 0j, math.inf
    count = int(agree.sum())
    rms = float(np.sqrt(np.mean(off[agree] ** 2))) if count else 0.0
    if sheared and count >= LEAST and _wide(a[agree], pixel):
        inverse = np.linalg.inv((columns[agree].conj().T @ columns[agree]).real)
        noise = max(rms**2, (0.5 * pixel) ** 2) / 2 * count / (count - 3)
        shear, error = complex(values[2]), math.sqrt(float(inverse[2, 2]) * noise * OVERLAPPING)
    factor = complex(values[1])
    return Refined(Similarity(factor, complex(values[0]) - factor * middle), agree, rms, shear, error)


def _wide(a: Complexes, pixel: float) -> bool:
    """Whether points lie apart in both directions, rather than along a line."""
    off = np.stack([a.real - a.real.mean(), a.imag - a.imag.mean()])
    return bool(np.linalg.eigvalsh(off @ off.T / len(a))[0] > (NARROWEST * pixel) ** 2)


def _columns(a: Complexes, sheared: bool) -> Complexes:
    """What translation, rotation with scale, and shear multiply."""
    return np.stack([np.ones_like(a), a, a.conj()][: 3 if sheared else 2], axis=1)
