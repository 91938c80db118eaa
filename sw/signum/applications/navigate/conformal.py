# SPDX-License-Identifier: Apache-2.0
"""Stereographic pictures of a turning camera: a rotation of the camera moves them without deforming them.

A pinhole picture stretches objects off its axis by 1/cos^2 along the radius, so that pictures of one object at
different angles of a pan/tilt differ in shape. The stereographic projection r = 2 f tan(theta/2) is conformal: a
rotation of the camera changes it, to first order, by a similarity only, which windows and mosaics can follow.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image


@dataclass(frozen=True, eq=False)
class Conformal:
    """Resamples pinhole pictures.

    Attributes:
        size: (width, height) of the pinhole pictures, pixels; the axis meets their centre.
        focal: pixels.
        shown: (width, height) of the resampled pictures, whose corners lie within the pinhole ones.
    """

    size: tuple[int, int]
    focal: float
    shown: tuple[int, int] = field(init=False)
    _maps: tuple[NDArray[np.float32], NDArray[np.float32]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        corner = np.hypot(*self.size) / 2 - 1
        share = 2 * self.focal / corner * np.tan(np.arctan(corner / self.focal) / 2)
        width, height = (int(n * share) // 2 * 2 for n in self.size)
        object.__setattr__(self, "shown", (width, height))
        u, v = np.meshgrid(np.arange(width, dtype=np.float64), np.arange(height, dtype=np.float64))
        at = self.pinhole(np.stack([u, v], axis=-1)).astype(np.float32)
        object.__setattr__(self, "_maps", (at[..., 0], at[..., 1]))

    def __call__(self, picture: Image) -> Image:
        """The picture resampled: uint8 of size `shown`."""
        return np.asarray(cv2.remap(picture, *self._maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE), np.uint8)

    def pinhole(self, points: Floats) -> Floats:
        """Pixels (..., 2) of the pinhole picture of pixels of the redrawn one."""
        off = points - (np.array(self.shown) - 1) / 2
        r = np.hypot(off[..., 0], off[..., 1])[..., None] / (2 * self.focal)
        # tan(2a) = 2 tan(a) / (1 - tan(a)^2), a half the angle from the axis
        return np.asarray(off / (1 - r**2) + (np.array(self.size) - 1) / 2, np.float64)
