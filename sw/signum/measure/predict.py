"""Where to search next: constant velocity, and a reach that follows how well that has worked so far."""

from __future__ import annotations

import numpy as np

from signum.common.arrays import Floats


class SearchPredictor:
    """Predicts the search of a group of windows that move with one picture, pixels.

    The reach is `floor` plus three times the smoothed typical prediction error, within `floor`..`widest`; it starts at
    the widest, is the widest again after a frame in which less than half of the windows were found, and shrinks by at
    most half a frame.
    """

    def __init__(self, floor: int = 6, widest: int = 32) -> None:
        if not 1 <= floor <= widest:
            raise ValueError("1 <= floor <= widest")
        self.floor, self.widest = floor, widest
        self.reach = widest

    def learn(self, errors: Floats, wanted: int) -> None:
        """Take in how far the found displacements were from the predicted ones.

        Args:
            errors: (n,) distances of the valid ones, pixels.
            wanted: how many windows were searched for.
        """
        if 2 * len(errors) < wanted or not len(errors):
            self.reach = self.widest
            return
        typical = float(np.percentile(errors, 90))
        need = int(np.ceil(self.floor + 3 * typical))
        self.reach = int(np.clip(max(need, self.reach // 2), self.floor, self.widest))
