# SPDX-License-Identifier: Apache-2.0
"""Tables of jobs: checked as single jobs are, at every limit, and turned to and fro."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from golden.correlate import FIELD_MAX, Job, Result, Status, check
from golden.params import NO_SCORE, TINY
from golden.tables import (
    JOB_FIELDS,
    RESULT_FIELDS,
    SLOT_FIELDS,
    check_fields,
    check_table,
    jobs_table,
    refused_table,
    results_table,
    table_jobs,
    table_results,
)

SIZE = (48, 36)
PLAIN = Job(0, 10, 10, 16, 8, 1, 5, 6, 20, 10)
LIMITS = {
    "tpl_slot": (0, 1, 2, 5, 6, 7), "search_slot": (0, 1, 2, 5, 6, 7), "width": (0, 1, 2, 15, 16, 17, 255),
    "height": (0, 1, 2, 15, 16, 17, 255), "tpl_x": (0, 31, 32, 33, 1023), "tpl_y": (0, 27, 28, 29, 1023),
    "search_x": (0, 12, 13, 14, 1023), "search_y": (0, 18, 19, 20, 1023), "offsets_x": (0, 1, 27, 28, 29, 1023),
    "offsets_y": (0, 1, 22, 23, 24, 1023)}
VALID = [True, True, False, False, False, True, True, True]


def test_limits() -> None:
    """Every pair of fields at every pair of their limits."""
    jobs = [replace(PLAIN, **{a: x, b: y}) for a, b in product(LIMITS, LIMITS) if a < b  # type: ignore[arg-type]
            for x, y in product(LIMITS[a], LIMITS[b])]
    statuses = check_table(jobs_table(jobs), TINY, SIZE, VALID)
    assert [int(s) for s in statuses] == [int(check(job, TINY, SIZE, VALID)) for job in jobs]
    assert set(statuses) == set(Status)


def test_only_the_slots_of_the_board_are_given() -> None:
    jobs = [replace(PLAIN, tpl_slot=slot) for slot in range(8)]
    statuses = check_table(jobs_table(jobs), TINY, SIZE, [True] * TINY.slots)
    assert statuses.tolist() == [Status.OK] * 6 + [Status.BAD_SLOT] * 2


@pytest.mark.parametrize("name", JOB_FIELDS)
def test_fields(name: str) -> None:
    table = np.tile(jobs_table([PLAIN]), (3, 1))
    column = JOB_FIELDS.index(name)
    table[:2, column] = 0, FIELD_MAX[name]
    check_fields(table)
    for wrong in (-1, FIELD_MAX[name] + 1):
        table[1, column] = wrong
        with pytest.raises(ValueError, match=f"{name} is {wrong}: must lie in 0..{FIELD_MAX[name]}"):
            check_fields(table)


def test_to_and_fro() -> None:
    jobs = [PLAIN, replace(PLAIN, tpl_slot=3, search_slot=4)]
    table = jobs_table(jobs)
    assert table.dtype == np.int32 and table_jobs(table) == jobs
    assert table[1, SLOT_FIELDS].tolist() == [3, 4]
    assert jobs_table([]).shape == (0, 10) and results_table([]).shape == (0, 13)
    results = [Result(7, Status.OK, 1, 2, 3, (4, 5, 6, 7, 8, 9, 10, 11), 12), Result(9, Status.OUTSIDE)]
    wide = results_table(results)
    assert wide[0].tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12] and len(RESULT_FIELDS) == 13
    assert table_results(wide, [7, 9]) == results
    assert refused_table(2).tolist() == [[0, 0, 0, *[NO_SCORE] * 10]] * 2
