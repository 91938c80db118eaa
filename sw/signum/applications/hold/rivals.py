# SPDX-License-Identifier: Apache-2.0
"""Other places of a reference that look like it: what a wrong place of such a floor scores, and where it lies."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from signum.applications.hold.windows import Windows
from signum.common.arrays import Floats
from signum.measure.measurer import Measurer, Query
from signum.measure.register import ANYTHING
from signum.measure.validity import Rules

LEAST_PASSING = 0.01
"""Lower bound of the probability of a score elsewhere: no more than a hundred places of a reference are tried."""
LEAST_DEVIATION = 0.01
"""Lower bound of the deviation of scores elsewhere: that of a few windows may be small by chance."""
TWINS = 8
"""Number of places that are kept where a reference looks most like itself."""
LEAST_COMMON = 0.25
"""Least share of the windows that must lie in the picture at such a place."""


class Rivals(NamedTuple):
    """What the reference's own windows score at other places of it: what a wrong place of such a floor scores.

    Attributes:
        valid: share of the windows whose measurement there is valid.
        mean: over the windows, of the best score of each; deviation: their standard deviation.
    """

    valid: float
    mean: float
    deviation: float

    def passing(self, score: float) -> float:
        """Probability that a window's measurement elsewhere is valid and scores as well, as far as these show."""
        deviations = (score - self.mean) / self.deviation
        return self.valid * max(LEAST_PASSING, 0.5 * math.erfc(deviations / math.sqrt(2)))

    def exceeded_by(self, scores: Floats, share: float, deviations: float) -> bool:
        """Whether scores (n,) of windows at one place, a share of them independent, exceed these by as many standard
        errors of their mean."""
        return bool(scores.mean() - self.mean > deviations * self.deviation / math.sqrt(share * len(scores)))


def measure_rivals(measurer: Measurer, windows: Windows, rules: Rules) -> Rivals:
    """Each window is searched for around itself, left, right, above and below, half a window off and more."""
    side, view = windows.side, windows.view
    reach = side // 2
    answers = measurer.measure([Query(view, view, x, y, side, side, (dx, dy), (reach, reach))
                                for x, y in windows.centres.tolist()
                                for dx, dy in ((side, 0), (-side, 0), (0, side), (0, -side))], rules)
    valid = (1 + sum(m.valid for m in answers)) / (2 + len(answers))
    best = np.array([m.score for m in answers]).reshape(-1, 4).max(axis=1, initial=0.5)
    return Rivals(valid, float(best.mean()) if best.size else 0.5,
                  max(float(best.std()), LEAST_DEVIATION) if best.size else LEAST_DEVIATION)


def twin_reach(side: int) -> int:
    """Half side of the cell around a place to which a window may be displaced there, pixels: places that differ by a
    few degrees or percent besides are the same."""
    return side // 4


def measure_twins(measurer: Measurer, windows: Windows) -> Floats:
    """The displacements (k, 2), pixels, at which the windows of a reference together match it best, their own places
    aside."""
    side, view, reach = windows.side, windows.view, twin_reach(windows.side)
    pitch = 2 * reach + 1
    if not len(windows.centres):
        return np.zeros((0, 2))
    across, down = (n // 2 // pitch + 1 for n in measurer.size)
    cells = np.stack(np.meshgrid(np.arange(-across, across + 1), np.arange(-down, down + 1)), axis=-1).reshape(-1, 2)
    cells = pitch * cells[(cells != 0).any(axis=1)]
    there = windows.centres + cells[:, None, :]
    inside = ((there >= side // 2) & (there <= np.array(measurer.size) - (side - side // 2))).all(axis=2)
    often = inside.sum(axis=1) >= max(3.0, LEAST_COMMON * len(windows.centres))
    which = np.argwhere(inside & often[:, None])
    answers = measurer.measure([Query(view, view, int(windows.centres[i, 0]), int(windows.centres[i, 1]), side, side,
                                      (float(cells[c, 0]), float(cells[c, 1])), (reach, reach))
                                for c, i in which.tolist()], ANYTHING)
    total = np.zeros(len(cells))
    np.add.at(total, which[:, 0], [m.score for m in answers])
    mean = np.where(often, total / np.maximum(inside.sum(axis=1), 1), 0.0)
    best = np.argsort(-mean, kind="stable")[:TWINS]
    return np.asarray(cells[best[often[best]]], np.float64)


def enough(seen: int, windows: int) -> bool:
    """Whether as many windows, of those that agree on a place, are in view at another one to compare the two."""
    return seen >= max(3.0, LEAST_COMMON * windows)


def beats(scores: Floats, others: Floats, share: float, deviations: float) -> bool:
    """Whether windows match better at one place than at others.

    Args:
        scores: (n,) at the one place.
        others: (k, n) of the same windows at each other place, nan where one is not in view; a place with too few in
            view does not count.
        share: of the windows that are independent.
        deviations: standard errors of the mean difference by which each other place must be exceeded.
    """
    for row in others:
        known = np.isfinite(row)
        if not enough(int(known.sum()), len(scores)):
            continue
        more = scores[known] - row[known]
        spread = max(float(more.std()), LEAST_DEVIATION)
        if more.mean() <= deviations * spread / math.sqrt(share * len(more)):
            return False
    return True
