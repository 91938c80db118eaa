# SPDX-License-Identifier: Apache-2.0
"""Trajectories from the tables of a finished run: metres, and the axes of ROS (REP 103).

The world has z up. Of a hold its x is ahead in the station's first frame and its y to the left; of a mosaic x is east
and y north, or to the right and upwards in the first frame where the ground is not known. The vehicle has x ahead,
which is up in the picture of a camera that looks down, y to the left and z up. Yaw is counter-clockwise seen from
above, and 0 where both agree: heading h clockwise from north is yaw 90 - h degrees.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from signum.common.arrays import Complexes, Floats
from signum.common.checks import read_text
from signum.common.errors import SignumError
from signum.report.read_table import Columns, read_table
from signum.tables.schemas import GROUND, HOLD, NAVIGATE, POSES


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where a camera was.

    Attributes:
        name: of the table it is from, without ending.
        world: its frame of reference by REP 105: "odom" of a hold, "map" of a mosaic.
        times: (n,) seconds on the frames' own clock, ascending.
        positions: (n, 3) metres.
        yaws: (n,) radians.
        left_out: rows of the table without a position.
    """

    name: str
    world: str
    times: Floats
    positions: Floats
    yaws: Floats
    left_out: int


@dataclass(frozen=True)
class Scale:
    """What makes metres and seconds of tables that lack them.

    Attributes:
        pixel_m: metres that a pixel of the mosaic covers; None for what the run's own files say.
        range_m: metres from the camera to the floor where a frame's scale is 1, for heights; None for a height of 0.
        rate: frames per second, for frames without times; None for none.
        world_file: `mosaic.pgw` of the mosaic that was navigated; None for none.
        began_s: time of a hold's first frame, seconds, which its table counts from.
    """

    pixel_m: float | None = None
    range_m: float | None = None
    rate: float | None = None
    world_file: Path | None = None
    began_s: float = 0.0


def read_trajectories(folder: Path, scale: Scale) -> list[Trajectory]:
    """The trajectories of all tables in a folder that have one, in the order of their names.

    Raises:
        SignumError: if there are none, or what a table lacks is not given.
    """
    paths = sorted(path for path in folder.glob("*.csv")
                   if re.fullmatch(r"hold|navigate|poses(-\d+)?", path.stem)) if folder.is_dir() else []
    if not paths:
        raise SignumError(f"{folder}: no hold.csv, poses.csv or navigate.csv in it; give the --out folder of signum "
                          "hold, mosaic or navigate")
    found = [_hold(path, scale) if path.stem == "hold" else _navigated(path, scale) if path.stem == "navigate"
             else _posed(path, scale) for path in paths]
    whole = [one for one in found if len(one.times)]
    if not whole:
        raise SignumError(f"{folder}: no frame in {', '.join(path.name for path in paths)} has a position")
    return whole


def _hold(path: Path, scale: Scale) -> Trajectory:
    table = read_table(path, HOLD)
    x, y, turn, away = (table.numbers(name) for name in ("x_m", "y_m", "rot_deg", "range_m"))
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(turn) & np.isfinite(away)
    height = away - (away[known][0] if known.any() else 0.0)
    times = _times(table, scale.rate, path) + scale.began_s
    return _made(path, "odom", times, np.stack([x, -y, height], 1), -np.radians(turn), known)


def _posed(path: Path, scale: Scale) -> Trajectory:
    table = read_table(path, POSES)
    component = int((re.findall(r"-(\d+)", path.stem) or [1])[0])
    onto = _ground(path.with_name("ground.csv"), component) if scale.pixel_m is None else (complex(scale.pixel_m), 0j)
    if onto is None:
        raise SignumError(f"{path}: is in pixels, and {path.parent} does not say what they cover: give --pixel METRES, "
                          "or make the mosaic with --range or --navigation")
    return _placed(path, table, onto[0], onto[1], scale)


def _navigated(path: Path, scale: Scale) -> Trajectory:
    table = read_table(path, NAVIGATE)
    factor, shift = complex(scale.pixel_m or 0.0), 0j
    if scale.pixel_m is None:
        if scale.world_file is None:
            raise SignumError(f"{path}: is in pixels of mosaic.png: give --mosaic, the folder of a mosaic with "
                              "mosaic.pgw, or --pixel METRES")
        step, east, north = _world(scale.world_file)
        factor, shift = complex(step), complex(east, -north)
    return _placed(path, table, factor, shift, scale)


def _placed(path: Path, table: Columns, factor: complex, shift: complex, scale: Scale) -> Trajectory:
    """A trajectory of pixels, which `factor` and `shift` take to metres east and south (y down)."""
    x, y, turn, size = (table.numbers(name) for name in ("x_px", "y_px", "rot_deg", "scale"))
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(turn) & np.isfinite(size)
    at: Complexes = factor * (x + 1j * y) + shift
    height = (scale.range_m or 0.0) * (size - 1)
    heading = np.radians(turn) + np.angle(factor)
    return _made(path, "map", _times(table, scale.rate, path), np.stack([at.real, -at.imag, height], 1),
                 np.pi / 2 - heading, known)


def _made(path: Path, world: str, times: Floats, positions: Floats, yaws: Floats, known: np.ndarray[tuple[int],
          np.dtype[np.bool_]]) -> Trajectory:
    order = np.flatnonzero(known)[np.argsort(times[known], kind="stable")]
    return Trajectory(path.stem, world, times[order], positions[order], np.angle(np.exp(1j * yaws[order])),
                      int((~known).sum()))


def _times(table: Columns, rate: float | None, path: Path) -> Floats:
    times = table.numbers("time_s") if "time_s" in table.names else np.full(table.rows, np.nan)
    if np.isfinite(times).all():
        return times
    if rate is None:
        raise SignumError(f"{path}: its frames have no times: give their --rate, frames per second")
    return np.arange(table.rows) / rate


def _ground(path: Path, component: int) -> tuple[complex, complex] | None:
    """What takes pixels of a component's plane to metres east and south; None where it is not known."""
    if not path.exists():
        return None
    table = read_table(path, GROUND)
    step, turn, east, north = (table.numbers(name) for name in ("pixel_m", "turn_deg", "east_m", "north_m"))
    rows = np.flatnonzero(table.numbers("component") == component)
    if len(rows) != 1:
        return None
    k = int(rows[0])
    factor, shift = step[k] * np.exp(1j * np.radians(turn[k])), complex(east[k], -north[k])
    return (complex(factor), shift) if np.isfinite([factor, shift]).all() and step[k] > 0 else None


def _world(path: Path) -> tuple[float, float, float]:
    """Metres a pixel, and east and north of pixel (0, 0), of a world file of `signum mosaic`."""
    try:
        step, across, down, back, east, north = map(float, read_text(path, "world file").split())
        if not (step > 0 and across == down == 0 and back == -step and np.isfinite([east, north]).all()):
            raise ValueError("turned")
    except ValueError as error:
        raise SignumError(f"{path}: not a world file of signum mosaic: six numbers, north up; make the mosaic again "
                          "with --range or --navigation") from error
    return step, east, north
