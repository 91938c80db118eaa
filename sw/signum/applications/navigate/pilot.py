"""\"Look at that\": a chosen place of a mosaic is brought to the middle of the picture and kept there.

Every frame is measured against the mosaic itself: nothing is added up, so nothing drifts, however long it takes. What
is known of the frame before only says where to look. A frame that is not found stops the motion; after a few of them
the mosaic is searched from one end to the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.applications.navigate.localise import Localiser, Place
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity

PATIENCE = 3
"""Frames not found before everything is searched."""
NEAR = 0.35
"""Share of the frame's size within which a place is aimed at by the windows about it."""
BACKTRACK = 6
"""Frames not found in any way after which the last motion is undone."""


@dataclass(frozen=True)
class Aim:
    """What is known of the target in a frame.

    Attributes:
        place: where the frame is.
        error: (2,) from the middle of the frame to the target, original pixels; NaN where nothing is known.
        sharp: whether it was measured about the target itself, rather than told by the whole frame's place.
    """

    place: Place
    error: Floats
    sharp: bool

    @property
    def known(self) -> bool:
        """Whether there is an error to steer by."""
        return self.place.known


class Pilot:
    """Says, frame by frame, where the camera looks, and where the target is.

    Args:
        localiser: in the mosaic.
        target: pixels of mosaic.png; None where only the place is wanted.
        patience: frames not found near the last place before everything is searched.
    """

    def __init__(self, localiser: Localiser, target: tuple[float, float] | None, patience: int = PATIENCE) -> None:
        self.localiser, self.target, self.patience = localiser, target, patience
        self._last: Similarity | None = None
        self.missed = 0

    def forget(self) -> None:
        """Search everywhere next time."""
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


@dataclass
class PanTiltSteering:
    """Rates of a pan/tilt that bring the target to the middle of the picture.

    Proportional control of an integrator seen once a frame: with `gain` times the frame's time of a fifth to a third
    the error falls to 1 % within 15 frames without overshoot. Rates are limited so that the picture moves by no more
    than `stride` pixels from frame to frame, which the search can follow.

    Attributes:
        focal: pixels of the original frame.
        gain: per second.
        stride: original pixels a frame.
    """

    focal: float
    gain: float = 2.5
    stride: float = 12.0
    _blind: int = 0
    _went: tuple[float, float] = (0.0, 0.0)

    def rates(self, aim: Aim, dt: float) -> tuple[float, float]:
        """(pan to the right, tilt up), radians per second, for the frame just seen; `dt` seconds between frames."""
        most = self.stride / self.focal / dt
        if not aim.known:
            self._blind += 1
            if self._blind <= BACKTRACK:
                return 0.0, 0.0
            back = max(abs(self._went[0]), abs(self._went[1]), 1e-9)
            return -self._went[0] / back * most / 2, -self._went[1] / back * most / 2
        self._blind = 0
        wanted = self.gain * aim.error / self.focal * (1.0, -1.0)
        wanted = wanted / max(1.0, float(np.abs(wanted).max()) / most)
        self._went = float(wanted[0]), float(wanted[1])
        return self._went
