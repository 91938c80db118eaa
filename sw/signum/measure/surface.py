# SPDX-License-Identifier: Apache-2.0
"""The motion of the surface that most of an overlap shows, where relief has steps.

Over boulders, ridges and plants the windows of an overlap lie at many depths, and no plane is near most of them. A
robust fit that starts from their middle then stops between two depths, in each pair elsewhere, and poses that many
pairs share contradict each other. Here the fit starts from the motion that most windows are close to, as RANSAC finds
it (Fischler and Bolles, CACM 1981), scored by how close they are as in MSAC (Torr and Zisserman, CVIU 2000): that of
the depth which most of the overlap has, and most of the neighbouring overlaps with it.

A slope beside it (`refine`) is taken out only where the sloping plane explains most of what relief displaces. On a
floor of steps it would follow two of them, and turn the pair.
"""

from __future__ import annotations

import numpy as np

from signum.common.arrays import Complexes, Floats
from signum.geometry.similarity import Similarity
from signum.measure.refine import ACROSS, Refined, baseline, refine

CLOSE = 1.75
"""Scale of the fit, along the baseline as across it, pixels of the board: one depth."""
TRIES = 500
"""Pairs of windows of which each gives a motion."""
APART = 0.5
"""Least distance of the two, of the windows' root-mean-square distance from their middle."""
JUDGES = 4
"""Of so many windows one judges them."""
KEPT = 8
"""The best of these, each of which is then fitted to the windows close to it."""
ROUNDS = 10
"""Rounds of that fit."""
BORNE_OUT = 0.67
"""Share of the windows that relief may have displaced, above which a sloping plane explains them; and of all windows,
above which no other motion can have as many."""


def settle(p: Floats, q: Floats, about: Similarity, pixel: float, size: tuple[int, int]) -> tuple[Refined, bool]:
    """Fit a similarity to the surface that most windows show, and a slope where they bear one out.

    Args:
        p, q: (n, 2) centres and places of windows, pixels, n >= 2.
        about: a motion near which the windows were searched for.
        pixel: size of a pixel of the board, pixels.
        size: width and height of the pictures, pixels.

    Returns:
        The fit, and whether a slope was taken out of it.
    """
    met = np.linalg.norm(about(p) - q, axis=1) < CLOSE * pixel
    start = about if met.mean() > BORNE_OUT else densest(p, q, about, CLOSE * pixel)
    sloping = refine(p, q, start, pixel, size, CLOSE, 1.0)
    if sloping.agree.mean() > BORNE_OUT:
        return sloping, True
    flat = refine(p, q, start, pixel, size, CLOSE, 1.0, 0.0)
    way, _ = baseline(flat.similarity, ((size[0] - 1) / 2, (size[1] - 1) / 2))
    off = (flat.similarity(p) - q) @ np.array([1, 1j]) * way.conjugate() / pixel
    displaced = (np.abs(off.imag) <= CLOSE * ACROSS) | sloping.agree
    if sloping.agree.sum() > BORNE_OUT * displaced.sum():
        return sloping, True
    return flat, False


def densest(p: Floats, q: Floats, about: Similarity, close: float) -> Similarity:
    """The similarity that most windows are close to.

    Args:
        p, q: (n, 2) centres and places of windows, pixels, n >= 2; centres differ.
        about: one of those that are tried; the others are of two windows each, the same in every run.
        close: scale of closeness, pixels.
    """
    a, b = np.asarray(p @ [1, 1j], np.complex128), np.asarray(q @ [1, 1j], np.complex128)
    i, j = np.random.default_rng(len(a)).integers(len(a), size=(2, TRIES))
    far = np.abs(a[i] - a[j]) > APART * np.sqrt(np.mean(np.abs(a - a.mean()) ** 2))
    i, j = i[far], j[far]
    tried = (b[i] - b[j]) / (a[i] - a[j])
    factors = np.append(tried, about.factor)
    shifts = np.append(b[i] - tried * a[i], about.shift)
    near = _weights(factors[:, None], shifts[:, None], a[::JUDGES], b[::JUDGES], close).sum(axis=1)
    best = np.argsort(-near, kind="stable")[:KEPT, None]
    factor, shift = factors[best], shifts[best]
    for _ in range(ROUNDS):
        weight = _weights(factor, shift, a, b, close) ** 2
        weight /= weight.sum(axis=1, keepdims=True)
        here, there = ((weight * of).sum(axis=1, keepdims=True) for of in (a, b))
        apart = a - here
        factor = ((weight * apart.conj() * (b - there)).sum(axis=1, keepdims=True)
                  / (weight * (apart.real**2 + apart.imag**2)).sum(axis=1, keepdims=True))
        shift = there - factor * here
    first = int(np.argmax(_weights(factor, shift, a, b, close).sum(axis=1)))
    return Similarity(complex(factor[first, 0]), complex(shift[first, 0]))


def _weights(factor: Complexes, shift: Complexes, a: Complexes, b: Complexes, close: float) -> Floats:
    """How close each motion, (k, 1), brings each window, (k, n): 1 if it meets its place, a half `close` from it."""
    off = factor * a
    off += shift
    off -= b
    return np.asarray(1 / (1 + (off.real**2 + off.imag**2) / close**2), np.float64)
