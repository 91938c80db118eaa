# SPDX-License-Identifier: Apache-2.0
"""GeoTIFFs as an independent reader, rasterio (GDAL), finds them: picture, place, overviews, layout of a COG."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio

from signum.applications.mosaic.blend import Mosaic
from signum.applications.mosaic.georeference import Georeference
from signum.applications.mosaic.geotiff import overviews, write_geotiff, write_geotiff_blocks
from signum.common.arrays import Image
from signum.geometry.similarity import Similarity

LARGE = """
import resource, sys
from pathlib import Path
import numpy as np
from tests.applications.mosaic.test_geotiff import GEO, Parts, write_geotiff_blocks

class Endless(Parts):
    def block(self, box):
        left, top, right, bottom = box
        if (left // 1024 + top // 1024) % 3 == 0:
            return None
        x, y = np.arange(left, right), np.arange(top, bottom)
        return np.repeat(((x[None] // 64 + y[:, None] // 64) % 200 + 1).astype(np.uint8)[:, :, None], 3, 2)

source = Endless(np.zeros((8, 8, 3), np.uint8))
source.size = 7000, 6001
write_geotiff_blocks(Path(sys.argv[1]), Endless(np.zeros((600, 700, 3), np.uint8)), GEO, True)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
soft = int(open("/proc/self/statm").read().split()[0]) * 4096 + 100_000_000
resource.setrlimit(resource.RLIMIT_AS, (soft, soft))
write_geotiff_blocks(Path(sys.argv[1]), source, GEO, True, 1024)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""
"""A mosaic of 126 MB in a process that may have 100 MB more than it has after a small one."""
GEO = Georeference(Similarity(0.01 + 0j, complex(690_000, -6_090_000)), "navigation log, metres", 32755)


class Parts:
    """A picture as a source of blocks; blue first."""

    origin, scale = (100.0, 200.0), 0.5

    def __init__(self, picture: Image) -> None:
        self.picture = picture
        self.size = picture.shape[1], picture.shape[0]
        self.grey = picture.ndim == 2

    def block(self, box: tuple[int, int, int, int]) -> Image | None:
        part = self.picture[box[1]:box[3], box[0]:box[2]]
        return part if part.any() else None


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


@pytest.mark.parametrize("cog", [False, True])
@pytest.mark.parametrize("shape", [(601, 1030, 3), (1030, 515), (60, 50, 3)])
def test_block_by_block_is_the_same_file(tmp_path: Path, shape: tuple[int, ...], cog: bool) -> None:
    picture = _picture(shape)
    write_geotiff(tmp_path / "whole.tif", Mosaic(picture, Parts.origin, Parts.scale), GEO, cog)
    write_geotiff_blocks(tmp_path / "parts.tif", Parts(picture), GEO, cog, 100)
    assert (tmp_path / "parts.tif").read_bytes() == (tmp_path / "whole.tif").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["parts.tif", "whole.tif"]


@pytest.mark.parametrize("cog", [False, True])
def test_beyond_32_bits(tmp_path: Path, cog: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signum.applications.mosaic.geotiff.CLASSIC_BYTES", 1000)
    picture = _picture((601, 1030, 3))
    write_geotiff_blocks(tmp_path / "m.tif", Parts(picture), GEO, cog, 256)
    assert (tmp_path / "m.tif").read_bytes()[:4] == b"II\x2b\x00"
    with rasterio.open(tmp_path / "m.tif") as file:
        assert np.array_equal(_seen(file.read()), picture) and file.overviews(1) == [2, 4, 8]
        assert (file.tags(ns="IMAGE_STRUCTURE").get("LAYOUT") == "COG") == cog
    with rasterio.open(tmp_path / "m.tif", overview_level=1) as file:
        assert np.array_equal(_seen(file.read()), list(overviews(picture))[1])


def test_a_mosaic_larger_than_memory(tmp_path: Path) -> None:
    """By a limit on the process's memory, and by what it had at most."""
    done = subprocess.run([sys.executable, "-c", LARGE, str(tmp_path / "m.tif")], capture_output=True, text=True,
                          check=False, env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    assert done.returncode == 0, done.stderr
    print(f"126 MB written with {int(done.stdout) / 1000:.0f} MB more than a small one")
    assert int(done.stdout) < 80_000
    with rasterio.open(tmp_path / "m.tif") as file:
        assert (file.width, file.height) == (7000, 6001) and file.overviews(1)[-1] == 32
        part = file.read(1, window=((5000, 5100), (6000, 6100)))
        x, y = np.arange(6000, 6100), np.arange(5000, 5100)
        expected = (x[None] // 64 + y[:, None] // 64) % 200 + 1
        hidden = (x[None] // 1024 + y[:, None] // 1024) % 3 == 0
        assert np.array_equal(part, np.where(hidden, 0, expected))
