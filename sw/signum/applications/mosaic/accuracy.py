# SPDX-License-Identifier: Apache-2.0
"""Absolute and relative error of poses against the truth (APE, RPE), and the truth's table.

Positions are complex numbers x + iy with y down, as pixels have it; east and north become east - i north.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from signum.applications.mosaic.pose import Pose
from signum.common.arrays import Complexes, Floats
from signum.common.checks import number
from signum.common.errors import SignumError
from signum.geometry.similarity import Similarity
from signum.tables.reader import read_rows

FRAME_COLUMNS = "frame", "name", "image", "file", "filename"
"""Names of the column with the frame's name; the first one found is used."""
EAST_COLUMNS = "x_m", "east_m", "e_centre_m", "easting", "east", "e_m", "x"
"""Names of the column with metres to the east; the first one found is used."""
NORTH_COLUMNS = "y_m", "north_m", "n_centre_m", "northing", "north", "n_m", "y"
"""Names of the column with metres to the north; the first one found is used."""
PIXEL_COLUMNS = ("x_px", "y_px")
"""Names of the columns with pixels to the right and down, used where there are no metres."""
HEADING_COLUMNS = "heading_deg", "heading_deg_of_image_up", "yaw_deg", "heading", "rot_deg"
"""Names of the columns with the heading; the first name found is used."""

FARTHEST = 1e8
"""Largest coordinate of a frame, metres or pixels."""


@dataclass(frozen=True, eq=False)
class Track:
    """Known positions of frames.

    Attributes:
        positions: by frame, complex, y down.
        headings: by frame, degrees, clockwise seen from above; empty where they are not known.
        unit: "m" or "px".
    """

    positions: dict[str, complex]
    headings: dict[str, float]
    unit: str


def read_track(path: Path, source: str = "") -> Track:
    """Read positions of frames: a truth or a navigation log.

    Columns are found by name in any case: one of FRAME_COLUMNS; one of EAST_COLUMNS and one of NORTH_COLUMNS in metres,
    or PIXEL_COLUMNS; one of HEADING_COLUMNS if there is any. The name of a frame may be a file name with folder and
    ending. If frames are listed twice and there is a column `path`, only rows whose path names the source's folder are
    used.

    Args:
        path: CSV.
        source: label of the frames' source.

    Raises:
        SignumError: if it is no CSV file, columns are missing, a number is none, infinite or beyond FARTHEST, or a
            frame is listed twice.
    """
    rows = read_rows(path)
    heads = set(rows[0])
    name = _column(path, heads, FRAME_COLUMNS, "the frame's name")
    pixels = heads.issuperset(PIXEL_COLUMNS)
    east = "x_px" if pixels else _column(path, heads, EAST_COLUMNS, "metres to the east")
    north = "y_px" if pixels else _column(path, heads, NORTH_COLUMNS, "metres to the north")
    heading = next((h for h in HEADING_COLUMNS if h in heads), None)
    names = [Path(row[name]).stem if Path(row[name]).suffix else row[name] for row in rows]
    if len(set(names)) < len(names) and "path" in heads:
        run = Path(source).name
        kept = [i for i, row in enumerate(rows) if run in Path(row["path"]).parts]
        rows, names = [rows[i] for i in kept], [names[i] for i in kept]
    twice = next((n for n, times in Counter(names).items() if times > 1), None)
    if twice is not None:
        raise SignumError(f"{path}: frame {twice} is listed twice; keep the rows of this run only")
    positions, headings = {}, {}
    for label, row in zip(names, rows, strict=True):
        x, y = (number(row[column], f"{path}: frame {label}: {column}", -FARTHEST, FARTHEST)
                for column in (east, north))
        positions[label] = complex(x, y * (1 if pixels else -1))
        if heading and row[heading]:
            headings[label] = number(row[heading], f"{path}: frame {label}: {heading}", -3600, 3600)
    return Track(positions, headings, "px" if pixels else "m")


def _column(path: Path, heads: set[str], known: Sequence[str], what: str) -> str:
    for name in known:
        if name in heads:
            return name
    raise SignumError(f"{path}: no column for {what}; call it one of {', '.join(known)} "
                      f"(there are: {', '.join(sorted(filter(None, heads))) or 'none'})")


def align(z: Complexes, w: Complexes, scaled: bool = True) -> Similarity:
    """The best similarity (or rigid motion, if not `scaled`) in least squares of points z (n,) onto w (n,), n >= 2."""
    a, b = z - z.mean(), w - w.mean()
    cross, power = complex(np.vdot(a, b)), float(np.vdot(a, a).real)
    if power == 0 or cross == 0:
        return Similarity(1 + 0j, complex(w.mean() - z.mean()))
    factor = cross / power if scaled else cross / abs(cross)
    return Similarity(factor, complex(w.mean() - factor * z.mean()))


@dataclass(frozen=True, eq=False)
class PoseErrors:
    """Errors against the truth.

    Attributes:
        frames: those in both, in order.
        onto: plane of the poses -> truth.
        ape: (n,) distance of each from its true place after the alignment, in the truth's unit.
        rpe: (n - 1,) error of the displacement from each to the next, after the alignment, same unit.
        turn: (n - 1,) error of the rotation from each to the next, degrees; empty without headings.
    """

    frames: list[str]
    onto: Similarity
    ape: Floats
    rpe: Floats
    turn: Floats


def pose_errors(poses: Sequence[Pose], truth: Track, scaled: bool = True) -> PoseErrors:
    """Compare poses with the truth.

    Args:
        poses: in order.
        truth: of some or all of their frames.
        scaled: align by a similarity; else by a rigid motion, for poses in the truth's unit.

    Raises:
        SignumError: if they have fewer than three frames in common.
    """
    known = [p for p in poses if p.frame in truth.positions]
    if len(known) < 3:
        raise SignumError(f"only {len(known)} of the {len(poses)} placed frames have a true position; at least 3 must: "
                          f"the truth's frames are called {', '.join(list(truth.positions)[:3])}, ..., those of the "
                          f"mosaic {', '.join(p.frame for p in poses[:3])}, ...")
    z = np.array([complex(p.x_px, p.y_px) for p in known])
    w = np.array([truth.positions[p.frame] for p in known])
    onto = align(z, w, scaled)
    placed = onto.factor * z + onto.shift
    turns = [(b.rot_deg - a.rot_deg) - (truth.headings[b.frame] - truth.headings[a.frame])
             for a, b in pairwise(known)
             if a.frame in truth.headings and b.frame in truth.headings]
    return PoseErrors([p.frame for p in known], onto, np.abs(placed - w), np.abs(np.diff(placed) - np.diff(w)),
                 np.abs((np.array(turns) + 180) % 360 - 180))


def accuracy_rows(method: str, error: PoseErrors, unit: str, aligned: str = "similarity") -> list[list[object]]:
    """Rows of `accuracy.csv`."""
    out: list[list[object]] = []
    for name, values, of in ((f"APE after {aligned}", error.ape, unit), ("RPE, frame to frame", error.rpe, unit),
                             ("RPE, rotation", error.turn, "deg")):
        if len(values):
            figures = (np.sqrt(np.mean(values**2)), values.mean(), np.median(values), values.std(), values.min(),
                       values.max())
            out.append([method, name, of, *(f"{v:.4f}" for v in figures), len(values)])
    return out
