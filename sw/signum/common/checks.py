# SPDX-License-Identifier: Apache-2.0
"""The checks that every input passes at the border: regular file, size, finite, range, shape, pixels.

Each raises one line that names the input, the field and what is expected, and is the only place where its rule is
written; readers of files and the command line call these.
"""

from __future__ import annotations

import math
import os
import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

import numpy as np

from signum.common.arrays import Floats
from signum.common.errors import SignumError

MEGAPIXELS = 200.0
"""Default limit of a picture's size, millions of pixels."""
LARGEST_NUMBER = 1e9
"""Largest magnitude of a number on the command line."""
LONGEST_TEXT = 4096
"""Characters of a text on the command line."""
TEXT_BYTES = 1 << 20
"""Bytes of a small text file, such as a calibration."""
TABLE_BYTES = 1 << 28
"""Bytes of a CSV table."""

_limit: ContextVar[float] = ContextVar("megapixels", default=MEGAPIXELS)


@contextmanager
def megapixels(limit: float) -> Iterator[None]:
    """Set the limit of a picture's size, millions of pixels, for what runs inside."""
    token = _limit.set(limit)
    try:
        yield
    finally:
        _limit.reset(token)


def check_pixels(width: int, height: int, label: str, error: type[SignumError] = SignumError) -> None:
    """Check the size of a picture before it is decoded.

    Raises:
        SignumError: of type `error`, if a side is below 1 or there are more pixels than the limit.
    """
    if width < 1 or height < 1:
        raise error(f"{label}: a picture of {width}x{height} pixels; expected a width and a height of 1 or more")
    if width * height > 1e6 * _limit.get():
        raise error(f"{label}: {width}x{height} are {width * height / 1e6:.0f} megapixels, the limit is "
                    f"{_limit.get():g}; if that is meant, lift it with --megapixels")


def check_file(path: Path, what: str, error: type[SignumError] = SignumError, most: int | None = None) -> int:
    """Check that a path is a regular file that is not empty, without opening it; returns its size in bytes.

    Args:
        path: of the file; links are followed.
        what: the kind of file in the message, such as "calibration".
        error: type of the error.
        most: largest size, bytes; None for any.

    Raises:
        SignumError: of type `error`, if there is none, it is a folder, pipe, device or socket, or its size is wrong.
    """
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        raise error(f"{path}: no such file; check the spelling (expected: {what})") from None
    except OSError as reason:
        raise error(f"{path}: {reason.strerror}; give a {what} file that can be read") from reason
    except ValueError as reason:
        raise error(f"{path}: {reason}; give a {what} file") from reason
    if not stat.S_ISREG(found.st_mode):
        raise error(f"{path}: {_kind(found.st_mode)}; expected a {what} file")
    if not found.st_size:
        raise error(f"{path}: the file is empty; copy or record it again")
    if most is not None and found.st_size > most:
        raise error(f"{path}: {found.st_size} bytes; expected a {what} file of at most {most}")
    return found.st_size


def read_bytes(path: Path, what: str, error: type[SignumError] = SignumError, most: int | None = None) -> bytes:
    """The bytes of a regular file; see `check_file`.

    Raises:
        SignumError: of type `error`, if it is no such file, or cannot be read.
    """
    check_file(path, what, error, most)
    try:
        # Without blocking, as a pipe may have taken the file's place since the check.
        with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
            return file.read()
    except OSError as reason:
        raise error(f"{path}: {reason.strerror}; give a {what} file that can be read") from reason


def read_text(path: Path, what: str, error: type[SignumError] = SignumError, most: int = TEXT_BYTES) -> str:
    """The text of a regular file in UTF-8, with or without a byte order mark; see `check_file`.

    Raises:
        SignumError: of type `error`, if it is no such file, or no text.
    """
    data = read_bytes(path, what, error, most)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as reason:
        raise error(f"{path}: byte {reason.start} is not UTF-8; expected a {what} as text") from reason
    if "\0" in text:
        raise error(f"{path}: byte {text.index(chr(0))} is zero; expected a {what} as text")
    return text


def number(text: str, label: str, low: float, high: float, error: type[SignumError] = SignumError) -> float:
    """A finite number from `low` to `high`, of a text.

    Raises:
        SignumError: of type `error`, if it is none.
    """
    try:
        value = float(text)
    except ValueError:
        raise error(f"{label} is {text!r}; expected a number from {low:g} to {high:g}, with a point") from None
    return within(value, label, low, high, error)


def within(value: float, label: str, low: float, high: float, error: type[SignumError] = SignumError) -> float:
    """A number that is finite and from `low` to `high`.

    Raises:
        SignumError: of type `error`, if it is not.
    """
    if not (math.isfinite(value) and low <= value <= high):
        raise error(f"{label} is {value:g}; expected a number from {low:g} to {high:g}")
    return value


def array(values: Floats, label: str, shapes: Sequence[tuple[int, ...]], largest: float,
          error: type[SignumError] = SignumError) -> Floats:
    """An array of one of the shapes, with finite entries of magnitude up to `largest`.

    Raises:
        SignumError: of type `error`, if it is not.
    """
    if values.shape not in shapes:
        expected = " or ".join("x".join(map(str, shape)) for shape in shapes)
        raise error(f"{label} has shape {'x'.join(map(str, values.shape)) or 'of a number'}; expected {expected}")
    bad = ~(np.abs(values) <= largest)
    if bad.any():
        raise error(f"{label} contains {values[bad].flat[0]:g}; expected finite numbers up to {largest:g}")
    return values


def option(value: object, name: str) -> None:
    """Check a value of the command line: numbers are finite and of a sensible size, texts short and printable as such.

    Raises:
        SignumError: if it is not.
    """
    if isinstance(value, bool):
        return
    if isinstance(value, int | float):
        huge = isinstance(value, int) and abs(value) > sys.float_info.max
        within(math.inf if huge else float(value), name, -LARGEST_NUMBER, LARGEST_NUMBER)
    if isinstance(value, str | Path):
        text = str(value)
        if "\0" in text or len(text) > LONGEST_TEXT:
            raise SignumError(f"{name}: a text with a zero byte or of more than {LONGEST_TEXT} characters; "
                              "expected a name")


def printable(text: str) -> str:
    """A text without what is no character or would steer a terminal: control characters and bytes of a file name that
    are not UTF-8 become escapes such as `\\x1b`; line breaks and tabs stay."""
    return text if text.isprintable() else "".join(map(_shown, text))


def _shown(character: str) -> str:
    if character.isprintable() or character in "\n\t":
        return character
    if "\udc80" <= character <= "\udcff":  # how Python reads a byte of a file name that is not UTF-8
        return f"\\x{ord(character) - 0xdc00:02x}"
    return character.encode("unicode_escape").decode()


def _kind(mode: int) -> str:
    for test, name in ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"),
                       (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device")):
        if test(mode):
            return name
    return "no regular file"
