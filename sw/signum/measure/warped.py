# SPDX-License-Identifier: Apache-2.0
"""A picture warped by a motion, so that what has this motion rests against the picture before it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import numpy as np
from numpy.typing import NDArray

from golden.dense import DensePass
from signum.common.arrays import Floats
from signum.measure.measurer import Measurer, View

FLAGS = cv2.WARP_INVERSE_MAP | cv2.INTER_LINEAR
BORDER = 4
"""Pixels beside a window that the filter takes in."""


@contextmanager
def warped(measurer: Measurer, view: View, motion: Floats) -> Iterator[View]:
    """The view's picture, warped so that what moved by a homography (3, 3) rests, as a view for the while.

    Raises:
        RuntimeError: if all slots of the board hold views.
    """
    picture = cv2.warpPerspective(view.picture, motion, view.frame_size, flags=FLAGS, borderMode=cv2.BORDER_REPLICATE)
    seen = measurer.view(np.asarray(picture, np.uint8))
    try:
        yield seen
    finally:
        measurer.release(seen)


def stays_in_view(motion: Floats, view: View, side: int) -> NDArray[np.bool_]:
    """The pixels (H, W) whose windows, and what the filter takes in around them, stay in the picture by a motion."""
    inside = cv2.warpPerspective(np.ones_like(view.picture), motion, view.frame_size, flags=FLAGS)
    around = np.ones((side + 2 * BORDER,) * 2, np.uint8)
    return np.asarray(cv2.erode(inside, around, borderType=cv2.BORDER_CONSTANT, borderValue=1) > 0)


def mismatches(measurer: Measurer, before: View, live: View, side: int) -> NDArray[np.int32]:
    """Mismatches (H, W) of the window around every pixel with that at the same place of another view, by one pass of
    the engine; those at the border are the nearest whole window's.

    Raises:
        BoardError: if the board has no dense engine, or not of this window.
    """
    counts = measurer.dense(before, live, DensePass(side, 1)).best[side - 1:, side - 1:]
    return np.pad(counts.astype(np.int32), ((side // 2, side - 1 - side // 2),) * 2, mode="edge")
