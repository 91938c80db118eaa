# SPDX-License-Identifier: Apache-2.0
"""\"Look at that\": where a chosen place of a mosaic is in each frame.

Every frame is measured against the mosaic itself, so errors do not accumulate. The frame before only centres the
search. After several frames that are not found, the whole mosaic is searched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.place import Place
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity

PATIENCE = 3
"""Frames not found before the whole mosaic is searched."""
NEAR = 0.35
"""Share of the frame's size, from its middle, within which a target is measured by the windows around it."""


@dataclass(frozen=True)
class Aim:
    """The target's position in a frame.

    Attributes:
        place: of the frame in the mosaic.
        error: (2,) from the middle of the frame to the target, original pixels; NaN where not known.
        sharp: whether it was measured around the target itself, rather than computed from the whole frame's place.
    """

    place: Place
    error: Floats
    sharp: bool

    @property
    def known(self) -> bool:
        """Whether the frame was found in the mosaic."""
        return self.place.known


class TargetFinder:
    """Finds each frame in the mosaic, and the target in the frame.

    Args:
        localiser: in the mosaic.
        target: pixels of mosaic.png; None where only the place is needed.
        patience: frames not found near the last place before the whole mosaic is searched.
    """

    def __init__(self, localiser: Localiser, target: tuple[float, float] | None, patience: int = PATIENCE) -> None:
        self.localiser, self.target, self.patience = localiser, target, patience
        self._last: Similarity | None = None
        self.missed = 0

    def forget(self) -> None:
        """Search the whole mosaic for the next frame."""
        self._last = None

    def look(self, picture: Image) -> Aim:
        """Find a frame, and the target in it."""
        place = Place()
        if self._last is not None:
            place = self.localiser.locate(picture, self._last)
        if not place.known and (self._last is None or self.missed >= self.patience):
            place = self.localiser.locate(picture)
        if place.similarity is None:
            self.missed += 1
            if self.missed > self.patience:
                self._last = None
            return Aim(place, np.full(2, np.nan), False)
        self.missed, self._last = 0, place.similarity
        if self.target is None:
            return Aim(place, np.full(2, np.nan), False)
        size = np.array(self.localiser.shown.source, np.float64)
        at = place.similarity.inverse(np.array(self.target, np.float64))
        sharp = None
        if (np.abs(at - (size - 1) / 2) <= NEAR * size).all():
            sharp = self.localiser.pinpoint(picture, place.similarity, self.target)
        return Aim(place, (at if sharp is None else sharp) - (size - 1) / 2, sharp is not None)
