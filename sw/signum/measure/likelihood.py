# SPDX-License-Identifier: Apache-2.0
"""How much more likely it is that windows agree on a motion because it is right than by chance.

A window that shows something else passes the checks of a measurement now and then, and then lies anywhere in its search
range. So by chance a window agrees with a given motion with probability

    p = VALID_BY_CHANCE * (area of the tolerance) / (area of the search),

and with a right one with probability RIGHT or more, since relief and perspective displace the others. The evidence is
the logarithm of the ratio of the two binomial likelihoods, less that of the number of motions which could have been
chosen. Windows that overlap are no independent witnesses: what counts is the area that they cover, in windows.
"""

from __future__ import annotations

import math

import numpy as np

from signum.common.arrays import Floats

VALID_BY_CHANCE = 0.15
"""Share of windows that pass the checks though they see something else, at most: 0.01 to 0.15 of strangers, of gravel,
grass, brick and mirrored seabed, over searches of +-18 to +-50 pixels."""
RIGHT = 0.3
"""Least share of the windows that agree with a right motion."""
CELLS = 4
"""Cells a window's side is divided into when areas are counted."""


def covered(centres: Floats, window: float) -> float:
    """Area that windows cover, in windows.

    Args:
        centres: (n, 2) pixels.
        window: their side, pixels.
    """
    if not len(centres):
        return 0.0
    cell = window / CELLS
    corner = np.rint((centres - centres.min(axis=0)) / cell).astype(np.int64)
    seen = np.zeros((corner + CELLS).max(axis=0), bool)
    for x, y in corner.tolist():
        seen[x:x + CELLS, y:y + CELLS] = True
    return float(seen.sum()) / CELLS**2


def chance(tolerance: float, reach: float) -> float:
    """Probability that a window that sees something else agrees with a given motion.

    Args:
        tolerance: distance up to which a window agrees, pixels.
        reach: half side of its search range, pixels.
    """
    return VALID_BY_CHANCE * min(1.0, math.pi * tolerance**2 / (2 * reach + 1) ** 2)


def ratio(agreed: float, tried: float, probability: float) -> float:
    """Decimal logarithm of how much better a right motion explains it than chance, that `agreed` of `tried` independent
    windows agree."""
    return (agreed * math.log10(RIGHT / probability)
            + max(0.0, tried - agreed) * math.log10((1 - RIGHT) / (1 - probability)))


def evidence(agreeing: Floats, tried: Floats, window: float, probability: float, chosen: bool = True) -> float:
    """Evidence, in decades, that the windows agree for another reason than chance.

    Args:
        agreeing: (k, 2) centres of the agreeing windows, pixels.
        tried: (n, 2) of all that should agree.
        window: their side, pixels.
        probability: of `chance`.
        chosen: whether the motion was chosen so that these windows agree: then two of them prove nothing, and any two
            could have been those.
    """
    k, n = len(agreeing), len(tried)
    if k == 0 or (chosen and k <= 2):
        return 0.0 if k else ratio(0.0, covered(tried, window), probability)
    areas = covered(agreeing, window), covered(tried, window)
    if not chosen:
        return ratio(*areas, probability)
    choices = max(1.0, areas[1] * (areas[1] - 1) / 2)
    return ratio(areas[0] * (k - 2) / k, areas[1] * (n - 2) / n, probability) - math.log10(choices)
