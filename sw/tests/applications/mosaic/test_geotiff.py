# SPDX-License-Identifier: Apache-2.0
"""GeoTIFFs as an independent reader, rasterio (GDAL), finds them: picture, place, overviews, layout of a COG."""

from pathlib import Path

import numpy as np
import pytest
import rasterio

from signum.applications.mosaic.blend import Mosaic
from signum.applications.mosaic.georeference import Georeference
from signum.applications.mosaic.geotiff import overviews, write_geotiff
from signum.common.arrays import Image
from signum.geometry.similarity import Similarity

GEO = Georeference(Similarity(0.01 + 0j, complex(690_000, -6_090_000)), "navigation log, metres", 32755)


def _picture(shape: tuple[int, ...]) -> Image:
    """Values from 1, with a corner where there is no picture."""
    picture = np.random.default_rng(5).integers(1, 256, shape, dtype=np.uint8)
    picture[: shape[0] // 3, : shape[1] // 4] = 0
    return picture


@pytest.mark.parametrize("cog", [False, True])
@pytest.mark.parametrize("shape", [(601, 1030, 3), (1030, 515), (60, 50, 3)])
def test_read_by_another_program(tmp_path: Path, shape: tuple[int, ...], cog: bool) -> None:
    picture = _picture(shape)
    path = tmp_path / "m.tif"
    write_geotiff(path, Mosaic(picture, (100.0, 200.0), 0.5), GEO, cog)
    small = list(overviews(picture))
    with rasterio.open(path) as file:
        assert file.crs.to_epsg() == 32755 and file.nodata == 0 and file.dtypes == ("uint8",) * file.count
        # The top left pixel's centre is at (100, 200) of the plane, two of whose pixels it covers: 2 cm.
        assert tuple(file.transform)[:6] == pytest.approx((0.02, 0, 690_000.99, 0, -0.02, 6_089_998.01), abs=1e-6)
        assert np.array_equal(_seen(file.read()), picture)
        assert file.overviews(1) == [2 ** (k + 1) for k in range(len(small))]
        assert bool(small) == (max(shape) > 256)
        assert (file.tags(ns="IMAGE_STRUCTURE").get("LAYOUT") == "COG") == cog
        if small:
            levels = range(-1, len(small))
            asked = [{} if level < 0 else {"ovr": level} for level in levels]
            heads = [int(file.get_tag_item("IFD_OFFSET", "TIFF", bidx=1, **o)) for o in asked]
            tiles = [int(file.get_tag_item("BLOCK_OFFSET_0_0", "TIFF", bidx=1, **o)) for o in asked]
            # A COG by GDAL: directories first, from large to small, then the tiles, from small to large.
            orderly = heads == sorted(heads) and heads[0] < 300 and tiles == sorted(tiles, reverse=True)
            assert (orderly and heads[-1] < tiles[-1]) == cog
    for level, expected in enumerate(small):
        with rasterio.open(path, overview_level=level) as file:
            assert np.array_equal(_seen(file.read()), expected)


def _seen(bands: Image) -> Image:
    """Bands of a file, (n, H, W) red first, as a picture."""
    return bands[0] if len(bands) == 1 else np.moveaxis(bands, 0, -1)[:, :, ::-1]


def test_overviews_are_means_of_what_is_shown() -> None:
    picture = np.zeros((259, 300), np.uint8)
    picture[0, :4] = 10, 20, 0, 100
    picture[1, :4] = 31, 40, 0, 0
    picture[258, 299] = 77
    (half,) = overviews(picture)
    assert half.shape == (130, 150) and half[0, :2].tolist() == [25, 100] and half[129, 149] == 77
    assert np.count_nonzero(half) == 3
    colour = np.zeros((2, 400, 3), np.uint8)
    colour[0, 0], colour[1, 1] = (0, 0, 200), (0, 50, 100)
    (half,) = overviews(colour)
    assert half[0, 0].tolist() == [0, 25, 150]
