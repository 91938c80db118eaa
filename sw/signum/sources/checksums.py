# SPDX-License-Identifier: Apache-2.0
"""The checksums of an MCAP file beside those of its chunks, which its reader verifies (mcap.dev/spec).

A checksum of 0 means that the file carries none.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import BinaryIO

from signum.common.errors import SourceError

MAGIC = b"\x89MCAP0\r\n"
FOOTER, ATTACHMENT, DATA_END = 0x02, 0x09, 0x0F
"""Opcodes of records."""
FOOTER_BYTES = 1 + 8 + 20
BLOCK = 1 << 20


def verify_mcap(path: Path) -> None:
    """Verify the checksums of the data section, the summary and the attachments; a file without them is not read.

    Raises:
        SourceError: if one does not agree.
    """
    with path.open("rb") as file:
        size = file.seek(0, 2)
        if size < 2 * len(MAGIC) + FOOTER_BYTES:
            return  # the reader says what is wrong
        footer = size - len(MAGIC) - FOOTER_BYTES
        file.seek(footer)
        opcode, length, summary, _, crc = struct.unpack("<BQQQI", file.read(FOOTER_BYTES))
        if opcode != FOOTER or length != 20:
            return
        # Its own checksum is the only part of the footer that the summary's leaves out.
        if crc and not (0 < summary <= footer and crc == _crc(file, summary, footer + FOOTER_BYTES - 4)):
            raise SourceError(_line(path, "summary"))
        _verify_records(path, file, summary or footer)


def _verify_records(path: Path, file: BinaryIO, end: int) -> None:
    """Verify attachments and the data section, whose records lie before `end`."""
    at = len(MAGIC)
    while at + 9 <= end:
        file.seek(at)
        opcode, length = struct.unpack("<BQ", file.read(9))
        after = at + 9 + length
        if after > end:
            return
        if opcode == DATA_END and length == 4:
            crc = int.from_bytes(file.read(4), "little")
            if crc and crc != _crc(file, 0, at):
                raise SourceError(_line(path, "data"))
            return
        if opcode == ATTACHMENT and length > 4:
            file.seek(after - 4)
            crc = int.from_bytes(file.read(4), "little")
            if crc and crc != _crc(file, at + 9, after - 4):
                raise SourceError(_line(path, "an attachment"))
        at = after


def _crc(file: BinaryIO, start: int, end: int) -> int:
    """CRC-32 of the bytes from `start` to before `end`."""
    crc = 0
    file.seek(start)
    while start < end:
        block = file.read(min(BLOCK, end - start))
        if not block:
            break
        crc, start = zlib.crc32(block, crc), start + len(block)
    return crc


def _line(path: Path, part: str) -> str:
    return (f"{path}: the checksum of {part} does not agree: the file is damaged; copy it again, or mend it with "
            "`mcap recover`")
