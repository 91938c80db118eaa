# SPDX-License-Identifier: Apache-2.0
"""Optical flow at every n-th pixel, by the dense engine.

A pass of the engine searches one row of displacements; the best of the rows is found here, and its position to a
fraction of a pixel from three mismatches in its row and in those above and below. The second frame's windows must lead
back. The windows overlap much: `consensus` takes from each neighbourhood what its windows agree on.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from signum.measure.consensus import ConsensusRules, agree_around
from signum.measure.flow import LONELY, FlowField
from signum.measure.measurer import Measurer, View
from signum.measure.validity import Reason
from signum.measure.winners import search_places, search_winners

Flags = NDArray[np.bool_]
STRIDES = 4
"""Of a neighbourhood, places a quarter of a window apart are looked at: those between have nearly the same windows."""


@dataclass(frozen=True)
class DenseFlowRules:
    """What makes the displacement of a window valid. Scores are matching fractions.

    Attributes:
        min_score: least score of a measurement that counts.
        most_lean: largest shift of the best from its row to the next, pixels: along an edge it moves, but a best
            place further away is another one.
        sure_score: least score of measurements that are not overruled.
        sure_margin: least distance of such a score from the rest.
        neighbourhood: how far the windows around a place are asked, windows.
        consensus: how they agree.
    """

    min_score: float = 0.6
    most_lean: int = 3
    sure_score: float = 0.7
    sure_margin: float = 0.07
    neighbourhood: float = 1.5
    consensus: ConsensusRules = field(default_factory=ConsensusRules)


def measure_dense_flow(measurer: Measurer, before: View, after: View, window: int = 32, step: int = 4,
                       reach: tuple[int, int] = (16, 16), guess: tuple[float, float] = (0.0, 0.0),
                       rules: DenseFlowRules | None = None) -> FlowField:
    """Measure the flow between two views.

    Args:
        measurer: took both views, on a board with the dense engine.
        before: the earlier view.
        after: the later one.
        window: side of the windows, pixels.
        step: pixels from one window to the next, across and down.
        reach: search range around `guess`, across and down, pixels.
        guess: expected displacement, pixels.
        rules: what makes a displacement valid.

    Returns:
        The field, at the middles of the windows that lie in the first frame.

    Raises:
        ValueError: if no window fits the picture, `reach` is negative, or no engine has such windows.
        BoardError: if the board has no dense engine, or not of this window.
    """
    rules = rules or DenseFlowRules()
    if window > min(measurer.size):
        raise ValueError(f"no window of {window}x{window} fits a picture of {measurer.size[0]}x{measurer.size[1]}")
    if min(reach) < 0:
        raise ValueError(f"reach is {reach}: must be 0 or more, across and down")
    (left, right), (up, down) = ((round(at) - far, round(at) + far) for at, far in zip(guess, reach, strict=True))
    found = search_winners(measurer, (before, after), window, (left, right), (up, down), step)
    back = search_places(measurer, (after, before), window, (-right, -left), (-down, -up))
    area = float(window**2)
    known = found.whole & (np.abs(found.lean) <= rules.most_lean).all(0)
    score = np.where(found.found, 1 - found.best / area, 0.0)
    margin = np.where(found.found, (np.minimum(found.rest, area) - found.best) / area, 0.0)
    reasons = {Reason.OUTSIDE: ~found.found, Reason.SCORE: score < rules.min_score, Reason.BORDER: ~known,
               Reason.RETURN: ~found.agreeing(back)}
    measured = ~np.any(list(reasons.values()), axis=0)
    sure = measured & (score >= rules.sure_score) & (margin >= rules.sure_margin)
    dx, dy = found.fine(known, area)
    first = -(-(window - 1) // step)  # the first window that lies in the picture
    inner = slice(first, None), slice(first, None)
    away = max(1, round(rules.neighbourhood * window / step))
    stride = max(1, window // STRIDES // step)
    valid, u, v = agree_around(dx[inner], dy[inner], measured[inner], sure[inner], away, stride, rules.consensus)
    y, x = ((np.arange(first, size) * step - window // 2 + 1).astype(np.float64) for size in dx.shape)
    return FlowField(x, y, np.where(valid, u, np.nan), np.where(valid, v, np.nan), score[inner],
                     _refused({str(reason): bad[inner] for reason, bad in reasons.items()}, valid))


def _refused(reasons: dict[str, Flags], valid: Flags) -> dict[str, int]:
    """Places that are not valid, by the first reason."""
    left, counts = ~valid, {}
    for reason, bad in {**reasons, LONELY: ~valid}.items():
        counts[reason] = int((left & bad).sum())
        left = left & ~bad
    return {reason: count for reason, count in counts.items() if count}
