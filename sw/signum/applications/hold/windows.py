# SPDX-License-Identifier: Apache-2.0
"""Windows of one size in a warped reference view."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.measure.measurer import View

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows of one size in a warped reference view.

    Attributes:
        view: on the board.
        onto: homography (3, 3) from the reference's pixels to the view's.
        side: of the windows, pixels.
        centres: (n, 2) int.
        anchors: (n, 2) level pixels of the reference that they show.
        share: of the windows that are independent, as they overlap where few fit.
    """

    view: View
    onto: Floats
    side: int
    centres: Integers
    anchors: Floats
    share: float

    def some(self, which: NDArray[np.intp]) -> Windows:
        """Those of these numbers."""
        return replace(self, centres=self.centres[which], anchors=self.anchors[which])

    def first(self, count: int) -> Windows:
        """The first `count` of them only; they are spread over what is in sight."""
        return replace(self, centres=self.centres[:count], anchors=self.anchors[:count])
