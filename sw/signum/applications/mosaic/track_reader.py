# SPDX-License-Identifier: Apache-2.0
"""Reads known places of frames from CSV tables, and from the EXIF tags of pictures."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from signum.applications.mosaic.track import TimedTrack, Track, frame_name, listed, read_moment
from signum.common.arrays import Complexes
from signum.common.checks import number
from signum.common.console import notes
from signum.common.errors import SignumError
from signum.frames.exif import place_of
from signum.geometry.earth import check_metres, project
from signum.sources.files import name_of
from signum.tables.reader import read_rows

FRAME_COLUMNS = "frame", "name", "image", "file", "filename"
"""Names of the column with the frame's name; the first one found is used."""
TIME_COLUMNS = "time_s", "t_s", "time", "timestamp", "datetime", "utc", "t"
"""Names of the column with the time, seconds or ISO 8601; the first one found is used."""
EAST_COLUMNS = "x_m", "east_m", "e_centre_m", "easting", "east", "e_m", "x"
"""Names of the column with metres to the east; the first one found is used."""
NORTH_COLUMNS = "y_m", "north_m", "n_centre_m", "northing", "north", "n_m", "y"
"""Names of the column with metres to the north; the first one found is used."""
LATITUDE_COLUMNS = "latitude", "lat", "latitude_deg", "lat_deg"
"""Names of the column with the latitude, degrees; the first one found is used."""
LONGITUDE_COLUMNS = "longitude", "lon", "long", "lng", "longitude_deg", "lon_deg"
"""Names of the column with the longitude, degrees; the first one found is used."""
PIXEL_COLUMNS = ("x_px", "y_px")
"""Names of the columns with pixels to the right and down, used where there are no metres."""
HEADING_COLUMNS = "heading_deg", "heading_deg_of_image_up", "yaw_deg", "heading", "rot_deg"
"""Names of the columns with the heading; the first name found is used."""

FARTHEST = 1e8
"""Largest coordinate of a frame, metres or pixels."""
NO_NUMBER = frozenset({"", "-", "--", "na", "n/a", "null", "none"})
"""What stands in a cell for which there is no value, besides NaN and infinity."""
DEGREES_SPAN = 0.1
"""Extent of a survey below which coordinates may be degrees: 11 km in degrees, 10 cm in metres."""


@dataclass(frozen=True, eq=False)
class _Places:
    """Positions of the rows of a table that have one: row numbers, positions (n,) with y down, and what they are in."""

    rows: list[int]
    positions: Complexes
    unit: str
    epsg: int = 0
    accuracy_m: float = 0.0


def read_track(path: Path, source: str = "", epsg: int | None = None) -> Track:
    """Read positions of frames by their names: a truth or a navigation log.

    Cells are separated by commas, semicolons or tabs. Columns are found by name in any case: one of FRAME_COLUMNS; one
    of EAST_COLUMNS and one of NORTH_COLUMNS in metres, or LATITUDE_COLUMNS and LONGITUDE_COLUMNS in degrees of WGS 84,
    or PIXEL_COLUMNS; one of HEADING_COLUMNS if there is any. The name of a frame may be a file name with folder and
    ending. If frames are listed twice and there is a column `path`, only rows whose path names the source's folder are
    used. Rows without a position (empty, NaN, infinite) are left out and named.

    Args:
        path: CSV.
        source: label of the frames' source.
        epsg: of the system in metres; with 0, that of degrees is their UTM zone; None where the system does not matter,
            so that metres are taken where a table has both.

    Raises:
        SignumError: if it is no CSV file, columns are missing, a cell is no number or beyond FARTHEST, a frame is
            listed twice, or the metres cannot be of the system, or are degrees.
    """
    rows = read_rows(path)
    heads = set(rows[0])
    name = _column(path, heads, FRAME_COLUMNS, "the frame's name")
    names = [frame_name(row[name]) for row in rows]
    if len(set(names)) < len(names) and "path" in heads:
        run = Path(source).name
        kept = [i for i, row in enumerate(rows) if run in Path(row["path"]).parts]
        rows, names = [rows[i] for i in kept], [names[i] for i in kept]
    twice = next((n for n, times in Counter(names).items() if times > 1), None)
    if twice is not None:
        raise SignumError(f"{path}: frame {twice} is listed twice; keep the rows of this run only")
    found = _places(path, rows, [f"frame {n}" for n in names], heads, epsg)
    heading = next((h for h in HEADING_COLUMNS if h in heads), None)
    headings = {}
    for i in found.rows:
        if heading and not _lacks(rows[i][heading]):
            headings[names[i]] = number(rows[i][heading], f"{path}: frame {names[i]}: {heading}", -3600, 3600)
    positions = {names[i]: complex(z) for i, z in zip(found.rows, found.positions, strict=True)}
    return Track(positions, headings, found.unit, found.epsg, found.accuracy_m)


def read_navigation(path: Path, source: str = "", epsg: int = 0) -> Track | TimedTrack:
    """Read a navigation log: by frame as `read_track`, or by time if it has a column of TIME_COLUMNS and none for
    frames. Rows of the same time are taken together, at their mean.

    Raises:
        SignumError: as `read_track`, or if a time is none, or fewer than two differ.
    """
    rows = read_rows(path)
    heads = set(rows[0])
    clock = next((name for name in TIME_COLUMNS if name in heads), None)
    if clock is None or heads & set(FRAME_COLUMNS):
        return read_track(path, source, epsg)
    if heads.issuperset(PIXEL_COLUMNS):
        raise SignumError(f"{path}: gives pixels: a navigation log needs metres, or latitude and longitude")
    labels = [f"row {i} ({clock} {row[clock]})" for i, row in enumerate(rows, 1)]
    found = _places(path, rows, labels, heads, epsg, clock)
    moments = np.array([read_moment(rows[i][clock], f"{path}: row {i + 1}: {clock}") for i in found.rows])
    times, of = np.unique(moments, return_inverse=True)
    if len(times) < 2:
        raise SignumError(f"{path}: all positions are of one time; expected two times or more")
    if len(times) < len(moments):
        notes.print(f"{path}: {len(moments) - len(times)} rows have the time of another: their mean is taken")
    count = np.bincount(of)
    mean = np.bincount(of, found.positions.real) / count + 1j * (np.bincount(of, found.positions.imag) / count)
    return TimedTrack(path, times, mean.astype(np.complex128), found.epsg, found.accuracy_m)


def exif_track(files: Sequence[Path], epsg: int = 0) -> Track:
    """Positions of pictures by their EXIF GPS tags, which are of WGS 84, by the frames' names.

    Args:
        files: the pictures.
        epsg: of the system in metres; with 0, their UTM zone is taken.

    Raises:
        SignumError: if fewer than two pictures have a position, or it cannot be had in that system.
    """
    places = {name_of(file): place for file in files if (place := place_of(file)) is not None}
    if len(places) < 2:
        raise SignumError(f"--exif: {len(places)} of the {len(files)} pictures have a GPS position in their EXIF tags, "
                          "two are needed; give a log with --navigation instead")
    latitude, longitude = np.array(list(places.values())).T
    metres = project(latitude, longitude, epsg)
    z = metres.east - 1j * metres.north
    return Track({name: complex(v) for name, v in zip(places, z, strict=True) if np.isfinite(v)}, {}, "m", metres.epsg,
                 metres.accuracy_m)


def _places(path: Path, rows: list[dict[str, str]], labels: list[str], heads: set[str], epsg: int | None,
            clock: str = "") -> _Places:
    """The positions of a table's rows; those without are named by their labels."""
    columns, kind = _coordinates(path, heads, epsg)
    kept: list[int] = []
    lacking: list[str] = []
    values: list[list[float]] = []
    bounds = ((-90.0, 90.0), (-180.0, 360.0)) if kind == "degrees" else ((-FARTHEST, FARTHEST),) * 2
    for i, row in enumerate(rows):
        empty = next((c for c in (clock, *columns) if c and _lacks(row[c])), None)
        if empty is not None:
            lacking.append(f"{labels[i]}: {empty} is {row[empty] or 'empty'}")
            continue
        pair = [number(row[c], f"{path}: {labels[i]}: {c}", *bound) for c, bound in zip(columns, bounds, strict=True)]
        if kind == "degrees" and not any(pair):
            lacking.append(f"{labels[i]}: latitude and longitude are 0")
            continue
        kept.append(i)
        values.append(pair)
    if not kept:
        raise SignumError(f"{path}: no row has a position: {listed(lacking)}")
    one, two = np.array(values, np.float64).T
    try:
        if kind == "degrees":
            metres = project(one, two, epsg or 0)
            there = np.isfinite(metres.east) & np.isfinite(metres.north)
            lacking += [f"{labels[i]}: no place of EPSG {metres.epsg}" for i, ok in zip(kept, there, strict=True)
                        if not ok]
            found = _Places([i for i, ok in zip(kept, there, strict=True) if ok],
                            (metres.east - 1j * metres.north)[there], "m", metres.epsg, metres.accuracy_m)
        elif kind == "metres":
            _no_degrees(one - 1j * two, columns)
            if epsg:
                check_metres(one, two, epsg)
            found = _Places(kept, one - 1j * two, "m", epsg or 0)
        else:
            found = _Places(kept, one + 1j * two, "px")
    except SignumError as error:
        raise SignumError(f"{path}: {error}") from error
    if lacking:
        notes.print(f"{path}: {len(lacking)} of {len(rows)} rows have no position and are left out: {listed(lacking)}")
    return found


def _coordinates(path: Path, heads: set[str], epsg: int | None) -> tuple[tuple[str, str], str]:
    """The two columns of the positions, and whether they are degrees (latitude first), metres (east first) or pixels.

    Where a table has metres and degrees, those whose system is known are taken: metres only with a code of theirs, or
    if the system does not matter.
    """
    if heads.issuperset(PIXEL_COLUMNS):
        return ("x_px", "y_px"), "pixels"
    latitude, longitude, east = (next((name for name in known if name in heads), None)
                                 for known in (LATITUDE_COLUMNS, LONGITUDE_COLUMNS, EAST_COLUMNS))
    if latitude and longitude and not (east and epsg != 0):
        return (latitude, longitude), "degrees"
    return (_column(path, heads, EAST_COLUMNS, "metres to the east", ", or columns latitude and longitude"),
            _column(path, heads, NORTH_COLUMNS, "metres to the north")), "metres"


def _no_degrees(positions: Complexes, columns: Sequence[str]) -> None:
    """Check that metres are no degrees: these would put a survey within millimetres, far from (0, 0).

    Raises:
        SignumError: if they are.
    """
    x, y = positions.real, positions.imag
    less, largest = sorted((float(np.abs(x).max()), float(np.abs(y).max())))
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    if less <= 90 and largest <= 180 and 0 < span < min(DEGREES_SPAN, largest / 1000):
        raise SignumError(f"{' and '.join(columns)} look like degrees: {x[0]:.6f} and {-y[0]:.6f}, and the whole "
                          f"survey would be {1000 * span:.3g} mm wide; call the columns longitude and latitude, or "
                          "give metres")


def _lacks(cell: str) -> bool:
    """Whether a cell has no value: empty, NaN, infinite."""
    if cell.lower() in NO_NUMBER:
        return True
    try:
        return not math.isfinite(float(cell))
    except ValueError:
        return False


def _column(path: Path, heads: set[str], known: Sequence[str], what: str, more: str = "") -> str:
    for name in known:
        if name in heads:
            return name
    raise SignumError(f"{path}: no column for {what}; call it one of {', '.join(known)}{more} "
                      f"(there are: {', '.join(sorted(filter(None, heads))) or 'none'})")
