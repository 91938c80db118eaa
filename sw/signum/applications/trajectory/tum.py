# SPDX-License-Identifier: Apache-2.0
"""Trajectories as the benchmarks of TU Munich have them: a text file that `evo` and others read.

A line is `timestamp tx ty tz qx qy qz qw`: seconds, metres, and the unit quaternion of the vehicle in the world.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from signum.applications.trajectory.path import Trajectory
from signum.common.files import write_text


def write_tum(path: Path, trajectory: Trajectory) -> None:
    """Write a trajectory; see `Trajectory` for its axes."""
    half = trajectory.yaws / 2
    rows = zip(trajectory.times, trajectory.positions, np.sin(half), np.cos(half), strict=True)
    write_text(path, "".join(f"{t:.9f} {x:.6f} {y:.6f} {z:.6f} 0 0 {s:.9f} {c:.9f}\n" for t, (x, y, z), s, c in rows))
