# SPDX-License-Identifier: Apache-2.0
"""Writes a mosaic with its place on the ground: world file, GeoTIFF with overviews.

GeoTIFF 1.1 (OGC 19-008): ModelPixelScale, ModelTiepoint and the GeoKeys that define the numbers, which describe a
mosaic that is north up fully. Overviews are pages of reduced resolution behind the full one, each of half the size.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import tifffile

from signum.applications.mosaic.blend import BLOCK, Mosaic
from signum.applications.mosaic.blocks import BlockSource, Spill, halve
from signum.applications.mosaic.cog import arrange
from signum.applications.mosaic.georeference import Georeference, world_of
from signum.common.arrays import Image
from signum.common.files import replacing, write_text

PIXEL_SCALE, TIEPOINT, GEO_KEYS, GEO_TEXT, NO_DATA = 33550, 33922, 34735, 34737, 42113
"""TIFF tags: ModelPixelScaleTag, ModelTiepointTag, GeoKeyDirectoryTag, GeoAsciiParamsTag, GDAL_NODATA."""
MODEL_TYPE, RASTER_TYPE, CITATION, PROJECTED, UNITS = 1024, 1025, 1026, 3072, 3076
"""GeoKeys: GTModelType, GTRasterType, GTCitation, ProjectedCRS, ProjLinearUnits."""
PROJECTED_MODEL, PIXEL_IS_AREA, USER_DEFINED, METRE = 1, 1, 32767, 9001
"""Values of GeoKeys."""
TILE = 256
"""Side of the tiles, pixels; the smallest overview fits into one."""
CLASSIC_BYTES = 2_500_000_000
"""From this size of the picture on, uncompressed, the file is a BigTIFF, whose offsets have 64 bits."""


def write_world_file(path: Path, mosaic: Mosaic, geo: Georeference) -> None:
    """The six numbers that go beside a PNG (`.pgw`)."""
    step, east, north = world_of(mosaic, geo)
    write_text(path, "".join(f"{v:.10f}\n" for v in (step, 0.0, 0.0, -step, east, north)))


def write_geotiff(path: Path, mosaic: Mosaic, geo: Georeference, cog: bool = False) -> None:
    """Write a mosaic made in the upright plane, with its scale, origin and overviews.

    Args:
        path: of the file.
        mosaic: the picture; 0 is where there is none.
        geo: its place.
        cog: lay the file out as a Cloud Optimized GeoTIFF; see `cog.arrange`.
    """
    picture: Image = mosaic.picture if mosaic.picture.ndim == 2 else np.ascontiguousarray(mosaic.picture[:, :, ::-1])
    _write(path, ((level, level.shape) for level in (picture, *overviews(picture))), _ground_tags(mosaic, geo), cog,
           picture.nbytes)


def write_geotiff_blocks(path: Path, source: BlockSource, geo: Georeference, cog: bool = False, block: int = BLOCK
                         ) -> None:
    """The same of a mosaic that is made block by block, in memory for a few rows of blocks; for a while the disk holds
    the mosaic uncompressed.

    Args:
        path: of the file.
        source: of the picture.
        geo: its place.
        cog: see `write_geotiff`.
        block: side of the blocks, pixels.
    """
    def levels() -> Iterator[tuple[Iterator[Image], tuple[int, ...]]]:
        level = Spill.of(source, path.parent, block)
        while True:
            with level:
                yield level.tiles(TILE), level.shape
                if max(level.shape[:2]) <= TILE:
                    return
                smaller = level.halved(path.parent)
            level = smaller

    pixels = source.size[0] * source.size[1] * (1 if source.grey else 3)
    _write(path, levels(), _ground_tags(extent_of(source), geo), cog, pixels)


def extent_of(source: BlockSource) -> Mosaic:
    """A mosaic of its size and place, without its picture."""
    return Mosaic(np.broadcast_to(np.zeros((), np.uint8), source.size[::-1]), source.origin, source.scale)


def _write(path: Path, levels: Iterable[tuple[Image | Iterator[Image], tuple[int, ...]]],
           tags: list[tuple[int, str, int, Any, bool]], cog: bool, size: int) -> None:
    """Write the picture and its overviews.

    Args:
        path: of the file.
        levels: the picture, or its tiles, and its shape; its overviews.
        tags: of the picture's place.
        cog: see `write_geotiff`.
        size: bytes of the picture, uncompressed.
    """
    no_data = (NO_DATA, "s", 0, "0", True)
    with replacing(path) as half:
        flat = half.with_name(f"{half.name}.flat") if cog else half
        try:
            with tifffile.TiffWriter(flat, bigtiff=size > CLASSIC_BYTES) as file:
                for number, (data, shape) in enumerate(levels):
                    file.write(data, shape=shape, dtype=np.uint8, tile=(TILE, TILE), compression="zlib", metadata=None,
                               photometric="minisblack" if len(shape) == 2 else "rgb", subfiletype=int(number > 0),
                               extratags=[no_data] if number else [*tags, no_data], maxworkers=1)
            if cog:
                arrange(flat, half)
        finally:
            if cog:
                flat.unlink(missing_ok=True)


def _ground_tags(mosaic: Mosaic, geo: Georeference) -> list[tuple[int, str, int, Any, bool]]:
    step, east, north = world_of(mosaic, geo)
    citation = f"{geo.known}|"
    keys = [(MODEL_TYPE, 0, 1, PROJECTED_MODEL), (RASTER_TYPE, 0, 1, PIXEL_IS_AREA),
            (CITATION, GEO_TEXT, len(citation), 0), (PROJECTED, 0, 1, geo.epsg or USER_DEFINED), (UNITS, 0, 1, METRE)]
    directory = (1, 1, 1, len(keys), *(value for key in keys for value in key))
    # An area's pixel (0, 0) begins half a pixel before its centre.
    tie = (0.0, 0.0, 0.0, east - step / 2, north + step / 2, 0.0)
    return [(PIXEL_SCALE, "d", 3, (step, step, 0.0), True), (TIEPOINT, "d", 6, tie, True),
            (GEO_KEYS, "H", len(directory), directory, True), (GEO_TEXT, "s", 0, citation, True)]


def overviews(picture: Image) -> Iterator[Image]:
    """A picture, uint8 (H, W) or (H, W, 3), at half its size, at a quarter and so on until it fits into a tile; see
    `halve`."""
    while max(picture.shape[:2]) > TILE:
        picture = halve(picture)
        yield picture
