# SPDX-License-Identifier: Apache-2.0
"""What moves by itself as pictures: outlines over another picture, and the mask."""

from __future__ import annotations

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.measure.moving import Moving

EDGES = ((0, 0, 0), 4), ((0, 230, 255), 2)
"""Colours, blue, green, red, and widths of an outline: yellow with a dark edge."""
LETTERS = 0.55, 1
"""Size of the letters beside an outline, as a share of the font's own, and their width; their edge is wider by 3."""


def draw_outlines(picture: Image, moving: Moving, magnify: float = 2.0) -> Image:
    """The picture with the outline of every object, an arrow along its motion against the background, and that in
    pixels.

    Args:
        picture: uint8 (H, W) or (H, W, 3), of the mask's size; not changed.
        moving: what moves by itself.
        magnify: length of an arrow per displacement.

    Returns:
        uint8 (H, W, 3) blue, green, red.
    """
    out = np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR) if picture.ndim == 2 else picture.copy(), np.uint8)
    for n, one in enumerate(moving.objects, 1):
        lines, _ = cv2.findContours((moving.labels == n).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        start = round(one.x), round(one.y)
        end = round(one.x + magnify * one.own_dx), round(one.y + magnify * one.own_dy)
        words, foot = f"{np.hypot(one.own_dx, one.own_dy):.1f} px", (one.left, max(one.top - 6, 14))
        for (colour, width), edge in zip(EDGES, (3, 0), strict=True):
            cv2.drawContours(out, lines, -1, colour, width, cv2.LINE_AA)
            cv2.arrowedLine(out, start, end, colour, width, cv2.LINE_AA, tipLength=0.3)
            cv2.putText(out, words, foot, cv2.FONT_HERSHEY_SIMPLEX, LETTERS[0], colour, LETTERS[1] + edge, cv2.LINE_AA)
    return out


def mask_picture(moving: Moving) -> Image:
    """The mask as a picture, uint8 (H, W): 0 for the background, 256 - n for object n."""
    labels = moving.labels
    return np.where(labels > 0, 0 - labels, 0).astype(np.uint8)
