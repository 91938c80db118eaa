# SPDX-License-Identifier: Apache-2.0
"""Takes marine snow out of a picture and leaves the rest of it as it is.

A median filter alone takes snow out too, but it takes the texture of a plain floor with it: its result is in whole grey
levels and almost free of noise, so a texture of less than one level, as a brick's face has in murky water, is rounded
away. In the picture itself the camera's noise spreads such a level over many pixels, whose mean the LoG recovers. So
only pixels that a flake covers are replaced by the median.
"""

from __future__ import annotations

import cv2
import numpy as np

from signum.common.arrays import Image

FLAKE = 5
"""Side of the median filter, pixels: of flakes up to 3 pixels nothing is left."""
USUAL = 0.9
"""Share of the pixels whose difference from the median is taken for noise and texture."""
FAR = 4
"""A flake's pixel differs from the median by more than this many times the largest difference of the usual ones."""
EDGE = np.ones((3, 3), np.uint8)
"""A flake's edge: it goes with the flake."""


def without_snow(picture: Image) -> Image:
    """The picture, its flakes replaced by the median around them.

    Args:
        picture: uint8 (height, width).
    """
    calm = cv2.medianBlur(picture, FLAKE)
    apart = cv2.absdiff(picture, calm)
    counts = np.cumsum(cv2.calcHist([apart], [0], None, [256], [0, 256]).ravel())
    usual = max(1, int(np.searchsorted(counts, USUAL * apart.size)))
    flakes = cv2.dilate((apart > min(FAR * usual, 255)).view(np.uint8), EDGE)
    return np.asarray(np.where(flakes, calm, picture), np.uint8)
