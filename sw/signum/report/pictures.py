# SPDX-License-Identifier: Apache-2.0
"""Pictures from a folder for a page."""

from __future__ import annotations

import base64
import html
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SourceError
from signum.frames.frame import read_any_picture
from signum.report.page import figure, paragraph

WIDEST = 1400
"""Largest width of a picture on a page, pixels."""
LARGEST_FILM = 16 << 20
"""Largest film inside a page, bytes."""
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


def film(path: Path) -> str:
    """A film that the page plays, inside the page, or beside it where it is large; empty if there is none."""
    if not path.is_file():
        return ""
    name = html.escape(path.name)
    large = path.stat().st_size > LARGEST_FILM
    source = name if large else f"data:video/mp4;base64,{base64.b64encode(path.read_bytes()).decode()}"
    return (f"<figure><video controls muted loop preload='metadata' src='{source}'></video><figcaption>{name}"
            f"{', beside this page' if large else ''}</figcaption></figure>")


def pictures(folder: Path, pattern: str, most: int = MOST_PICTURES) -> list[str]:
    """The folder's readable pictures whose names match a glob pattern, in order of their names.

    Of more than `most`, so many are taken at even distances, the first and the last among them.
    """
    paths = sorted(folder.glob(pattern))
    if len(paths) > most:
        paths = [paths[round(i)] for i in np.linspace(0, len(paths) - 1, most)]
    return [shown for shown in map(picture, paths) if shown]
