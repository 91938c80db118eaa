# SPDX-License-Identifier: Apache-2.0
"""Pictures that several pages and commands show: the stages of the filter, flow, tracked features, a line of text."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from golden import log
from signum.common.arrays import Image
from signum.measure.flow import FlowField
from signum.measure.track import TrackPoint

GAP = 6
YELLOW, GREEN, RED = (0, 220, 255), (80, 220, 60), (60, 60, 240)


def stages(image: Image, signs: Image, sigma: float) -> list[tuple[str, Image]]:
    """The paper's figure 3: original, smoothed, Laplacian of Gaussian (mid grey is 0), and the board's signs.

    Args:
        image: uint8 (H, W).
        signs: uint8 (H, W) of 0 and 1, from the board.
        sigma: pixels. The board gives out no intermediate stages: the two between are computed in software.
    """
    smooth = np.asarray(cv2.GaussianBlur(image, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE), np.uint8)
    response = log.response(image, sigma)
    spread = float(np.percentile(np.abs(response), 98)) or 1.0
    shown = np.clip(128 + 127 * response / spread, 0, 255)
    return [("original", image), ("Gaussian", smooth),
            ("Laplacian of Gaussian", shown.astype(np.uint8)), ("sign", signs * np.uint8(255))]


def stage_panel(image: Image, signs: Image, sigma: float) -> Image:
    """The stages side by side, two by two: uint8 (H', W')."""
    tiles = []
    for name, tile in stages(image, signs, sigma):
        strip = np.full((22, tile.shape[1]), 255, np.uint8)
        cv2.putText(strip, name, (4, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.5, 0, 1, cv2.LINE_AA)
        framed = np.vstack([strip, tile])
        tiles.append(cv2.copyMakeBorder(framed, 0, GAP, 0, GAP, cv2.BORDER_CONSTANT, value=255))
    return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])


def write_line(canvas: Image, words: str, size: float) -> None:
    """Write words along the lower edge of a picture, white with a dark edge.

    The edge is made by widening the letters, because a bolder font would be longer too.

    Args:
        canvas: uint8 (H, W, 3), written on.
        words: no longer than the picture is wide.
        size: of the letters, as a share of the font's own, up to 0.6.
    """
    foot = canvas[-24:]
    ink = np.zeros(foot.shape[:2], np.uint8)
    cv2.putText(ink, words, (6, foot.shape[0] - 8), cv2.FONT_HERSHEY_SIMPLEX, size, 255, 1, cv2.LINE_AA)
    for weight, level in ((cv2.dilate(ink, np.ones((3, 3), np.uint8)), 0), (ink, 255)):
        share = weight[..., None] / 255
        foot[:] = np.rint(foot * (1 - share) + level * share)


def draw_tracks(image: Image, points: Sequence[TrackPoint], window: int) -> Image:
    """The paper's figure 7: features in a frame, each with its window and its path; red where not valid.

    Args:
        image: uint8 (H, W).
        points: of this frame, in its pixels.
        window: side of the windows, pixels.
    """
    canvas = np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8)
    for p in points:
        at = round(p.x), round(p.y)
        if p.valid:
            half = window // 6
            cv2.rectangle(canvas, (at[0] - half, at[1] - half), (at[0] + half, at[1] + half), GREEN, 1, cv2.LINE_AA)
            cv2.line(canvas, (round(p.x - p.dx), round(p.y - p.dy)), at, YELLOW, 1, cv2.LINE_AA)
        else:
            cv2.drawMarker(canvas, at, RED, cv2.MARKER_TILTED_CROSS, 7, 1, cv2.LINE_AA)
    return canvas


def draw_flow(frame: Image, field: FlowField, magnify: float = 2.0) -> Image:
    """The field as arrows on its first frame, as in the paper's figure 6.

    Args:
        frame: uint8 (H, W), the first frame.
        field: the flow; a window without a valid measurement is marked by a small cross.
        magnify: length of an arrow per displacement.

    Returns:
        uint8 (H, W, 3) blue, green, red.
    """
    dim = cv2.LUT(frame, np.asarray(np.arange(256) * 0.6, np.uint8))
    out = np.asarray(cv2.cvtColor(dim, cv2.COLOR_GRAY2BGR), np.uint8)
    u, v = np.meshgrid(field.x, field.y)
    columns = u, v, u + magnify * np.nan_to_num(field.dx), v + magnify * np.nan_to_num(field.dy), field.valid
    for x, y, right, down, valid in np.rint(np.stack(columns, axis=-1).reshape(-1, 5)).astype(int).tolist():
        if valid:
            cv2.arrowedLine(out, (x, y), (right, down), (80, 255, 120), 1, cv2.LINE_AA, tipLength=0.3)
        else:
            cv2.drawMarker(out, (x, y), (60, 60, 255), cv2.MARKER_TILTED_CROSS, 5)
    return out
