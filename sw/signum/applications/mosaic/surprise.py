# SPDX-License-Identifier: Apache-2.0
"""How likely an edge is, by its windows and by where the poses predict it.

The evidence of the windows against chance (`measure.likelihood`) is changed by the prediction: a chance match lies
anywhere in the search, a right one near its place, as the poses' uncertainty and the relief allow. One in a hundred
predictions is worth nothing, so that strong evidence of the windows stands against a prediction; which of them is wrong
is then for the graph to tell.
"""

from __future__ import annotations

import math

import numpy as np

from signum.geometry.similarity import Similarity

ASTRAY = 0.01
"""Share of predictions that are worth nothing."""
TWIST_DEG = 2.5
"""Standard deviation of a predicted rotation, degrees: tilt and relief."""
MOST_TURN_DEG = 15.0
"""Rotations by chance lie within this."""


def surprise(found: Similarity, predicted: Similarity, at: tuple[float, float], deviation: float, reach: float
             ) -> float:
    """Decimal logarithm of how much more likely a motion is as a right one than by chance, by its place alone.

    Args:
        found: pixels of a -> b, as measured.
        predicted: the same, by the poses.
        at: middle of its windows, pixels of a.
        deviation: standard deviation of the predicted place, each axis, pixels of b.
        reach: half side of the search, pixels of b.
    """
    point = np.array(at)
    miss = float(np.hypot(*(found(point) - predicted(point))))
    twist = (found @ predicted.inverse).rot_deg
    near = math.exp(-((miss / deviation) ** 2) / 2) * (2 * reach) ** 2 / (2 * math.pi * deviation**2)
    turned = math.exp(-((twist / TWIST_DEG) ** 2) / 2) * 2 * MOST_TURN_DEG / (math.sqrt(2 * math.pi) * TWIST_DEG)
    return math.log10((1 - ASTRAY) * near * turned + ASTRAY)
