# SPDX-License-Identifier: Apache-2.0
"""Pictures from a folder for a page."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SourceError
from signum.frames.frame import read_any_picture
from signum.report.page import figure, paragraph

WIDEST = 1400
"""Largest width of a picture on a page, pixels."""
MOST_PICTURES = 6
"""Pictures of one kind on a page."""


def picture(path: Path, caption: str = "") -> str:
    """A picture as a figure, scaled down where it is large; a paragraph that says why, if it cannot be read."""
    try:
        image = read_any_picture(path)
    except SourceError as error:
        return paragraph(f"Not shown: {error}")
    deep = image.dtype != np.uint8
    eight = cv2.convertScaleAbs(np.asarray(image, np.float32), alpha=1 / 256) if deep else image
    shown: Image = np.asarray(eight, np.uint8)
    scale = WIDEST / shown.shape[1]
    if scale < 1:
        size = (WIDEST, max(1, round(shown.shape[0] * scale)))
        shown = np.asarray(cv2.resize(shown, size, interpolation=cv2.INTER_AREA), np.uint8)
    return figure(shown, caption or path.stem)


def pictures(folder: Path, pattern: str, most: int = MOST_PICTURES) -> list[str]:
    """The folder's readable pictures whose names match a glob pattern, in order of their names.

    Of more than `most`, so many are taken at even distances, the first and the last among them.
    """
    paths = sorted(folder.glob(pattern))
    if len(paths) > most:
        paths = [paths[round(i)] for i in np.linspace(0, len(paths) - 1, most)]
    return [shown for shown in map(picture, paths) if shown]
