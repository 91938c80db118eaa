# SPDX-License-Identifier: Apache-2.0
"""A dense flow field in colours: the direction is the hue of a colour wheel, the length its strength; and arrows."""

from __future__ import annotations

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.measure.flow import FlowField
from signum.report.ranges import cells_of

WHEEL = 88
"""Side of the colour wheel in the corner, pixels."""
LINE = 14
"""Height of the line below it, pixels."""
ARROWS = 28
"""Pixels between two arrows, about."""
STRENGTH = 0.7
"""Share of the colour where the motion is strongest; the rest is the grey picture."""


def draw_wheel_flow(frame: Image, field: FlowField, magnify: float = 2.0) -> Image:
    """The field over its first frame: coloured where it is valid, with arrows, and the wheel that explains the colours.

    Args:
        frame: uint8 (H, W), the first frame.
        field: the flow, of windows on a grid.
        magnify: length of an arrow per displacement.

    Returns:
        uint8 (H, W, 3) blue, green, red.
    """
    out = np.asarray(cv2.cvtColor(np.asarray(frame * 0.8 + 20, np.uint8), cv2.COLOR_GRAY2BGR), np.uint8)
    speed = np.hypot(field.dx, field.dy)
    full = max(float(np.nanpercentile(speed, 98)) if field.valid.any() else 0.0, 0.5)
    rows, columns = (cells_of(at, size) for at, size in zip((field.y, field.x), frame.shape, strict=True))
    inside = (rows[:, None] >= 0) & (columns >= 0)
    dx, dy = (np.where(inside, d[rows[:, None], columns], np.nan) for d in (field.dx, field.dy))
    shown = np.isfinite(dx)
    colours, strength = wheel_colours(dx[shown] / full, dy[shown] / full)
    share = STRENGTH * (0.4 + 0.6 * strength)[:, None]
    out[shown] = np.asarray((1 - share) * out[shown] + share * colours, np.uint8)
    _draw_arrows(out, field, magnify)
    _draw_legend(out, full)
    return out


def wheel_colours(dx: Floats, dy: Floats) -> tuple[Image, Floats]:
    """Colours of displacements, uint8 (n, 3) blue, green, red, and their strengths, 0..1.

    Args:
        dx, dy: (n,) displacements, 1 for the strongest colour: right is red, down is yellow-green, left is cyan. There
            may be none.
    """
    strength = np.clip(np.hypot(dx, dy), 0, 1)
    hue = np.rint(np.degrees(np.arctan2(dy, dx)) % 360 / 2) % 180
    if not hue.size:  # OpenCV takes no empty picture
        return np.zeros((0, 3), np.uint8), strength
    hsv = np.stack([hue, 255 * strength, np.full_like(hue, 255)], axis=-1).astype(np.uint8)
    return np.asarray(cv2.cvtColor(hsv[:, None], cv2.COLOR_HSV2BGR)[:, 0], np.uint8).reshape(-1, 3), strength


def _draw_arrows(out: Image, field: FlowField, magnify: float) -> None:
    step = float(field.x[1] - field.x[0]) if field.x.size > 1 else ARROWS
    every = max(1, round(ARROWS / step))
    for j in range(every // 2, field.y.size, every):
        for i in range(every // 2, field.x.size, every):
            if field.valid[j, i]:
                start = round(field.x[i]), round(field.y[j])
                end = round(field.x[i] + magnify * field.dx[j, i]), round(field.y[j] + magnify * field.dy[j, i])
                for colour, width in (((255, 255, 255), 3), ((0, 0, 0), 1)):
                    cv2.arrowedLine(out, start, end, colour, width, cv2.LINE_AA, tipLength=0.3)


def _draw_legend(out: Image, full: float) -> None:
    """The wheel in the lower right corner, on white, and below it the displacement at its rim in pixels."""
    side = min(WHEEL, *(size // 4 for size in out.shape[:2]))
    corner, words = out[-side - LINE:, -side:], f"{full:.2g} px"
    corner[:] = 255
    y, x = (np.mgrid[:side, :side] - (side - 1) / 2) / (0.46 * side)
    disc = np.hypot(x, y) <= 1
    corner[:side][disc] = wheel_colours(x[disc], y[disc])[0]
    width = cv2.getTextSize(words, cv2.FONT_HERSHEY_SIMPLEX, 0.4, 1)[0][0]
    cv2.putText(corner, words, (max((side - width) // 2, 0), side + LINE - 4), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (0, 0, 0),
                1, cv2.LINE_AA)
