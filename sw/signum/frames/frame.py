"""A frame, how one is read from a file, and what every source of frames offers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from PIL import Image as PilImage
from PIL import UnidentifiedImageError

from signum.common.arrays import Image
from signum.common.errors import SourceError

PilImage.MAX_IMAGE_PIXELS = None  # a large mosaic is no attack
# A user gets one line for a picture that cannot be read; OpenCV's own warnings, of odd TIFF tags, would hide it.
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)


@dataclass(frozen=True)
class Frame:
    """One picture of a source, uint8 (H, W) or (H, W, 3) blue, green, red.

    `name` is the file's name without its ending for pictures, the index from 0 for everything else; it is the `frame`
    of all tables.
    """

    name: str
    picture: Image

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self.picture.shape[1], self.picture.shape[0]

    @property
    def grey(self) -> Image:
        """uint8 (H, W)."""
        return grey(self.picture)


class Source(ABC):
    """An ordered sequence of frames of one size."""

    snapshots = False
    """Whether frames are single pictures, far apart, rather than a stream with little motion from one to the next."""

    def __init__(self, label: str, count: int | None) -> None:
        self.label = label
        """The source's name in messages."""
        self.count = count
        """Number of frames; None if it is not known beforehand."""

    @abstractmethod
    def _frames(self) -> Iterator[Frame]: ...

    def __iter__(self) -> Iterator[Frame]:
        """The frames, in order.

        Raises:
            SourceError: at the first frame that cannot be used, after the ones before it.
        """
        first: Frame | None = None
        for frame in self._frames():
            first = first or frame
            if frame.size != first.size:
                raise SourceError(
                    f"{self.label}: frame {frame.name} is {size_text(frame.size)}, frame {first.name} is "
                    f"{size_text(first.size)}: all frames must have one size; crop or scale the odd ones, or put them "
                    "in a folder of their own")
            yield frame
        if first is None:
            raise SourceError(f"{self.label}: no frames in it; give a folder of pictures or a video that plays")


def grey(picture: Image) -> Image:
    """A picture without its colour: uint8 (H, W)."""
    return picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)


def read_picture(file: Path) -> Image:
    """Read an 8-bit picture, grey or colour.

    Raises:
        SourceError: if it is missing, broken, cut short, or not 8-bit.
    """
    if not file.exists():
        raise SourceError(f"{file}: no such file; check the spelling")
    try:  # of a file cut short, OpenCV returns the part it could decode; Pillow raises
        with PilImage.open(file) as check:
            check.load()
    except UnidentifiedImageError:
        pass
    except (OSError, SyntaxError) as error:
        raise SourceError(f"{file}: broken or cut short; copy it again or take it out") from error
    raw = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    if raw is None:
        raise SourceError(f"{file}: cannot be read: not a picture, or broken; copy it again or take it out")
    if raw.dtype != np.uint8:
        bits = 8 * raw.dtype.itemsize
        raise SourceError(f"{file}: a {bits}-bit picture; signum takes 8-bit grey or colour: "
                          f"convert it, e.g. `convert {file.name} -normalize -depth 8 {file.stem}_8bit.png`")
    if raw.ndim == 3 and raw.shape[2] == 4:
        raw = raw[:, :, :3]
    elif raw.ndim == 3 and raw.shape[2] != 3:
        raw = raw[:, :, 0]
    return np.ascontiguousarray(raw, np.uint8)


def size_text(size: tuple[int, int]) -> str:
    """A size (width, height) in messages: 640x480."""
    return f"{size[0]}x{size[1]}"
