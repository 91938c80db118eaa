"""Reading the project's tables back."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.common.errors import SignumError
from signum.report.page import figure

WIDEST = 1400
"""Pixels of a picture on a page."""


@dataclass(frozen=True)
class Columns:
    """A table by columns of text."""

    names: tuple[str, ...]
    text: dict[str, list[str]]

    @property
    def rows(self) -> int:
        """Their number."""
        return len(self.text[self.names[0]]) if self.names else 0

    def numbers(self, name: str) -> Floats:
        """A column as numbers; NaN where it is empty or none."""
        return np.array([_number(v) for v in self.text[name]], np.float64)

    def groups(self, name: str) -> dict[str, NDArray[np.int64]]:
        """Row numbers by the value of a column, in order of first sight."""
        out: dict[str, list[int]] = {}
        for i, value in enumerate(self.text[name]):
            out.setdefault(value, []).append(i)
        return {value: np.array(rows, np.int64) for value, rows in out.items()}


def read(path: Path, needed: tuple[str, ...] = ()) -> Columns:
    """Read a CSV file; a last row cut short is left out.

    Raises:
        SignumError: if a needed column is missing.
    """
    with path.open(newline="", encoding="utf-8", errors="replace") as file:
        lines = [line for line in csv.reader(file) if line]
    names = tuple(lines[0]) if lines else ()
    missing = [name for name in needed if name not in names]
    if missing:
        raise SignumError(f"{path}: has no column {', '.join(missing)}; run the command again that writes this table")
    body = [line for line in lines[1:] if len(line) == len(names)]
    return Columns(names, {name: [line[i] for line in body] for i, name in enumerate(names)})


def picture(path: Path, caption: str = "") -> str:
    """A picture of the folder for a page, scaled down where it is large; empty if it cannot be read."""
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        return ""
    deep = image.dtype != np.uint8
    shown: Image = np.asarray(cv2.convertScaleAbs(image, alpha=1 / 256) if deep else image, np.uint8)
    scale = WIDEST / shown.shape[1]
    if scale < 1:
        size = (WIDEST, max(1, round(shown.shape[0] * scale)))
        shown = np.asarray(cv2.resize(shown, size, interpolation=cv2.INTER_AREA), np.uint8)
    return figure(shown, caption or path.stem)


def evenly(paths: list[Path], most: int) -> list[Path]:
    """At most so many of them, the first and the last among them."""
    if len(paths) <= most:
        return paths
    return [paths[round(i)] for i in np.linspace(0, len(paths) - 1, most)]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
