# SPDX-License-Identifier: Apache-2.0
"""Where on earth a mosaic is: scale from the camera's range, place from a navigation log; world files and GeoTIFF.

GeoTIFF 1.1 (OGC 19-008): ModelPixelScale, ModelTiepoint and the GeoKeys that define the numbers. The mosaic is
turned north up where north is known, so that these tags describe it fully.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tifffile

from signum.applications.mosaic.accuracy import Track, align
from signum.applications.mosaic.blend import Mosaic
from signum.applications.mosaic.pose import Pose
from signum.common.arrays import Complexes, Image
from signum.common.errors import SignumError
from signum.common.files import replacing, write_text
from signum.geometry.similarity import Similarity

PIXEL_SCALE, TIEPOINT, GEO_KEYS, GEO_TEXT, NO_DATA = 33550, 33922, 34735, 34737, 42113
"""TIFF tags: ModelPixelScaleTag, ModelTiepointTag, GeoKeyDirectoryTag, GeoAsciiParamsTag, GDAL_NODATA."""
MODEL_TYPE, RASTER_TYPE, CITATION, PROJECTED, UNITS = 1024, 1025, 1026, 3072, 3076
"""GeoKeys: GTModelType, GTRasterType, GTCitation, ProjectedCRS, ProjLinearUnits."""
PROJECTED_MODEL, PIXEL_IS_AREA, USER_DEFINED, METRE = 1, 1, 32767, 9001
"""Values of GeoKeys."""
OUTLIER = 3.0
"""Factor of the usual distance beyond which a fix is left out."""
PAIRED = 40
"""Most fixes of which all pairs are tried."""


@dataclass(frozen=True)
class Georeference:
    """The mosaic plane on the ground.

    Attributes:
        onto: pixels of the mosaic plane -> metres, east and south (y down).
        known: what is known, for the file's citation: "local" metres from the first frame, or the log's coordinates.
        epsg: code of the projected reference system; 0 where none is given.
        residual_m: root-mean-square distance of the frames from their logged places; 0 without a log.
    """

    onto: Similarity
    known: str
    epsg: int = 0
    residual_m: float = 0.0

    @property
    def upright(self) -> Similarity:
        """Mosaic plane -> the same turned north up, still in pixels."""
        return Similarity(self.onto.factor / abs(self.onto.factor))

    @property
    def pixel_m(self) -> float:
        """Metres a pixel of the mosaic plane covers."""
        return self.onto.scale


def ground_by_range(range_m: float, focal_px: float, centre: tuple[float, float]) -> Georeference:
    """Scale from the camera's range and focal length; metres east and north of the first frame's centre, its up being
    north.

    Args:
        range_m: from camera to seabed at the first frame, metres.
        focal_px: pixels of the original frames.
        centre: of the first frame, pixels.
    """
    metres = range_m / focal_px
    return Georeference(Similarity(complex(metres), -metres * complex(*centre)), "local, metres from the first frame")


def ground_by_log(poses: list[Pose], log: Track, epsg: int = 0) -> Georeference:
    """Scale, rotation and place from a navigation log, without outlying fixes.

    Raises:
        SignumError: if it has positions for fewer than two of the frames, or is in pixels.
    """
    known = [p for p in poses if p.frame in log.positions]
    if log.unit != "m":
        raise SignumError("the navigation log gives pixels: it needs metres, columns east_m and north_m")
    if len(known) < 2:
        raise SignumError(f"the navigation log has positions for {len(known)} of the placed frames, two are needed: "
                          f"its frames are called {', '.join(list(log.positions)[:3])}, ..., those of the mosaic "
                          f"{', '.join(p.frame for p in poses[:3])}, ...")
    z = np.array([complex(p.x_px, p.y_px) for p in known])
    w = np.array([log.positions[p.frame] for p in known])
    onto = _least_median(z, w)
    for _ in range(10):
        off = np.abs(onto.factor * z + onto.shift - w)
        good = off <= OUTLIER * max(1.4826 * float(np.median(off)), 1e-9)
        better = align(z[good], w[good])
        if better == onto:
            break
        onto = better
    if not 1e-9 < onto.scale < 1e9:
        raise SignumError("the navigation log and the mosaic have no scale in common: the frames lie at one place in "
                          "one of them; expected fixes that are apart")
    off = np.abs(onto.factor * z + onto.shift - w)[good]
    return Georeference(onto, "navigation log, metres", epsg, float(np.sqrt(np.mean(off**2))))


def _least_median(z: Complexes, w: Complexes) -> Similarity:
    """The similarity through two points whose median miss is is least: up to half of the fixes may be wrong."""
    chosen = np.unique(np.linspace(0, len(z) - 1, min(len(z), PAIRED)).astype(int))
    best, least = align(z, w), np.inf
    for i in chosen:
        for j in chosen[chosen > i]:
            if z[i] != z[j] and w[i] != w[j]:
                factor = complex((w[j] - w[i]) / (z[j] - z[i]))
                miss = float(np.median(np.abs(factor * (z - z[i]) - (w - w[i]))))
                if miss < least:
                    best, least = Similarity(factor, complex(w[i] - factor * z[i])), miss
    return best


def world_of(mosaic: Mosaic, geo: Georeference) -> tuple[float, float, float]:
    """Metres a pixel, and east and north of the centre of the top left pixel, of a mosaic made in the upright plane."""
    step = geo.pixel_m / mosaic.scale
    corner = geo.onto.factor / geo.upright.factor * complex(*mosaic.origin) + geo.onto.shift
    return step, corner.real, -corner.imag


def write_world_file(path: Path, mosaic: Mosaic, geo: Georeference) -> None:
    """The six numbers that go beside a PNG (`.pgw`)."""
    step, east, north = world_of(mosaic, geo)
    write_text(path, "".join(f"{v:.10f}\n" for v in (step, 0.0, 0.0, -step, east, north)))


def write_geotiff(path: Path, mosaic: Mosaic, geo: Georeference) -> None:
    """Write a mosaic made in the upright plane, with its scale and origin."""
    step, east, north = world_of(mosaic, geo)
    citation = f"{geo.known}|"
    system = geo.epsg or USER_DEFINED
    keys = [(MODEL_TYPE, 0, 1, PROJECTED_MODEL), (RASTER_TYPE, 0, 1, PIXEL_IS_AREA),
            (CITATION, GEO_TEXT, len(citation), 0), (PROJECTED, 0, 1, system), (UNITS, 0, 1, METRE)]
    directory = (1, 1, 1, len(keys), *(value for key in keys for value in key))
    # An area's pixel (0, 0) begins half a pixel before its centre.
    tie = (0.0, 0.0, 0.0, east - step / 2, north + step / 2, 0.0)
    picture: Image = mosaic.picture if mosaic.picture.ndim == 2 else np.ascontiguousarray(mosaic.picture[:, :, ::-1])
    with replacing(path) as half:
        tifffile.imwrite(
            half, picture, photometric="minisblack" if picture.ndim == 2 else "rgb", compression="zlib",
            tile=(256, 256), bigtiff=picture.nbytes > 3_000_000_000, metadata=None,
            extratags=[(PIXEL_SCALE, "d", 3, (step, step, 0.0), True), (TIEPOINT, "d", 6, tie, True),
                       (GEO_KEYS, "H", len(directory), directory, True), (GEO_TEXT, "s", 0, citation, True),
                       (NO_DATA, "s", 0, "0", True)])
