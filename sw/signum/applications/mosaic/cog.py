# SPDX-License-Identifier: Apache-2.0
"""Lays a tiled TIFF out as a Cloud Optimized GeoTIFF (OGC 21-026), of which a reader fetches only what it shows.

    header, GDAL's note on the layout
    directory of the full picture, its values; those of the overviews, each smaller than the one before
    tiles of the smallest overview, ..., tiles of the full picture, from the top left

Tiles, tags and values are those of the given file; only their places change.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import tifffile

TILE_OFFSETS, TILE_BYTE_COUNTS = 324, 325
NOTE = ("LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\nBLOCK_LEADER=SIZE_AS_UINT4\n"
        "BLOCK_TRAILER=LAST_4_BYTES_REPEATED\nKNOWN_INCOMPATIBLE_EDITION=NO\n ")
"""What GDAL looks for behind the header; a program that edits the file in place has room to write YES."""
LEADER = 4
"""Bytes before and behind a tile: its size, by which a reader fetches it without its directory's arrays, and its last
four bytes again, by which it sees whether the tile has been changed in place."""


@dataclass(frozen=True)
class _Kind:
    """A TIFF of 32 or of 64 bits.

    Attributes:
        head: bytes of the header with the first directory's place.
        count: format of a directory's number of entries.
        entry: format of an entry's begin: tag, type, number of values.
        place: format of a place in the file, and of what an entry holds itself.
        places: TIFF type of such a number.
    """

    head: bytes
    count: str
    entry: str
    place: str
    places: int

    @property
    def width(self) -> int:
        """Bytes of a place."""
        return struct.calcsize(self.place)


CLASSIC = _Kind(struct.pack("<2sH", b"II", 42), "<H", "<HHI", "<I", 4)
BIG = _Kind(struct.pack("<2sHHH", b"II", 43, 8, 0), "<Q", "<HHQ", "<Q", 16)


@dataclass(frozen=True)
class _Page:
    """A directory: tag, type, count and bytes of each value but those of the tiles' places; where the tiles are."""

    kind: _Kind
    entries: list[tuple[int, int, int, bytes]]
    tiles: list[tuple[int, int]]

    def size(self) -> int:
        """Bytes of the directory and its values, even."""
        width = self.kind.width
        values = (*(value for *_, value in self.entries), *[bytes(width * len(self.tiles))] * 2)
        each = struct.calcsize(self.kind.entry) + width
        return (struct.calcsize(self.kind.count) + each * len(values) + width
                + sum(_even(len(v)) for v in values if len(v) > width))

    def packed(self, at: int, after: int, offsets: list[int]) -> bytes:
        """The directory and its values.

        Args:
            at: where it begins in the file.
            after: where the next one begins; 0 for none.
            offsets: of the tiles.
        """
        kind, number = self.kind, len(self.tiles)
        many = f"<{number}{kind.place[1:]}"
        places = [(TILE_OFFSETS, kind.places, number, struct.pack(many, *offsets)),
                  (TILE_BYTE_COUNTS, kind.places, number, struct.pack(many, *(size for _, size in self.tiles)))]
        entries = sorted([*self.entries, *places])
        head, values = struct.pack(kind.count, len(entries)), b""
        free = at + len(head) + (struct.calcsize(kind.entry) + kind.width) * len(entries) + kind.width
        for code, form, count, value in entries:
            if len(value) > kind.width:
                where = struct.pack(kind.place, free + len(values))
                values += value.ljust(_even(len(value)), b"\0")
            else:
                where = value.ljust(kind.width, b"\0")
            head += struct.pack(kind.entry, code, form, count) + where
        return head + struct.pack(kind.place, after) + values


def arrange(source: Path, target: Path) -> None:
    """Write a little-endian TIFF of tiled pages, the full picture first, as a Cloud Optimized GeoTIFF; one tile at a
    time is in memory.

    Raises:
        ValueError: if it is no such file.
    """
    with source.open("rb") as data, target.open("wb") as out:
        pages = _pages(data)
        kind = pages[0].kind
        note = f"GDAL_STRUCTURAL_METADATA_SIZE={len(NOTE):06d} bytes\n{NOTE}".encode()
        starts = [_even(len(kind.head) + kind.width + len(note))]
        for page in pages:
            starts.append(starts[-1] + page.size())
        offsets: list[list[int]] = [[] for _ in pages]
        free = starts[-1]
        for page, places in zip(reversed(pages), reversed(offsets), strict=True):
            for _, size in page.tiles:
                places.append(free + LEADER)
                free += size + 2 * LEADER
        out.write((kind.head + struct.pack(kind.place, starts[0]) + note).ljust(starts[0], b"\0"))
        for k, page in enumerate(pages):
            out.write(page.packed(starts[k], starts[k + 1] if k + 1 < len(pages) else 0, offsets[k]))
        for page in reversed(pages):
            for at, size in page.tiles:
                data.seek(at)
                tile = data.read(size)
                out.write(struct.pack("<I", size) + tile + tile[-LEADER:])


def _pages(data: BinaryIO) -> list[_Page]:
    found = []
    with tifffile.TiffFile(data) as file:
        if file.byteorder != "<":
            raise ValueError("no little-endian TIFF")
        kind = BIG if file.is_bigtiff else CLASSIC
        for page in file.pages:
            if not isinstance(page, tifffile.TiffPage) or not page.is_tiled:
                raise ValueError("a page without tiles")
            entries = []
            for tag in page.tags.values():
                if tag.code not in (TILE_OFFSETS, TILE_BYTE_COUNTS):
                    data.seek(tag.valueoffset)
                    value = data.read(tag.count * struct.calcsize(tifffile.TIFF.DATA_FORMATS[tag.dtype]))
                    entries.append((int(tag.code), int(tag.dtype), int(tag.count), value))
            found.append(_Page(kind, entries, list(zip(page.dataoffsets, page.databytecounts, strict=True))))
    return found


def _even(number: int) -> int:
    return number + number % 2
