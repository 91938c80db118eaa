# SPDX-License-Identifier: Apache-2.0
"""What a calibration leaves: `calibration.yaml`, tables of views and corners, and pictures to judge it by."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from signum.applications.calibrate.solve import LensFit
from signum.common.arrays import Floats, Image
from signum.geometry.coverage import CELLS, corner_counts
from signum.geometry.lens import Lens
from signum.geometry.rig import Rectifier
from signum.report.draw import GREEN, RED, YELLOW

MAGNIFIED = 50.0
"""Pixels of the picture for a pixel of a drawn residual."""
LINES = 12
"""Rows that are drawn across a rectified pair."""


def view_rows(names: Sequence[str], camera: str, fit: LensFit) -> list[list[str]]:
    """Lines of `views.csv`."""
    used, tilts = set(fit.used), fit.tilts_deg()
    return [[name, camera, str(int(k in used)), str(len(view.ids)),
             f"{np.sqrt((fit.residuals[k] ** 2).sum(1).mean()):.4f}", f"{np.linalg.norm(fit.moves[k]):.4f}",
             f"{tilts[k]:.2f}"] for k, (name, view) in enumerate(zip(names, fit.views, strict=True))]


def corner_rows(names: Sequence[str], camera: str, fit: LensFit) -> list[list[str]]:
    """Lines of `corners.csv`."""
    used = set(fit.used)
    return [[name, camera, str(int(k in used)), *(f"{v:.3f}" for v in (*at, *off))]
            for k, (name, view) in enumerate(zip(names, fit.views, strict=True))
            for at, off in zip(view.corners, fit.residuals[k], strict=True)]


def draw_coverage(picture: Image, corners: Floats) -> Image:
    """Where in the picture corners were seen: green dots, and red cells without any.

    Args:
        picture: uint8 (H, W), drawn dimly behind.
        corners: of all used views, pixels (n, 2).
    """
    out = np.asarray(cv2.cvtColor(np.asarray(picture * 0.4, np.uint8), cv2.COLOR_GRAY2BGR), np.uint8)
    height, width = picture.shape
    counts = corner_counts(corners, (width, height))
    for j in range(CELLS[1]):
        for i in range(CELLS[0]):
            low = round(i * width / CELLS[0]), round(j * height / CELLS[1])
            high = round((i + 1) * width / CELLS[0]) - 1, round((j + 1) * height / CELLS[1]) - 1
            if not counts[j, i]:
                part = out[low[1]:high[1] + 1, low[0]:high[0] + 1]
                part[:] = np.asarray(0.6 * part + 0.4 * np.array(RED), np.uint8)
            cv2.rectangle(out, low, high, (90, 90, 90), 1)
    size = max(1, round(width / 400))
    for x, y in corners:
        cv2.circle(out, (round(float(x)), round(float(y))), size, GREEN, -1, cv2.LINE_AA)
    return out


def draw_residuals(picture: Image, corners: Floats, residuals: Floats) -> Image:
    """Residuals as lines from the corners, MAGNIFIED times as long; a pattern in them is a model that does not suit."""
    out = np.asarray(cv2.cvtColor(np.asarray(picture * 0.3, np.uint8), cv2.COLOR_GRAY2BGR), np.uint8)
    width = max(1, round(picture.shape[1] / 900))
    for at, off in zip(corners, residuals, strict=True):
        end = at + MAGNIFIED * off
        cv2.line(out, (round(float(at[0])), round(float(at[1]))), (round(float(end[0])), round(float(end[1]))), YELLOW,
                 width, cv2.LINE_AA)
    return out


def draw_straight(picture: Image, lens: Lens) -> Image:
    """A picture beside itself without distortion, in which straight edges must be straight; uint8 (H, 2 W + gap)."""
    straight = np.asarray(cv2.remap(picture, *lens.maps(), cv2.INTER_LINEAR), np.uint8)
    gap = np.full((picture.shape[0], max(4, picture.shape[1] // 80)), 255, np.uint8)
    return np.hstack([picture, gap, straight])


def draw_rows(left: Image, right: Image, rectify: Rectifier) -> Image:
    """The rectified pair side by side with lines across: a point must lie on the same line in both."""
    pair = np.hstack(rectify(left, right))
    out = np.asarray(cv2.cvtColor(pair, cv2.COLOR_GRAY2BGR), np.uint8)
    for k in range(1, LINES):
        y = round(k * out.shape[0] / LINES)
        cv2.line(out, (0, y), (out.shape[1] - 1, y), GREEN if k % 2 else YELLOW, 1)
    return out
