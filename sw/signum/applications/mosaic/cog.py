# SPDX-License-Identifier: Apache-2.0
"""Lays a tiled TIFF out as a Cloud Optimized GeoTIFF (OGC 21-026), of which a reader fetches only what it shows.

    header, GDAL's note on the layout
    directory of the full picture, its values; those of the overviews, each smaller than the one before
    tiles of the smallest overview, ..., tiles of the full picture, from the top left

Tiles, tags and values are those of the given file; only their places change.
"""

from __future__ import annotations

import io
import struct
from dataclasses import dataclass

import tifffile

TILE_OFFSETS, TILE_BYTE_COUNTS = 324, 325
LONG = 4
"""TIFF type of 32 bits."""
NOTE = ("LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\nBLOCK_LEADER=SIZE_AS_UINT4\n"
        "BLOCK_TRAILER=LAST_4_BYTES_REPEATED\nKNOWN_INCOMPATIBLE_EDITION=NO\n ")
"""What GDAL looks for behind the header; a program that edits the file in place has room to write YES."""
LEADER = 4
"""Bytes before and behind a tile: its size, by which a reader fetches it without its directory's arrays, and its last
four bytes again, by which it sees whether the tile has been changed in place."""
ENTRY = 12
"""Bytes of a directory's entry."""


@dataclass(frozen=True)
class _Page:
    """A directory: tag, type, count and bytes of each value but those of the tiles' places; the tiles."""

    entries: list[tuple[int, int, int, bytes]]
    tiles: list[bytes]

    def size(self) -> int:
        """Bytes of the directory and its values, even."""
        values = (*(value for *_, value in self.entries), *[bytes(4 * len(self.tiles))] * 2)
        return 2 + ENTRY * len(values) + 4 + sum(_even(len(v)) for v in values if len(v) > 4)

    def packed(self, at: int, after: int, offsets: list[int]) -> bytes:
        """The directory and its values.

        Args:
            at: where it begins in the file.
            after: where the next one begins; 0 for none.
            offsets: of the tiles.
        """
        count = len(self.tiles)
        places = [(TILE_OFFSETS, LONG, count, struct.pack(f"<{count}I", *offsets)),
                  (TILE_BYTE_COUNTS, LONG, count, struct.pack(f"<{count}I", *map(len, self.tiles)))]
        entries = sorted([*self.entries, *places])
        head, values = struct.pack("<H", len(entries)), b""
        free = at + 2 + ENTRY * len(entries) + 4
        for code, kind, number, value in entries:
            if len(value) > 4:
                where, values = struct.pack("<I", free + len(values)), values + value.ljust(_even(len(value)), b"\0")
            else:
                where = value.ljust(4, b"\0")
            head += struct.pack("<HHI", code, kind, number) + where
        return head + struct.pack("<I", after) + values


def arrange(data: bytes) -> bytes:
    """A little-endian classic TIFF of tiled pages, the full picture first, as a Cloud Optimized GeoTIFF.

    Raises:
        ValueError: if it is no such file.
    """
    pages = _pages(data)
    head = f"GDAL_STRUCTURAL_METADATA_SIZE={len(NOTE):06d} bytes\n{NOTE}".encode()
    starts = [_even(8 + len(head))]
    for page in pages:
        starts.append(starts[-1] + page.size())
    offsets: list[list[int]] = [[] for _ in pages]
    free = starts[-1]
    for page, places in zip(reversed(pages), reversed(offsets), strict=True):
        for tile in page.tiles:
            places.append(free + LEADER)
            free += len(tile) + 2 * LEADER
    out = io.BytesIO()
    out.write((struct.pack("<2sHI", b"II", 42, starts[0]) + head).ljust(starts[0], b"\0"))
    for k, page in enumerate(pages):
        out.write(page.packed(starts[k], starts[k + 1] if k + 1 < len(pages) else 0, offsets[k]))
    for page in reversed(pages):
        for tile in page.tiles:
            out.write(struct.pack("<I", len(tile)) + tile + tile[-LEADER:])
    return out.getvalue()


def _pages(data: bytes) -> list[_Page]:
    found = []
    with tifffile.TiffFile(io.BytesIO(data)) as file:
        if file.byteorder != "<" or file.is_bigtiff:
            raise ValueError("no little-endian classic TIFF")
        for page in file.pages:
            if not isinstance(page, tifffile.TiffPage) or not page.is_tiled:
                raise ValueError("a page without tiles")
            entries = []
            for tag in page.tags.values():
                if tag.code not in (TILE_OFFSETS, TILE_BYTE_COUNTS):
                    length = tag.count * struct.calcsize(tifffile.TIFF.DATA_FORMATS[tag.dtype])
                    entries.append((int(tag.code), int(tag.dtype), int(tag.count),
                                    data[tag.valueoffset:tag.valueoffset + length]))
            tiles = [data[at:at + size] for at, size in zip(page.dataoffsets, page.databytecounts, strict=True)]
            found.append(_Page(entries, tiles))
    return found


def _even(number: int) -> int:
    return number + number % 2
