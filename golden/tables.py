# SPDX-License-Identifier: Apache-2.0
"""Many jobs and their results as arrays, one a row: what `correlate` computes for one job, without an object for each.

The columns of jobs are JOB_FIELDS and those of results RESULT_FIELDS, both int32.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter

import numpy as np
import numpy.typing as npt

from golden.correlate import FIELD_MAX, Job, Result, Status
from golden.params import NO_SCORE, Config

JOB_FIELDS = ("tpl_slot", "tpl_x", "tpl_y", "width", "height", "search_slot", "search_x", "search_y", "offsets_x",
              "offsets_y")
"""Fields of `Job`; there is no tag, as the order says which result is whose."""
SLOT_FIELDS = [JOB_FIELDS.index(name) for name in ("tpl_slot", "search_slot")]
"""Columns of the slots."""
RESULT_FIELDS = ("status", "best_x", "best_y", "score", *(f"neighbour{k}" for k in range(8)), "runner_up")
"""Fields of `Result`, neighbours NW N NE W E SW S SE."""
SCORES = RESULT_FIELDS.index("score")
"""Column of the score, which all further scores follow."""

IntTable = npt.NDArray[np.int32]
"""Jobs or results, one a row."""

_OF_JOB = attrgetter(*JOB_FIELDS)
_STATUS = {int(status): status for status in Status}


def jobs_table(jobs: Sequence[Job]) -> IntTable:
    """Jobs as a table, (n, len(JOB_FIELDS))."""
    return np.array([_OF_JOB(job) for job in jobs], np.int32).reshape(-1, len(JOB_FIELDS))


def check_fields(table: IntTable) -> None:
    """Check a table of jobs as each `Job` checks itself.

    Raises:
        ValueError: if a number does not fit its register, which is named.
    """
    for name, column in zip(JOB_FIELDS, table.T, strict=True):
        top = FIELD_MAX[name]
        wrong = column[(column < 0) | (column > top)]
        if wrong.size:
            raise ValueError(f"{name} is {wrong[0]}: must lie in 0..{top}")


def table_jobs(table: IntTable) -> list[Job]:
    """The jobs of a table, with tag 0."""
    return [Job(*row) for row in table.tolist()]


def results_table(results: Sequence[Result]) -> IntTable:
    """Results as a table, (n, len(RESULT_FIELDS))."""
    rows = [(r.status, r.best_x, r.best_y, r.score, *r.neighbours, r.runner_up) for r in results]
    return np.array(rows, np.int32).reshape(-1, len(RESULT_FIELDS))


def table_results(table: IntTable, tags: Sequence[int]) -> list[Result]:
    """The results of a table, with the tags of their jobs."""
    return [Result(tag, _STATUS[row[0]], row[1], row[2], row[3], tuple(row[4:12]), row[12])
            for tag, row in zip(tags, table.tolist(), strict=True)]


def refused_table(count: int) -> IntTable:
    """Results without a score, of jobs that were refused; their status is still OK."""
    table = np.zeros((count, len(RESULT_FIELDS)), np.int32)
    table[:, SCORES:] = NO_SCORE
    return table


def check_table(jobs: IntTable, config: Config, image_size: tuple[int, int], slot_valid: Sequence[bool],
                ) -> npt.NDArray[np.int64]:
    """`correlate.check` of every job of a table: their statuses, (n,)."""
    t_slot, t_x, t_y, width, height, s_slot, s_x, s_y, n_x, n_y = jobs.T.astype(np.int64)
    valid = np.zeros(max(8, len(slot_valid)), bool)
    valid[:config.slots] = slot_valid[:config.slots]
    low, high = config.min_window, config.max_window
    fits = (width >= low) & (width <= high) & (height >= low) & (height <= high)
    inside = ((np.maximum(t_x, s_x + n_x - 1) + width <= image_size[0])
              & (np.maximum(t_y, s_y + n_y - 1) + height <= image_size[1]))
    return np.select([~fits, (n_x == 0) | (n_y == 0), ~(valid[t_slot] & valid[s_slot]), ~inside],
                     [Status.BAD_WINDOW, Status.NO_OFFSETS, Status.BAD_SLOT, Status.OUTSIDE], Status.OK)
