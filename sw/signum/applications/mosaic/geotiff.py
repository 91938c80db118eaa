# SPDX-License-Identifier: Apache-2.0
"""Writes a mosaic with its place on the ground: world file, GeoTIFF with overviews.

GeoTIFF 1.1 (OGC 19-008): ModelPixelScale, ModelTiepoint and the GeoKeys that define the numbers, which describe a
mosaic that is north up fully. Overviews are pages of reduced resolution behind the full one, each of half the size.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import tifffile

from signum.applications.mosaic.blend import Mosaic
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
    kind: dict[str, Any] = {"photometric": "minisblack" if picture.ndim == 2 else "rgb", "compression": "zlib",
                            "tile": (TILE, TILE), "metadata": None}
    no_data = (NO_DATA, "s", 0, "0", True)
    with replacing(path) as half:
        with tifffile.TiffWriter(half, bigtiff=picture.nbytes > 2_500_000_000 and not cog) as file:
            file.write(picture, extratags=[*_ground_tags(mosaic, geo), no_data], **kind)
            for smaller in overviews(picture):
                file.write(smaller, subfiletype=1, extratags=[no_data], **kind)
        if cog:
            half.write_bytes(arrange(half.read_bytes()))


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
    """A picture, uint8 (H, W) or (H, W, 3), at half its size, at a quarter and so on until it fits into a tile.

    A pixel is the mean of the up to four that it covers, without those where there is no picture, which are 0.
    """
    while max(picture.shape[:2]) > TILE:
        size = tuple((side + 1) // 2 for side in picture.shape[:2])
        total, count = np.zeros((*size, *picture.shape[2:]), np.uint16), np.zeros(size, np.uint16)
        for down, right in ((0, 0), (0, 1), (1, 0), (1, 1)):
            part = picture[down::2, right::2]
            here = slice(part.shape[0]), slice(part.shape[1])
            total[here] += part
            count[here] += part > 0 if part.ndim == 2 else (part > 0).any(axis=2)
        number = np.maximum(count, 1) if picture.ndim == 2 else np.maximum(count, 1)[:, :, None]
        picture = ((total + number // 2) // number).astype(np.uint8)
        yield picture
