# SPDX-License-Identifier: Apache-2.0
"""Where the surroundings of the target's last position are in the next frame, by whatever the board searches with."""

from __future__ import annotations

import numpy as np

from signum.measure.measurer import Measurer, Query, View
from signum.measure.validity import Rules
from signum.measure.winners import search_winners

TEMPLATE_RULES = Rules(min_score=0.66, min_margin=0.04, texture=False)
"""Rules of the search."""
TEMPLATE_PX = 48
"""Side of the template, pixels; on a board with the dense engine its largest window."""
TEMPLATE_REACH = 20
"""Half side of the search range, pixels."""
STEP = 4
"""Pixels between the windows of the dense engine, of which the nearest is taken."""


def find_template(measurer: Measurer, views: tuple[View, View], at: tuple[float, float], to: tuple[float, float]
                  ) -> tuple[float, float] | None:
    """The displacement of what is around a place.

    Args:
        measurer: took both views.
        views: the frame with the template, and the next one.
        at: the place in the first, pixels.
        to: where it is expected in the second.

    Returns:
        Pixels right and down; None where the search finds nothing that counts.
    """
    if measurer.dense_windows:
        return _by_engine(measurer, views, at, to)
    u, v = round(at[0]), round(at[1])
    found = measurer.measure([Query(*views, u, v, TEMPLATE_PX, TEMPLATE_PX, (to[0] - u, to[1] - v),
                                    (TEMPLATE_REACH, TEMPLATE_REACH))], TEMPLATE_RULES)[0]
    return (found.dx_px, found.dy_px) if found.valid else None


def _by_engine(measurer: Measurer, views: tuple[View, View], at: tuple[float, float], to: tuple[float, float]
               ) -> tuple[float, float] | None:
    side = measurer.dense_windows[0]
    across, down = ((round(b - a) - TEMPLATE_REACH, round(b - a) + TEMPLATE_REACH) for a, b in zip(at, to, strict=True))
    found = search_winners(measurer, views, side, across, down, STEP)
    i, j = (round((place + side // 2 - 1) / STEP) for place in at)
    if not (j < found.found.shape[0] and i < found.found.shape[1] and found.found[j, i]):
        return None
    area = float(side**2)
    best, rest = float(found.best[j, i]), min(float(found.rest[j, i]), area)
    if 1 - best / area < TEMPLATE_RULES.min_score or (rest - best) / area < TEMPLATE_RULES.min_margin:
        return None
    here = np.zeros_like(found.found)
    here[j, i] = found.whole[j, i]
    dx, dy = found.fine(here, area)
    return float(dx[j, i]), float(dy[j, i])
