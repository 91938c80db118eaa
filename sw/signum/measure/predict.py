# SPDX-License-Identifier: Apache-2.0
"""How far to search around a predicted displacement: a reach that follows the prediction errors so far."""

from __future__ import annotations

import numpy as np

from signum.common.arrays import Floats


class SearchPredictor:
    """The reach of the search for a group of windows that move with one picture, pixels.

    The reach is `floor` plus three times the 90th percentile of the last prediction errors, within `floor`..`widest`.
    It starts at the widest, returns to it after a frame in which less than half of the windows were found, and shrinks
    to no less than half from one frame to the next.
    """

    def __init__(self, floor: int = 6, widest: int = 32) -> None:
        if not 1 <= floor <= widest:
            raise ValueError("1 <= floor <= widest")
        self.floor, self.widest = floor, widest
        self.reach = widest

    def learn(self, errors: Floats, wanted: int) -> None:
        """Update the reach from the distances between found and predicted displacements.

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
