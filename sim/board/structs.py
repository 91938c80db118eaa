# SPDX-License-Identifier: Apache-2.0
"""Jobs and results as they cross the C interface: the same two structs as in `job.hpp`, for NumPy."""

from __future__ import annotations

from collections.abc import Iterable
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Job, Result, Status

_JOB = ("tag", "surface", "tpl_slot", "tpl_x", "tpl_y", "width", "height", "search_slot", "search_x", "search_y",
        "offsets_x", "offsets_y")
_GRID = ("grid_across", "grid_down", "step_x", "step_y")
JOB_DTYPE = np.dtype([(name, np.int32) for name in (*_JOB, *_GRID)])
"""`SlogJob`: the fields of `golden.correlate.Job`, then counts and steps of the grid of jobs that it begins."""
RESULT_DTYPE = np.dtype([("tag", np.int32), ("status", np.int32), ("best_x", np.int32), ("best_y", np.int32),
                   ("score", np.int32), ("neighbours", np.int32, 8), ("runner_up", np.int32)])
"""`SlogResult`: the fields of `golden.correlate.Result`."""

ACCESS_DTYPE = np.dtype([(name, np.uint32) for name in (
    "write", "address", "data", "strobes", "wait_address", "wait_data", "wait_response", "value", "answered")])
"""`SlogAccess` of `accesses.hpp`: a register access, its waits in clocks, and what was answered."""
Accesses = NDArray[Any]
"""An array of `ACCESS_DTYPE`."""

_values = attrgetter(*_JOB)


def pack_jobs(jobs: Iterable[Job], count: tuple[int, int] = (1, 1), step: tuple[int, int] = (0, 0)) -> NDArray[Any]:
    """Jobs as an array of `JOB_DTYPE`, each the first of a grid of `count` jobs, `step` pixels apart (across, down)."""
    return np.array([(*_values(job), *count, *step) for job in jobs], JOB_DTYPE)


def unpack_results(results: NDArray[Any]) -> list[Result]:
    """Results from an array of `RESULT_DTYPE`."""
    found = []
    for row, around in zip(results.tolist(), results["neighbours"].tolist(), strict=True):
        tag, status, x, y, score, _, runner_up = row
        n0, n1, n2, n3, n4, n5, n6, n7 = around
        found.append(Result(tag, Status(status), x, y, score, (n0, n1, n2, n3, n4, n5, n6, n7), runner_up))
    return found
