# SPDX-License-Identifier: Apache-2.0
"""Frames from pictures, a camera or an array in memory, with the lens distortion taken out if need be."""

from __future__ import annotations

import ast
import math
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.common.checks import check_file, check_pixels
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.frames.eight import EightBits
from signum.frames.exif import times_of
from signum.frames.frame import Frame, Source, read_picture, size_text
from signum.geometry.lens import Lens

PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp"})
"""A file with one of these endings is a picture."""

LONGEST_HEADER = 10_000
"""Bytes of a .npy file's header, as NumPy limits it."""


class FolderSource(Source):
    """A folder of pictures in natural order of their names (2 before 10)."""

    snapshots = True

    def __init__(self, folder: Path) -> None:
        pictures = (f for f in folder.iterdir() if f.suffix.lower() in PICTURES and not f.name.startswith("."))
        self.files = sorted(pictures, key=lambda f: _natural(f.name))
        if not self.files:
            raise SourceError(f"{folder}: no pictures in this folder; signum reads {' '.join(sorted(PICTURES))}")
        seen: dict[str, Path] = {}
        for f in self.files:
            name = name_of(f)
            if name in seen:
                raise SourceError(f"{folder}: {seen[name].name} and {f.name} would both be frame {name}; "
                                  "rename or move one of them")
            seen[name] = f
        super().__init__(str(folder), len(self.files))

    def _frames(self) -> Iterator[Frame]:
        eight = EightBits(self.label)
        times = times_of(self.files)
        return (Frame(name_of(f), read_picture(f, eight), t) for f, t in zip(self.files, times, strict=True))


class PictureSource(Source):
    """A single picture."""

    snapshots = True

    def __init__(self, file: Path) -> None:
        super().__init__(str(file), 1)
        self.file = file

    def _frames(self) -> Iterator[Frame]:
        yield Frame(name_of(self.file), read_picture(self.file), times_of([self.file])[0])


class ArraySource(Source):
    """Camera frames held in an array: a sequence of pictures, or a .npy file of uint8 (N, H, W) or (N, H, W, 3)."""

    def __init__(self, pictures: Sequence[Image] | Image, label: str = "array") -> None:
        super().__init__(label, len(pictures))
        self.pictures = pictures

    @classmethod
    def load(cls, file: Path) -> ArraySource:
        """Read a .npy file.

        Raises:
            SourceError: if it is not such an array.
        """
        size = check_file(file, "NumPy array", SourceError)
        shape, fortran, kind, offset = _header(file)
        if kind != np.uint8 or len(shape) not in (3, 4) or (len(shape) == 4 and shape[3] != 3):
            raise SourceError(f"{file}: {kind} array of shape {shape}; frames are uint8 (N, H, W) or (N, H, W, 3)")
        if min(shape) < 1:
            raise SourceError(f"{file}: array of shape {shape}; expected every length to be 1 or more")
        check_pixels(shape[2], shape[1], str(file), SourceError)
        if size != offset + math.prod(shape):
            raise SourceError(f"{file}: {size - offset} bytes of data; expected {math.prod(shape)} for an array of "
                              f"shape {shape}: save the frames again with `numpy.save`")
        data: Image = np.memmap(file, np.uint8, "r", offset, shape, "F" if fortran else "C")
        return cls(data, str(file))

    def _frames(self) -> Iterator[Frame]:
        for index in range(len(self.pictures)):
            yield Frame(str(index), np.ascontiguousarray(self.pictures[index]))


class UndistortedSource(Source):
    """Frames of another source as a camera without lens distortion, of the same size and focal length, sees them."""

    def __init__(self, source: Source, lens: Lens, calibration: str) -> None:
        super().__init__(source.label, source.count)
        self.source, self.snapshots, self.calibration = source, source.snapshots, calibration
        self.live, self.rate = source.live, source.rate
        self.lens = lens

    @property
    def skipped(self) -> int:  # type: ignore[override]
        """Of the source."""
        return self.source.skipped

    @property
    def lost(self) -> int:  # type: ignore[override]
        """Of the source."""
        return self.source.lost

    @property
    def oldest_s(self) -> float:  # type: ignore[override]
        """Of the source."""
        return self.source.oldest_s

    def _frames(self) -> Iterator[Frame]:
        maps: tuple[Floats, Floats] | None = None
        for frame in self.source:
            if maps is None:  # all frames have one size
                maps = self.lens.scaled(frame.size, f"{self.calibration}: frame {frame.name}").maps()
                if frame.size != self.lens.size:
                    notes.print(f"{self.calibration}: is for {size_text(self.lens.size)}, scaled to the frames' "
                                f"{size_text(frame.size)}")
            yield replace(frame, picture=np.asarray(cv2.remap(frame.picture, *maps, cv2.INTER_LINEAR), np.uint8))


def _header(file: Path) -> tuple[tuple[int, ...], bool, np.dtype[np.generic], int]:
    """Shape, whether in Fortran's order, type and offset of the data of a .npy file.

    Raises:
        SourceError: if it is no such file.
    """
    with file.open("rb") as stream:
        try:
            version = np.lib.format.read_magic(stream)
            length = int.from_bytes(stream.read(2 if version == (1, 0) else 4), "little")
            if length > LONGEST_HEADER:
                raise ValueError("length of the header")
            header = ast.literal_eval(stream.read(length).decode("utf-8" if version == (3, 0) else "latin1").strip())
            shape = tuple(header["shape"])
            if set(header) != {"descr", "fortran_order", "shape"} or not all(type(n) is int for n in shape):
                raise ValueError("entries of the header")
            if type(header["fortran_order"]) is not bool or not isinstance(header["descr"], str):
                raise ValueError("entries of the header")
            kind = np.dtype(header["descr"])
        except Exception as error:  # of any type: the header is a Python literal
            raise SourceError(f"{file}: not a NumPy array file; save the frames with `numpy.save`") from error
        return shape, header["fortran_order"], kind, stream.tell()


def name_of(file: Path) -> str:
    """The name of a picture's frame: the file's without its ending; bytes that are not UTF-8 become escapes."""
    return os.fsencode(file.stem).decode("utf-8", "backslashreplace")


def _natural(name: str) -> list[tuple[int, int, str]]:
    parts = filter(None, re.split(r"(\d+)", name))
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part.lower()) for part in parts]
