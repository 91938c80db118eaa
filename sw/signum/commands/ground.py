# SPDX-License-Identifier: Apache-2.0
"""The options of `signum mosaic` that give the mosaic its scale and its place on the ground."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from signum.applications.mosaic.georeference import ground_by_log, ground_by_range
from signum.applications.mosaic.results import Grounding
from signum.applications.mosaic.track import TimedTrack, Track, read_moment
from signum.applications.mosaic.track_reader import exif_track, read_navigation
from signum.common.errors import SignumError
from signum.frames.frame import Source
from signum.geometry.earth import system
from signum.sources.files import FolderSource, PictureSource, UndistortedSource
from signum.sources.open import open_lens

GROUND = "Scale and place on the ground"


@dataclass(frozen=True)
class GroundOptions:
    """How the mosaic finds its scale and its place on the ground."""

    range_m: Annotated[float | None, typer.Option(
        "--range", rich_help_panel=GROUND, min=0.01, help="Metres from camera to seabed at the first frame: gives the "
        "mosaic a scale; needs --focal or --calibration. With a log, the log's scale is checked by it.")] = None
    focal: Annotated[float | None, typer.Option(
        "--focal", rich_help_panel=GROUND, min=1.0, help="Focal length, pixels of the frames.")] = None
    navigation: Annotated[Path | None, typer.Option(
        "--navigation", rich_help_panel=GROUND, help="CSV with frame or time_s, and east_m, north_m or latitude, "
        "longitude: the mosaic is laid north up on the ground.")] = None
    exif: Annotated[bool, typer.Option(
        "--exif", rich_help_panel=GROUND, help="The GPS positions in the pictures' EXIF tags are the navigation log.")
                    ] = False
    epsg: Annotated[int, typer.Option(
        "--epsg", rich_help_panel=GROUND, min=0, max=65535, help="EPSG code of the projected coordinates of "
        "--navigation, e.g. 32755; with latitude and longitude, of those of the mosaic.",
        show_default="unknown; the UTM zone of latitude and longitude")] = 0
    start: Annotated[str | None, typer.Option(
        "--start", rich_help_panel=GROUND, help="Time of the survey's first frame on the clock of a --navigation log "
        "by time: seconds, or 2026-03-01T10:00:00Z.", show_default="frames and log have one clock")] = None
    cog: Annotated[bool, typer.Option(
        "--cog", rich_help_panel=GROUND, help="Write mosaic.tif as a Cloud Optimized GeoTIFF.")] = False

    def known(self, source: Source, calibration: Path | None, size: Callable[[], tuple[int, int]]) -> Ground:
        """What the options say of the mosaic's place, with the log read.

        Args:
            source: of the frames.
            calibration: of the camera.
            size: width and height of the frames; called only if they matter.

        Raises:
            SignumError: if the log cannot be used, or an option belongs to what was not given.
        """
        if self.exif and self.navigation is not None:
            raise SignumError("--exif and --navigation are two logs: give one of them")
        if self.epsg and not self.exif and self.navigation is None:
            raise SignumError("--epsg is of the coordinates in a --navigation log: add it, or leave --epsg out")
        if self.cog and not (self.exif or self.navigation or self.range_m):
            raise SignumError("--cog is of mosaic.tif, which needs a place: add --navigation, --exif or --range")
        pixel_m = 0.0
        if self.range_m is not None:
            focal = self.focal
            if focal is None:
                if calibration is None:
                    raise SignumError("--range needs the camera's focal length: add --focal (pixels) or --calibration")
                focal = open_lens(calibration).scaled(size(), str(calibration)).focal
            pixel_m = self.range_m / focal
        return Ground(self._log(source), pixel_m)

    def _log(self, source: Source) -> Track | TimedTrack | None:
        log: Track | TimedTrack | None = None
        if self.epsg:
            system(self.epsg)
        if self.exif:
            log = exif_track(_pictures(source), self.epsg)
        elif self.navigation is not None:
            log = read_navigation(self.navigation, source.label, self.epsg)
        if self.start is not None:
            if not isinstance(log, TimedTrack):
                raise SignumError("--start is of a --navigation log by time: leave it out")
            log = replace(log, start=read_moment(self.start, "--start"))
        return log


@dataclass(frozen=True)
class Ground:
    """What is known of a mosaic's place on the ground.

    Attributes:
        log: the navigation log; None if there is none.
        pixel_m: metres a pixel covers, by range and focal length; 0 where they are not known.
    """

    log: Track | TimedTrack | None
    pixel_m: float

    def placing(self, begun: Callable[[], float | None]) -> Grounding | None:
        """How a component of the mosaic is placed; None where nothing is known.

        Args:
            begun: gives the time of the survey's first frame, seconds.
        """
        pixel_m = self.pixel_m
        if self.log is not None:
            log = replace(self.log, first=begun) if isinstance(self.log, TimedTrack) else self.log
            return lambda poses, _: ground_by_log(poses, log, pixel_m)
        return (lambda _, centre: ground_by_range(pixel_m, centre)) if pixel_m else None


def _pictures(source: Source) -> list[Path]:
    """The files of a source of pictures, in order.

    Raises:
        SignumError: if it is another source.
    """
    inner = source.source if isinstance(source, UndistortedSource) else source
    if isinstance(inner, FolderSource):
        return list(inner.files)
    if isinstance(inner, PictureSource):
        return [inner.file]
    raise SignumError(f"--exif is of a folder of pictures: {source.label} has no EXIF tags; give a log with "
                      "--navigation")
