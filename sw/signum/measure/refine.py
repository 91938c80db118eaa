# SPDX-License-Identifier: Apache-2.0
"""The motion of a rough floor that slopes, from many small windows around a motion that is known.

Over relief the windows that agree within a wide tolerance are of many depths. Smaller windows, more of them, each
searched for near its place only, resolve the relief; a robust fit then follows the depth that most windows around its
start have. Of which depth that is where there are several, see `surface`.

Height displaces what is seen along the line on which the camera has moved, the baseline, and never across it. So two
things hold that an ordinary fit does not know. A window may miss its place by the relief along the baseline, but only
by its own error across it: the fit's tolerance is an ellipse. And a floor that slopes adds a displacement

    u Re(conj(w) z)    of the window at z from the middle, u the baseline's direction,

which as a linear map is the rotation and scale u conj(w) / 2 and the shear g = u w / 2. A similarity alone would take
the first for a turn of the vehicle; here w is fitted beside it, with a prior: floors are level rather than steep, the
less so the longer the baseline is. The shear is also what a camera that does not look straight down shows, which
`applications.mosaic.level` sorts out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Complexes, Floats
from signum.geometry.similarity import Similarity

ACROSS = 1.0
"""Scale of the robust fit across the baseline, pixels of the board: a window's error is under 1."""
ALONG = 3.0
"""Scale along it: relief displaces by more."""
WIDE = 2.0
"""Factor on both that it begins with."""
ROUNDS = 12
"""Rounds with each scale."""
SLOPE = 0.4
"""Standard deviation of the floor's slope under an overlap, the picture's width standing for the focal length: a weak
prior, since it also holds back the lean of a vehicle."""
FLATTEST = 1e-4
"""Least standard deviation of a slope's displacement, pixels per pixel, where the camera has hardly moved."""
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
        similarity: p -> q, without what the slope adds.
        agree: bool (n,).
        rms_px: of the residuals of those, the slope taken out, pixels.
        shear: g, of the windows alone, without the prior; 0 where it is not determined.
        shear_error: standard error of its real and imaginary parts; infinite where it is not determined.
    """

    similarity: Similarity
    agree: NDArray[np.bool_]
    rms_px: float
    shear: complex
    shear_error: float


def refine(p: Floats, q: Floats, start: Similarity, pixel: float, size: tuple[int, int], along: float = ALONG,
           wide: float = WIDE, steep: float = SLOPE) -> Refined:
    """Fit a similarity and a slope.

    Args:
        p, q: (n, 2) centres and places of windows near where `start` puts them, pixels, n >= 2.
        start: about right.
        pixel: size of a pixel of the board, pixels.
        size: width and height of the pictures, pixels.
        along: scale along the baseline, pixels of the board.
        wide: factor on both scales that it begins with.
        steep: standard deviation of the slope; 0 for none.
    """
    a, b = np.asarray(p @ [1, 1j], np.complex128), np.asarray(q @ [1, 1j], np.complex128)
    middle = complex(a.mean())
    way, moved = baseline(start, ((size[0] - 1) / 2, (size[1] - 1) / 2))
    deviation = max(steep * moved / max(size), FLATTEST)
    # Real equations, in units of the scales: n along the baseline, n across it. Unknowns: translation, factor, slope.
    columns, seen = _equations(a - middle, b, way, along * pixel, ACROSS * pixel)
    prior = np.diag([0.0, 0.0, 0.0, 0.0, 1.0, 1.0]) * OVERLAPPING / deviation**2
    there = start.factor * middle + start.shift
    values = np.array([there.real, there.imag, start.factor.real, start.factor.imag, 0.0, 0.0])
    lever = np.array([1.0, 1.0, *[float(np.abs(a - middle).max())] * 4])
    for scale in (wide, 1.0):
        for _ in range(ROUNDS):
            off = (columns @ values - seen) / scale
            weight = np.tile(1 / (1 + off[: len(a)] ** 2 + off[len(a):] ** 2) ** 2, 2)
            step = _solve(columns, seen, weight, prior)
            change = float((np.abs(step - values) * lever).max())
            values = step
            if change < 0.01 * pixel:
                break
    off = columns @ values - seen
    agree = off[: len(a)] ** 2 + off[len(a):] ** 2 <= 1
    miss = pixel * np.hypot(along * off[: len(a)], ACROSS * off[len(a):])
    rms = float(np.sqrt(np.mean(miss[agree] ** 2))) if agree.any() else 0.0
    shear, error = 0j, math.inf
    if int(agree.sum()) >= LEAST and _wide(a[agree], pixel):
        slope = _solve(columns, seen, weight, np.zeros((6, 6)))[4:]
        shear, error = way * complex(*slope) / 2, _error(columns[np.tile(agree, 2)], off[np.tile(agree, 2)])
    factor = complex(values[2], values[3])
    return Refined(Similarity(factor, complex(values[0], values[1]) - factor * middle), agree, rms, shear, error)


def baseline(motion: Similarity, centre: tuple[float, float]) -> tuple[complex, float]:
    """The direction in which height displaces what a level camera sees in the second picture, 1 where there is none,
    and how far the centre of the pictures has moved, pixels."""
    shift = motion.factor * complex(*centre) + motion.shift - complex(*centre)
    return (shift / abs(shift), abs(shift)) if abs(shift) > 0 else (1 + 0j, 0.0)


def _equations(z: Complexes, b: Complexes, way: complex, along: float, across: float) -> tuple[Floats, Floats]:
    """What the unknowns multiply, (2 n, 6), and where windows were seen, (2 n,): components along the baseline, then
    across it, in units of the scales."""
    turn = way.conjugate()
    one, none = np.full_like(z, turn), np.zeros_like(z)
    columns = np.stack([one, 1j * one, turn * z, 1j * turn * z, z.real + none, z.imag + none], axis=1)
    return (np.concatenate([columns.real / along, columns.imag / across]),
            np.concatenate([(turn * b).real / along, (turn * b).imag / across]))


def _solve(columns: Floats, seen: Floats, weight: Floats, prior: Floats) -> Floats:
    weighted = columns.T * weight
    return np.asarray(np.linalg.lstsq(weighted @ columns + prior, weighted @ seen, rcond=None)[0], np.float64)


def _error(columns: Floats, off: Floats) -> float:
    """Standard error of each part of the shear, by the windows that agree."""
    count = len(off) / 2
    noise = max(float(np.mean(off**2)), 0.1) * count / (count - 3) * OVERLAPPING
    return math.sqrt(float(np.trace(np.linalg.pinv(columns.T @ columns)[4:, 4:])) / 2 * noise) / 2


def _wide(a: Complexes, pixel: float) -> bool:
    """Whether points lie apart in both directions, rather than along a line."""
    off = np.stack([a.real - a.real.mean(), a.imag - a.imag.mean()])
    return bool(np.linalg.eigvalsh(off @ off.T / len(a))[0] > (NARROWEST * pixel) ** 2)
