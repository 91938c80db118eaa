# SPDX-License-Identifier: Apache-2.0
"""A frame, how one is read from a file, and what every source of frames offers."""

from __future__ import annotations

import io
import struct
import warnings
import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image as PilImage
from PIL import UnidentifiedImageError

from signum.common.arrays import Image
from signum.common.checks import check_pixels, printable, read_bytes
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.frames.eight import EightBits

PilImage.MAX_IMAGE_PIXELS = None  # `check_pixels` has a limit of its own
PNG, PNG_DEPTH = b"\x89PNG\r\n\x1a\n", 24
"""How a PNG begins, and where its first chunk has the bits of a channel."""
TIFF = b"II", b"MM"
SLIGHTLY = 0.05
"""Share of its width or height by which a single picture may be larger or smaller than the first."""
# A user gets one line for a picture that cannot be read: OpenCV's own, of odd TIFF tags or depths, would hide it.
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)


@dataclass(frozen=True)
class Frame:
    """One picture of a source, uint8 (H, W) or (H, W, 3) blue, green, red.

    `name` is the file's name without its ending for pictures, the index from 0 for everything else; it is the `frame`
    of all tables. `time_s` is its time in seconds on its source's own clock: the presentation time of a video, a
    message's stamp in a bag, the monotonic clock when a live frame came; None where the source has no times.
    """

    name: str
    picture: Image
    time_s: float | None = None

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
    live = False
    """Whether frames cannot be had again; the newest is given, those that came meanwhile are skipped."""
    rate: float | None = None
    """Nominal frames per second; None if it is not known."""
    skipped = 0
    """Frames that a live source did not give, as newer ones came."""
    lost = 0
    """Packets of a live source that never came."""
    oldest_s = 0.0
    """Greatest age of a live frame when it was given, seconds."""

    def __init__(self, label: str, count: int | None) -> None:
        self.label = printable(label)
        """The source's name in messages."""
        self.count = count
        """Number of frames; None if it is not known beforehand."""

    @abstractmethod
    def _frames(self) -> Iterator[Frame]: ...

    def __iter__(self) -> Iterator[Frame]:
        """The frames, in order. Of single pictures, those that differ slightly in size from the first one are cut, or
        continued by their outermost pixels, to its size, on opposite sides alike: scans of one camera do, and a pixel
        covers as much in all of them.

        Raises:
            SourceError: at the first frame that cannot be used, after the ones before it.
        """
        first: Frame | None = None
        told = False
        for frame in self._frames():
            first = first or frame
            check_pixels(*frame.size, f"{self.label}: frame {frame.name}", SourceError)
            if frame.size != first.size and self.snapshots and _slightly(frame.size, first.size):
                if not told:
                    notes.print(f"{self.label}: frame {frame.name} is {size_text(frame.size)}, frame {first.name} is "
                                f"{size_text(first.size)}: such frames are cut or continued to the size of the first")
                told, frame = True, replace(frame, picture=fitted(frame.picture, first.size))
            if frame.size != first.size:
                raise SourceError(
                    f"{self.label}: frame {frame.name} is {size_text(frame.size)}, frame {first.name} is "
                    f"{size_text(first.size)}: all frames must have one size; crop or scale the odd ones, or put them "
                    "in a folder of their own")
            yield frame
        if first is None:
            raise SourceError(f"{self.label}: no frames in it; give a folder of pictures or a video that plays")


def _slightly(size: tuple[int, int], first: tuple[int, int]) -> bool:
    return all(abs(a - b) <= SLIGHTLY * b for a, b in zip(size, first, strict=True))


def fitted(picture: Image, size: tuple[int, int]) -> Image:
    """A picture cut, or continued by its outermost pixels, about its middle, to a size (width, height)."""
    more = [n - m for n, m in zip(size, picture.shape[1::-1], strict=True)]
    before = [n // 2 for n in more]
    left, top = (max(0, -n) for n in before)
    cut = picture[top:top + min(size[1], picture.shape[0]), left:left + min(size[0], picture.shape[1])]
    left, top = (max(0, n) for n in before)
    return np.asarray(cv2.copyMakeBorder(cut, top, size[1] - cut.shape[0] - top, left, size[0] - cut.shape[1] - left,
                                         cv2.BORDER_REPLICATE), np.uint8)


def grey(picture: Image) -> Image:
    """A picture without its colour: uint8 (H, W)."""
    return picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)


def read_picture(file: Path, eight: EightBits | None = None) -> Image:
    """Read a picture, grey or colour, in 8 bits.

    Args:
        file: of the picture.
        eight: how a deeper picture is mapped to 8 bits; by default a mapping of its own, which is told of.

    Raises:
        SourceError: if it is missing, no file, broken, cut short or larger than the limit.
    """
    return plain((eight or EightBits(str(file)))(read_any_picture(file), file.name))


def plain(picture: Image) -> Image:
    """A decoded picture (H, W) or (H, W, channels) as frames have it: grey, or blue, green, red, without more."""
    if picture.ndim == 3 and picture.shape[2] == 4:
        picture = picture[:, :, :3]
    elif picture.ndim == 3 and picture.shape[2] != 3:
        picture = picture[:, :, 0]
    return np.ascontiguousarray(picture, np.uint8)


def read_any_picture(file: Path) -> NDArray[np.generic]:
    """Read a picture of any depth, (H, W) or (H, W, channels).

    Raises:
        SourceError: if it is missing, no file, broken, cut short, or larger than the limit.
    """
    return decode_picture(read_bytes(file, "picture", SourceError), str(file))


def decode_picture(data: bytes, label: str) -> NDArray[np.generic]:
    """Decode a picture of any depth, (H, W) or (H, W, channels); its size is checked before, and the checksums of a
    PNG.

    Args:
        data: the file's bytes.
        label: the picture's name in messages.

    Raises:
        SourceError: if it is broken, cut short, or larger than the limit.
    """
    broken = f"{label}: broken or cut short; copy it again or take it out"
    try:
        whole, found = _checked(data, label)
        if not whole:
            raise SourceError(broken)
        raw = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if found is None else found
    except SourceError:
        raise
    except Exception as error:  # a broken file makes its reader raise errors of any type
        raise SourceError(broken) from error
    if raw is None:
        raise SourceError(f"{label}: cannot be read: not a picture, or broken; copy it again or take it out")
    return np.asarray(raw)


def _checked(data: bytes, label: str) -> tuple[bool, Image | None]:
    """Whether a picture is complete: OpenCV returns of one cut short the part it could decode, Pillow raises. And the
    picture itself, where OpenCV would decode the same once more.

    Raises:
        Exception: of any type, if it is broken.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of odd tags
        try:
            with PilImage.open(io.BytesIO(data)) as picture:
                check_pixels(*picture.size, label, SourceError)
                if picture.format == "PNG" and not _checksums_agree(data):
                    return False, None
                picture.load()
                return True, _ordinary(picture, data)
        except UnidentifiedImageError:
            # Pillow does not read TIFF of 16-bit colour; of anything else the size is not known.
            if data[:2] not in TIFF:
                raise SourceError(f"{label}: cannot be read: not a picture, or broken; copy it again or take it out"
                                  ) from None
            import tifffile  # loads slowly, and is rarely needed

            with tifffile.TiffFile(io.BytesIO(data)) as pages:
                page = pages.pages.first
                check_pixels(page.imagewidth, page.imagelength, label, SourceError)
    return True, None


def _ordinary(picture: PilImage.Image, data: bytes) -> Image | None:
    """A decoded PNG of 8 bits without transparency or animation, as OpenCV gives it; None for all others."""
    if (picture.format != "PNG" or data[PNG_DEPTH] != 8 or picture.mode not in ("L", "RGB")
            or "transparency" in picture.info or getattr(picture, "is_animated", False)):
        return None
    pixels = np.array(picture, np.uint8)
    return pixels if picture.mode == "L" else np.asarray(cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR), np.uint8)


def _checksums_agree(data: bytes) -> bool:
    """Whether every chunk of a PNG has its CRC-32, and the last one is there."""
    at = len(PNG)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        end = at + 8 + length
        if end + 4 > len(data) or zlib.crc32(data[at + 4:end]) != int.from_bytes(data[end:end + 4], "big"):
            return False
        if kind == b"IEND":
            return True
        at = end + 4
    return False


def size_text(size: tuple[int, int]) -> str:
    """A size (width, height) in messages: 640x480."""
    return f"{size[0]}x{size[1]}"
