# SPDX-License-Identifier: Apache-2.0
"""Pixels of a camera that looks nearly straight down, and those of the level camera in its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from signum.applications.hold.reading import Level
from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity


@dataclass(frozen=True)
class LevelCamera:
    """A distortion-free camera: size (width, height) and focal length, pixels; its axis meets the picture's centre.

    Level pixels are those of a level camera in the same place, from its centre.
    """

    size: tuple[int, int]
    focal: float

    @property
    def centre(self) -> Floats:
        """Of the picture, pixels (2,)."""
        return (np.array(self.size, np.float64) - 1) / 2

    def levelling(self, level: Level) -> Floats:
        """Homography (3, 3) from pixels of the picture to level pixels."""
        scale = np.diag([self.focal, self.focal, 1.0])
        about = np.array([[1, 0, -self.centre[0]], [0, 1, -self.centre[1]], [0, 0, 1]])
        return np.asarray(scale @ level.turn @ inverse(scale) @ about)

    def onto(self, similarity: Similarity, there: Level, here: Level) -> Floats:
        """Homography (3, 3) from pixels of a picture to those of another one.

        Args:
            similarity: level pixels of the one -> of the other.
            there: how the camera of the one was inclined, here: that of the other.
        """
        between = np.vstack([similarity.matrix, [0, 0, 1]])
        return np.asarray(inverse(self.levelling(here)) @ between @ self.levelling(there))


def inverse(homography: Floats) -> Floats:
    """The homography (3, 3) back.

    Raises:
        numpy.linalg.LinAlgError: if there is none.
    """
    return np.asarray(np.linalg.inv(homography), np.float64)


def moved(homography: Floats, points: NDArray[Any]) -> Floats:
    """The images (n, 2) of points (n, 2) by a homography (3, 3)."""
    seen = np.hstack([points, np.ones((len(points), 1))]) @ homography.T
    return np.asarray(seen[:, :2] / seen[:, 2:])
