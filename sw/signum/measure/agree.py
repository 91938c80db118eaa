# SPDX-License-Identifier: Apache-2.0
"""The motions that measured windows agree on: the best borne out, and others that what is left of them agrees on.

Over relief, windows of a right pair lie apart by more than they are measured wrong: with a wide tolerance they all
agree, on a motion that is a compromise of depths. So several tolerances are tried, and the one with most evidence
against chance is taken: the narrower it is, the more each agreeing window proves (an a-contrario RANSAC, after Moisan
and Stival, IJCV 2004). Where a view shows several depths, each has a motion of its own, and which of them is the
floor's the windows cannot tell: all are returned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity, fit, vote
from signum.measure.likelihood import chance, doubt, evidence

TOLERANCES = (0.03, 0.05, 0.08)
"""Shares of a window's side by which an agreeing window may miss its place; the last is the widest."""
MOST_RIVALS = 2
"""Most motions beside the best."""


@dataclass(frozen=True)
class Found:
    """Windows and where they were found.

    Attributes:
        p: (n, 2) centres of the valid ones, pixels of the pictures.
        q: (n, 2) where they were found.
        at: (n, 2) their centres, pixels of the board.
        above: (n,) by how many standard deviations their peaks exceed chance.
        perfect: the same of a perfect match.
        tried: (m, 2) centres of all that should be found.
        window: side, pixels of the board.
        reach: half side of the search ranges, the same.
        factor: pixels of the pictures per pixel of the board.
    """

    p: Floats
    q: Floats
    at: Floats
    above: Floats
    perfect: float
    tried: Floats
    window: int
    reach: int
    factor: float


@dataclass(frozen=True)
class Motion:
    """A similarity that windows agree on.

    Attributes:
        similarity: p -> q.
        agree: bool (n,).
        rms_px: of their residuals, pixels of the pictures.
        turning: whether rotation and scale were measured.
        evidence: that they agree for another reason than chance, decades.
    """

    similarity: Similarity
    agree: NDArray[np.bool_]
    rms_px: float
    turning: bool
    evidence: float


def motions(found: Found, rot_deg: float, zoom: float, least: float) -> list[Motion]:
    """The motion with most evidence, then those that the other windows agree on; none where fewer than two are left.

    Args:
        found: two or more windows.
        rot_deg, zoom: largest rotation and scale.
        least: evidence that a further motion needs, decades.
    """
    left = np.ones(len(found.p), bool)
    out: list[Motion] = []
    widest = 2 * TOLERANCES[-1] * found.window * found.factor
    while left.sum() >= 2 and len(out) <= MOST_RIVALS:
        best = max((_motion(found, left, share, rot_deg, zoom) for share in TOLERANCES), key=lambda m: m.evidence)
        if out and best.evidence < least:
            break
        out.append(best)
        left &= np.hypot(*(best.similarity(found.p) - found.q).T) > widest
    return out


def _motion(found: Found, left: NDArray[np.bool_], share: float, rot_deg: float, zoom: float) -> Motion:
    """What most of the windows that are left agree on within a share of their side."""
    tolerance = share * found.window
    miss = tolerance * found.factor
    p, q = found.p[left], found.q[left]
    start, _ = vote(p, q, miss, rot_deg, zoom, 0.75 * found.window * found.factor)
    result = fit(p, q, start, miss)
    agree = np.zeros(len(left), bool)
    agree[left] = result.agree
    proof = (evidence(found.at[agree], found.tried, found.window, chance(tolerance, found.reach))
             - doubt(found.at[agree], found.window, found.above[agree], found.perfect))
    return Motion(result.similarity, agree, result.rms_px, result.turning, proof)
