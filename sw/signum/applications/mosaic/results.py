# SPDX-License-Identifier: Apache-2.0
"""What a survey writes for its user: the poses, and the mosaic, as it grows and at the end."""

from __future__ import annotations

import re
from collections.abc import Callable

import cv2
import numpy as np

from signum.applications.mosaic.blend import MOST_PIXELS, Composition, Told, compose, silent, sketch
from signum.applications.mosaic.georeference import Georeference, ground_lines, world_of
from signum.applications.mosaic.geotiff import extent_of, write_geotiff, write_geotiff_blocks, write_world_file
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.pose import Pose
from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.common.files import write_picture, write_text
from signum.geometry.similarity import IDENTITY
from signum.tables.schemas import GROUND, POSES
from signum.tables.table import csv_line

THUMB, LEAST_THUMB, THUMBS_BYTES = 240, 30, 48_000_000
"""Longer side of the copies the growing mosaic is made of, pixels; the least, and the memory for all of them, beyond
which they are made half as large."""
MOST_MAP_PIXELS = 20_000_000_000
"""Most pixels of a GeoTIFF, which is made block by block where `MOST_PIXELS` are too few; a larger one is made at a
smaller scale."""
Grounding = Callable[[list[Pose], tuple[float, float]], Georeference | None]
"""Finds where on the ground a component is, from its poses and the frames' centre in pixels."""


class Results:
    """Writes `poses.csv` and `mosaic.png`, and for further components `poses-2.csv`, `mosaic-2.png`, ...

    Args:
        ledger: the survey's.

    Attributes:
        ground: where given, the mosaics get world files and GeoTIFFs.
        cog: whether these are Cloud Optimized GeoTIFFs.
        water: whether the mosaics' colours are corrected for the water.
        told: hears of each picture that is blended.
        grounded: what there is to say of where the mosaics lie, a line each.
        trouble: why `ground` failed; empty if it did not.
    """

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger
        self.ground: Grounding | None = None
        self.cog = False
        self.water = False
        self.told: Told = silent
        self.grounded: list[str] = []
        self.trouble = ""
        self._sizes: list[str] = []
        self._planes: dict[int, Georeference] = {}
        self._thumbs: dict[str, Image] = {}
        self._side = THUMB

    def show(self, name: str, picture: Image | None = None) -> Image:
        """A stored frame's small copy for the growing mosaic; `picture` is the frame where it is at hand."""
        if name not in self._thumbs:
            self._thumbs[name] = _smaller(self._ledger.shelf.picture(name) if picture is None else picture, self._side)
            if len(self._thumbs) * self._thumbs[name].nbytes > THUMBS_BYTES and self._side > LEAST_THUMB:
                self._side //= 2
                self._thumbs = {other: _smaller(thumb, self._side) for other, thumb in self._thumbs.items()}
        return self._thumbs[name]

    def write_poses(self) -> None:
        """Write the poses of all pieces."""
        pieces = self._ledger.ranked()
        for number, piece in enumerate(pieces, 1):
            rows = POSES, *(pose.row for pose in self._ledger.poses(piece))
            write_text(self._ledger.shelf.make(f"poses{suffix(number)}.csv"), "".join(map(csv_line, rows)))
        self._drop(r"poses-(\d+)\.csv", set(range(1, len(pieces) + 1)))

    def write_growing(self) -> None:
        """Write the poses so far and a quick mosaic of the largest piece."""
        self.write_poses()
        piece = self._ledger.ranked()[0]
        picture = sketch([self.show(name) for name in piece.stored], [piece.places[n] for n in piece.stored],
                         self._ledger.size)
        write_picture(self._ledger.shelf.make("mosaic.png"), picture)

    def write_all(self) -> None:
        """Write the poses, and the mosaics of the largest component and of all others with more than one frame."""
        self.write_poses()
        self.trouble, self.grounded, self._sizes, self._planes = "", [], [], {}
        blended, grounded = set(), set()
        for number, piece in enumerate(self._ledger.ranked(), 1):
            if number == 1 or len(piece.stored) > 1:
                blended.add(number)
                geo = self._write_mosaic(piece, suffix(number))
                if geo is not None:
                    grounded.add(number)
                    self._planes[number] = geo
        self._write_ground()
        self._drop(r"mosaic(?:-(\d+))?\.png", blended)
        self._drop(r"mosaic(?:-(\d+))?\.(?:pgw|tif)", grounded)

    def _drop(self, pattern: str, numbers: set[int]) -> None:
        """Remove the files of an earlier state of the survey whose piece has not one of these numbers."""
        for name in sorted(self._ledger.shelf.made):
            found = re.fullmatch(pattern, name)
            if found and int(found[1] or 1) not in numbers:
                self._ledger.shelf.unmake(name)

    def _write_ground(self) -> None:
        """Write how the planes of the poses lie on the ground; nothing where no place is known."""
        rows = [[number, f"{geo.pixel_m:.9g}", f"{geo.onto.rot_deg:.5f}", f"{geo.onto.shift.real:.4f}",
                 f"{-geo.onto.shift.imag:.4f}", geo.epsg] for number, geo in sorted(self._planes.items())]
        if rows:
            write_text(self._ledger.shelf.make("ground.csv"), "".join(map(csv_line, [GROUND, *rows])))
        else:
            self._ledger.shelf.unmake("ground.csv")

    def _write_mosaic(self, piece: Piece, ending: str) -> Georeference | None:
        """Write a piece's mosaic; returns its place on the ground, if that is known."""
        ledger = self._ledger
        geo: Georeference | None = None
        if self.ground is not None:
            try:
                geo = self.ground(ledger.poses(piece), ledger.centre)
            except SignumError as error:
                of = f"mosaic{ending}.png, a component of {len(piece.frames)} frames: " if ending else ""
                self.trouble = self.trouble or f"{of}{error}"
        upright = geo.upright if geo else IDENTITY
        pictures = ledger.shelf.pictures(piece.stored)
        places = [upright @ piece.places[name] for name in piece.stored]
        mosaic = compose(pictures, places, MOST_PIXELS, told=self.told, water=self.water)
        make = ledger.shelf.make
        write_picture(make(f"mosaic{ending}.png"), mosaic.picture)
        if geo:
            write_world_file(make(f"mosaic{ending}.pgw"), mosaic, geo)
            path = make(f"mosaic{ending}.tif")
            mapped = mosaic
            if mosaic.scale == 1:
                write_geotiff(path, mosaic, geo, self.cog)
            else:  # the picture was too large, but the map need not fit into memory
                whole = Composition(pictures, places, MOST_MAP_PIXELS, self.told, self.water)
                write_geotiff_blocks(path, whole, geo, self.cog)
                mapped = extent_of(whole)
            self.grounded += ground_lines(str(path), mapped, geo)
        height, width = mosaic.picture.shape[:2]
        step = world_of(mosaic, geo)[0] if geo else 0.0
        self._sizes.append(f"mosaic{ending}.png {width}x{height} px"
                           + (f", {width * step:.2f} x {height * step:.2f} m" if geo else ""))
        return geo

    def size(self) -> str:
        """The sizes of the mosaics written, in words."""
        return "; ".join(self._sizes)


def _smaller(picture: Image, side: int) -> Image:
    """A copy with a longer side of at most `side` pixels."""
    less = side / max(picture.shape[:2])
    if less >= 1:
        return picture
    return np.asarray(cv2.resize(picture, None, fx=less, fy=less, interpolation=cv2.INTER_AREA), np.uint8)


def suffix(number: int) -> str:
    """Ending of the file names of a component: none for the first, "-2" for the second."""
    return "" if number == 1 else f"-{number}"
