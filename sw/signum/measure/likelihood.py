# SPDX-License-Identifier: Apache-2.0
"""How much more likely it is that windows agree on a motion because it is right than by chance.

A window that shows something else passes the checks of a measurement now and then, and then lies anywhere in its search
range. So by chance a window agrees with a given motion with probability

    p = VALID_BY_CHANCE * (area of the tolerance) / (area of the search),

and with a right one with probability RIGHT or more, since relief and perspective displace the others. The evidence is
the logarithm of the ratio of the two binomial likelihoods, less that of the number of motions which could have been
chosen. Windows that overlap are no independent witnesses: what counts is the area that they cover, in windows.

Two things more tell a right motion from chance. The peaks of windows that see the same thing exceed chance by more
(`doubt`). And small windows searched for close to where the motion has them agree nearly all if it is right, but not
many more than cover the agreeing windows if it is not (`nearby`).
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
CLEARLY, A_DEVIATION, MOST_DOUBT = 5.6, 0.7, 0.7
"""Standard deviations by which a peak exceeds chance from which it is not doubted; decades of doubt for each that is
missing, and the most. Half of the strangers that pass the checks exceed chance by 4.8, one in twenty by 6, one in a
hundred by 7.3; of windows of 48 pixels that see the same thing 95 in a hundred by 6.9 or more, in murky water, too."""
WEAK, STRONG = 10.0, 15.0
"""Standard deviations by which a perfect match exceeds chance: up to the first, as of small windows under a wide
filter, right peaks are as low as those of strangers, and none is doubted; from the second on every low one is."""
NEARBY_RIGHT, NEARBY_WRONG = 0.75, 0.3
"""Share of small windows that agree with a right motion; with one on which a quarter to a half of the windows before
agreed by chance, whose pixels agree again: 0.15 to 0.45 were measured."""
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


def ratio(agreed: float, tried: float, probability: float, right: float = RIGHT) -> float:
    """Decimal logarithm of how much better a right motion explains it than chance, that `agreed` of `tried` independent
    windows agree: of a right one the share `right`, by chance `probability`, which is less."""
    return (agreed * math.log10(right / probability)
            + max(0.0, tried - agreed) * math.log10((1 - right) / (1 - probability)))


def doubt(agreeing: Floats, window: float, above_chance: Floats, perfect: float) -> float:
    """Decades to be taken from the evidence of windows whose peaks are as low as those of strangers, 0 or more.

    Args:
        agreeing: (k, 2) their centres, pixels.
        window: their side, pixels.
        above_chance: (k,) by how many standard deviations their peaks exceed chance; finite.
        perfect: the same of a perfect match.
    """
    if not len(agreeing):
        return 0.0
    told = min(1.0, max(0.0, (perfect - WEAK) / (STRONG - WEAK)))
    low = np.clip(A_DEVIATION * (CLEARLY - above_chance), 0.0, MOST_DOUBT)
    return told * float(low.mean()) * covered(agreeing, window)


def nearby(agreeing: Floats, tried: Floats, window: float) -> float:
    """Evidence of small windows close to where a motion has them, in decades; below 0 if too few agree.

    Args:
        agreeing: (k, 2) centres of the agreeing windows, pixels.
        tried: (n, 2) of all.
        window: their side, pixels.
    """
    if not len(tried):
        return 0.0
    # They overlap by half: those that agree here and there would cover nearly all.
    independent = covered(tried, window)
    return ratio(len(agreeing) / len(tried) * independent, independent, NEARBY_WRONG, NEARBY_RIGHT)


def evidence(agreeing: Floats, tried: Floats, window: float, probability: float) -> float:
    """Evidence, in decades, that windows agree for another reason than chance.

    The motion was chosen so that they agree: two of them prove nothing, and any two could have been those.

    Args:
        agreeing: (k, 2) centres of the agreeing windows, pixels.
        tried: (n, 2) of all that should agree.
        window: their side, pixels.
        probability: of `chance`.
    """
    k, n = len(agreeing), len(tried)
    if k <= 2:
        return ratio(0.0, covered(tried, window), probability)
    areas = covered(agreeing, window), covered(tried, window)
    choices = max(1.0, areas[1] * (areas[1] - 1) / 2)
    return ratio(areas[0] * (k - 2) / k, areas[1] * (n - 2) / n, probability) - math.log10(choices)
