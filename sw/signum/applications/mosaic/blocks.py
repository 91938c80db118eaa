# SPDX-License-Identifier: Apache-2.0
"""A picture larger than memory: made block by block into a file without a name, read back by rows and tiles.

The file holds the bytes of the picture row after row, uncompressed, on the disk of the results; the system removes it
when it is closed, also after a crash. Each overview gets another one of a quarter of its size.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Protocol

import numpy as np

from signum.common.arrays import Image


class BlockSource(Protocol):
    """A picture whose parts are made when they are asked for, as `blend.Composition`.

    Attributes:
        size: width and height, pixels.
        origin, scale: as those of `blend.Mosaic`.
        grey: whether it is without colour.
    """

    size: tuple[int, int]
    origin: tuple[float, float]
    scale: float
    grey: bool

    def block(self, box: tuple[int, int, int, int]) -> Image | None:
        """What lies within left, top, right and bottom (exclusive), uint8 (h, w) or (h, w, 3); None if nothing."""


class Spill:
    """A picture in a file, to be closed after use.

    Args:
        folder: on whose disk the file is.
        shape: (H, W) or (H, W, 3).
    """

    def __init__(self, folder: Path, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self._pixel = shape[2] if len(shape) == 3 else 1
        self._file: IO[bytes] = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115  # closed by `__exit__`
        self._file.truncate(int(np.prod(shape)))  # black where nothing is written

    def __enter__(self) -> Spill:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    @classmethod
    def of(cls, source: BlockSource, folder: Path, block: int) -> Spill:
        """A source's picture, red first where it has colour; `block` is the side of the parts it is made of, pixels."""
        width, height = source.size
        made = cls(folder, (height, width) if source.grey else (height, width, 3))
        try:
            for top in range(0, height, block):
                for left in range(0, width, block):
                    part = source.block((left, top, min(left + block, width), min(top + block, height)))
                    if part is not None:
                        made.put(left, top, part if source.grey else part[:, :, ::-1])
        except BaseException:
            made._file.close()
            raise
        return made

    def put(self, left: int, top: int, part: Image) -> None:
        """Write a part of the picture."""
        for row, line in enumerate(np.ascontiguousarray(part), top):
            self._file.seek((row * self.shape[1] + left) * self._pixel)
            self._file.write(line.tobytes())

    def rows(self, top: int, bottom: int) -> Image:
        """Rows from `top` to `bottom` (exclusive, cut to the picture)."""
        count = min(bottom, self.shape[0]) - top
        self._file.seek(top * self.shape[1] * self._pixel)
        data = self._file.read(count * self.shape[1] * self._pixel)
        return np.frombuffer(data, np.uint8).reshape(count, *self.shape[1:])

    def tiles(self, side: int) -> Iterator[Image]:
        """All tiles, row by row, black beyond the picture's edges: (side, side) or (side, side, 3)."""
        across = -(-self.shape[1] // side)
        for top in range(0, self.shape[0], side):
            band = self.rows(top, top + side)
            wide = np.zeros((side, across * side, *self.shape[2:]), np.uint8)
            wide[: band.shape[0], : band.shape[1]] = band
            for k in range(across):
                yield np.ascontiguousarray(wide[:, k * side:(k + 1) * side])

    def halved(self, folder: Path, rows: int = 512) -> Spill:
        """The picture at half its size, made of so many rows at a time, an even number."""
        made = Spill(folder, (*((side + 1) // 2 for side in self.shape[:2]), *self.shape[2:]))
        for top in range(0, self.shape[0], rows):
            made.put(0, top // 2, halve(self.rows(top, top + rows)))
        return made


def halve(picture: Image) -> Image:
    """A picture, uint8 (H, W) or (H, W, 3), at half its size.

    A pixel is the mean of the up to four that it covers, without those where there is no picture, which are 0.
    """
    size = tuple((side + 1) // 2 for side in picture.shape[:2])
    total, count = np.zeros((*size, *picture.shape[2:]), np.uint16), np.zeros(size, np.uint16)
    for down, right in ((0, 0), (0, 1), (1, 0), (1, 1)):
        part = picture[down::2, right::2]
        here = slice(part.shape[0]), slice(part.shape[1])
        total[here] += part
        count[here] += (part if part.ndim == 2 else part[:, :, 0] | part[:, :, 1] | part[:, :, 2]) > 0
    number = np.maximum(count, 1) if picture.ndim == 2 else np.maximum(count, 1)[:, :, None]
    return np.asarray((total + number // 2) // number, np.uint8)
