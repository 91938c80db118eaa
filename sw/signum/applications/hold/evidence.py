# SPDX-License-Identifier: Apache-2.0
"""Whether windows that agree on one similarity can be chance: the number of false alarms.

After Moisan, Moulon, Monasse, "Automatic Homographic Registration of a Pair of Images, with A Contrario Elimination of
Outliers", IPOL 2012. If a view shows nothing of the reference, a window's measurement is valid with some probability v,
and its place is then anywhere in the search range alike. Any m of n windows, two for a similarity, define a motion;
the expected number of motions from which k windows miss by at most r is

    (n - m) C(n, k) C(k, m) (v pi r^2 / area)^(k - m),

taken at the best k, whose r is the k-th smallest miss. So no tolerance is chosen: many loose windows are worth as much
as a few exact ones.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from signum.common.arrays import Floats

LEAST_MISS_PX = 1.0
"""Misses below this are taken for this, pixels: neighbouring places of a search are not independent."""


def log_false_alarms(misses: Floats, tried: int, area: float, valid: float = 1.0, share: float = 1.0,
                     least: int = 2) -> float:
    """Logarithm to base 10 of the number of false alarms; 0 where no more windows are found than define a
    motion.

    Args:
        misses: (m,) distances from a similarity of the windows that were found somewhere, pixels.
        tried: number of windows that were searched for, m or more.
        area: of the search range of a window, pixels^2.
        valid: probability that a window is found where it is not.
        share: of the windows that are independent, where they overlap.
        least: number of windows that define a motion.
    """
    n = max(tried, len(misses))
    if len(misses) <= least:
        return 0.0
    radius = np.maximum(np.sort(misses), LEAST_MISS_PX)
    k = np.arange(least + 1, len(misses) + 1)
    chance = np.log10(valid * np.minimum(math.pi * radius[least:]**2 / area, 1.0))
    logs = _log_factorials(n)
    choices = (logs[n] - logs[n - k] - logs[least] - logs[k - least]) / math.log(10)
    return float((math.log10(n - least) + choices + share * (k - least) * chance).min())


@lru_cache
def _log_factorials(n: int) -> Floats:
    """Natural logarithms of 0! to n!, (n + 1,). SciPy's would do, but takes a quarter of a second to load."""
    return np.array([math.lgamma(k + 1) for k in range(n + 1)])
