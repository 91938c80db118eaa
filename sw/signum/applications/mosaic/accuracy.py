# SPDX-License-Identifier: Apache-2.0
"""Absolute and relative error of poses against the truth (APE, RPE)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.track import Track
from signum.common.arrays import Complexes, Floats
from signum.common.errors import SignumError
from signum.geometry.similarity import Similarity


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
    whole, truth = truth, truth.of(poses)
    known = [p for p in poses if p.frame in truth.positions]
    if len(known) < 3:
        raise SignumError(f"only {len(known)} of the {len(poses)} placed frames have a true position; at least 3 must: "
                          f"the truth's frames are called {', '.join(list(whole.positions)[:3])}, ..., those of the "
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
