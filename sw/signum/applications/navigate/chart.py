# SPDX-License-Identifier: Apache-2.0
"""A finished mosaic as a chart: its picture, the covered area, named places."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Image
from signum.common.checks import number, within
from signum.common.errors import SignumError
from signum.frames.frame import grey, read_picture
from signum.tables.reader import read_rows
from signum.tables.schemas import PLACES

CLOSED = 5
"""Width, pixels, up to which black specks inside the mosaic count as covered."""

FARTHEST = 1e6
"""Largest coordinate of a named place, pixels."""


class ChartError(SignumError):
    """A mosaic or place that cannot be used for navigation."""


@dataclass(frozen=True, eq=False)
class Chart:
    """A mosaic.

    Attributes:
        picture: uint8 (H, W), grey.
        covered: uint8 (H, W), 255 where frames lie, else 0.
        places: named places, pixels.
    """

    picture: Image
    covered: Image
    places: dict[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, picture: Image, covered: Image | None = None, places: dict[str, tuple[float, float]] | None = None
           ) -> Chart:
        """From a mosaic's picture; without `covered`, black pixels are not covered."""
        image = grey(picture)
        if covered is None:
            kernel = np.ones((CLOSED, CLOSED), np.uint8)
            covered = np.asarray(cv2.morphologyEx(np.where(image > 0, 255, 0).astype(np.uint8), cv2.MORPH_CLOSE, kernel,
                                                  borderType=cv2.BORDER_REPLICATE), np.uint8)
        return cls(image, covered, places or {})

    @classmethod
    def load(cls, path: Path) -> Chart:
        """From a folder of `signum mosaic`, or a picture of a mosaic.

        Raises:
            ChartError: if there is no mosaic.
            SourceError: if the picture is broken.
        """
        file = path / "mosaic.png" if path.is_dir() else path
        if not file.is_file():
            raise ChartError(f"{file}: no such mosaic; give the --out folder of `signum mosaic`")
        chart = cls.of(read_picture(file))
        if not chart.covered.any():
            raise ChartError(f"{file}: is entirely black; make the mosaic again")
        named = file.parent / "places.csv"
        return Chart(chart.picture, chart.covered, _places(named) if named.is_file() else {})

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.picture.shape[1], self.picture.shape[0]

    def covers(self, x: float, y: float) -> bool:
        """Whether a place lies on the mosaic."""
        column, row = round(x), round(y)
        inside = 0 <= column < self.size[0] and 0 <= row < self.size[1]
        return inside and bool(self.covered[row, column])

    def place(self, text: str) -> tuple[float, float]:
        """The place given by a user: `X,Y` in pixels, or a name of `places.csv`.

        Raises:
            ChartError: if there is no such name, or the place is not on the mosaic.
        """
        if text in self.places:
            x, y = self.places[text]
        else:
            try:
                x, y = (float(part) for part in text.split(","))
            except ValueError as error:
                known = f"one of {', '.join(self.places)}" if self.places else "from places.csv beside the mosaic"
                raise ChartError(f"--goto {text!r}: give X,Y in pixels of mosaic.png, or a name ({known})") from error
            for value in (x, y):
                within(value, f"--goto {text!r}", -FARTHEST, FARTHEST, ChartError)
        if not self.covers(x, y):
            raise ChartError(f"{text}: not on the mosaic, which is {self.size[0]}x{self.size[1]} pixels, black "
                             "where not covered; choose a place that is covered")
        return x, y

    def shrunk(self, factor: float) -> Chart:
        """The chart scaled down by `factor` >= 1; its pixel (0, 0) is centred on ((factor - 1) / 2,) * 2 of this."""
        if factor <= 1.0:
            return self
        size = [max(1, round(n / factor)) for n in self.size]
        matrix = np.array([[factor, 0, (factor - 1) / 2], [0, factor, (factor - 1) / 2]])
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        blurred = cv2.GaussianBlur(self.picture, (0, 0), 0.4 * factor) if factor > 1.3 else self.picture
        picture = cv2.warpAffine(blurred, matrix, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
        covered = cv2.warpAffine(self.covered, matrix, size, flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP)
        return Chart(np.asarray(picture, np.uint8), np.asarray(covered, np.uint8))


def filled(chart: Chart) -> Image:
    """The picture with its mean grey where not covered, so that the mosaic's border is only a step."""
    inside: NDArray[np.bool_] = chart.covered > 0
    return np.where(inside, chart.picture, np.uint8(round(float(chart.picture[inside].mean())))).astype(np.uint8)


def _places(path: Path) -> dict[str, tuple[float, float]]:
    rows = read_rows(path, ChartError)
    if not set(PLACES) <= set(rows[0]):
        raise ChartError(f"{path}: its columns are {', '.join(rows[0])}; expected {', '.join(PLACES)}")
    return {row["name"]: (number(row["x_px"], f"{path}: {row['name']}: x_px", -FARTHEST, FARTHEST, ChartError),
                          number(row["y_px"], f"{path}: {row['name']}: y_px", -FARTHEST, FARTHEST, ChartError))
            for row in rows}
