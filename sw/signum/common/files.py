# SPDX-License-Identifier: Apache-2.0
"""Files that are whole at any moment: written beside their place, then renamed into it.

A crash leaves the file that was there before, or the new one, and at most a file `.part-NAME` beside it, which the next
write of the same file replaces. The data reach the disk before the name does, so a power failure leaves no empty file.
"""

from __future__ import annotations

import errno
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Image

UNFINISHED = ".part-"
"""How the name of a file begins that is being written."""

FAST = 1
"""Compression of a PNG, zlib's, up to which it has to be written fast."""

LONGEST_NAME = 200
"""Bytes of a frame's name that stand in a file's name, which most file systems limit to 255."""


def name_part(frame: str) -> str:
    """A frame's name as a part of a file's name: as it is, or, where it is long or has characters that cannot be
    printed, its begin without these and a checksum of all of it."""
    data = frame.encode("utf-8", "backslashreplace")
    if frame.isprintable() and len(data) <= LONGEST_NAME:
        return frame
    begin = data[:LONGEST_NAME - 9].decode("utf-8", "ignore")
    return f"{''.join(c for c in begin if c.isprintable())}-{zlib.crc32(data):08x}"


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write a file to that takes the place of `path` at the end; after an error it is removed instead.

    Its name ends as `path` does, for writers that choose the format by it.
    """
    half = path.with_name(f"{UNFINISHED}{path.name}")
    try:
        yield half
        with half.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(half, path)
    except OSError as error:
        half.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from error
    except BaseException:
        half.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def own_bytes(path: Path) -> bytes:
    """The bytes of a file of one's own.

    Raises:
        OSError: if there is none, it cannot be read, or a pipe or device is in its place, whose bytes may never end.
    """
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "not a file", str(path))
    return path.read_bytes()


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file as a whole.

    Raises:
        OSError: if it cannot be written, with `path` as its file name.
    """
    with replacing(path) as half:
        half.write_bytes(data)


def real_path(path: str | Path) -> Path:
    """The whole path, links followed; of a loop of links, as far as it goes (`Path.resolve` fails there)."""
    return Path(os.path.realpath(path))


def write_text(path: Path, text: str) -> None:
    """Write a text file as a whole, in UTF-8; what names of files have that is none is written as `\\udcff`."""
    write_bytes(path, text.encode(errors="backslashreplace"))


def write_picture(path: Path, picture: NDArray[Any], compression: int = FAST) -> None:
    """Write a picture as a whole, in the format of the path's ending; `compression` is zlib's, 0 to 9, for a PNG.

    Args:
        path: of the file.
        picture: (H, W) or (H, W, 3) blue, green, red; uint8, or another type that the format holds.
        compression: of a PNG.

    Raises:
        OSError: if it cannot be written, with `path` as its file name.
        ValueError: if the format does not hold such a picture.
    """
    write_bytes(path, _encoded(picture, path.suffix, compression))


def png(picture: Image, compression: int = FAST) -> bytes:
    """A picture, uint8 (H, W) or (H, W, 3), as the bytes of a PNG; `compression` is zlib's, 0 to 9."""
    return _encoded(picture, ".png", compression)


def _encoded(picture: NDArray[Any], ending: str, compression: int) -> bytes:
    options = [cv2.IMWRITE_PNG_COMPRESSION, compression] if ending == ".png" else []
    if options and compression <= FAST:  # trying every filter on every row takes longer than compressing it
        options += [cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_UP]
    refused = ValueError(f"a picture of shape {picture.shape} and type {picture.dtype} cannot be made a {ending} file")
    try:
        done, data = cv2.imencode(ending, picture, options)
    except cv2.error as error:
        raise refused from error
    if not done:
        raise refused
    return bytes(data.tobytes())


def decode_png(data: bytes) -> Image | None:
    """The picture of a PNG's bytes, 8 bits a channel; None if there is none."""
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    return None if picture is None or picture.dtype != np.uint8 else np.asarray(picture, np.uint8)


def sync_folder(folder: Path) -> None:
    """Let the names of a folder's files reach the disk, where the file system can."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    except OSError:
        pass
    finally:
        os.close(handle)
