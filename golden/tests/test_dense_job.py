# SPDX-License-Identifier: Apache-2.0
"""What a board with a dense engine answers: refusals in their order, steps, and what counts as valid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from golden.dense import ABSENT, DensePass, dense
from golden.dense_job import DenseJob, DenseStatus, check_dense, run_dense
from golden.params import TINY, TINY_DENSE
from golden.tests.test_dense import planes

SIZE = (48, 36)
"""(width, height) of the planes."""
JOB = DenseJob(0, 1, DensePass(8, 6, -2))
PAIR = dict(enumerate(planes(3, shape=SIZE[::-1])))


@pytest.mark.parametrize(("change", "status"), [
    ({}, DenseStatus.OK), ({"window": 4}, DenseStatus.OK), ({"window": 16}, DenseStatus.BAD_WINDOW),
    ({"window": 2}, DenseStatus.BAD_WINDOW), ({"window": 5}, DenseStatus.BAD_WINDOW),
    ({"size": (48, 7)}, DenseStatus.BAD_WINDOW), ({"size": (7, 36)}, DenseStatus.BAD_WINDOW),
    ({"offsets": 0}, DenseStatus.BAD_OFFSETS), ({"offsets": 16}, DenseStatus.OK),
    ({"offsets": 17}, DenseStatus.BAD_OFFSETS), ({"slots": (2, 0)}, DenseStatus.BAD_SLOT),
    ({"slots": (0, 3)}, DenseStatus.BAD_SLOT), ({"slots": (1, 1)}, DenseStatus.OK),
    ({"step": (0, 1)}, DenseStatus.BAD_STEP), ({"step": (1, 0)}, DenseStatus.BAD_STEP),
    ({"window": 3, "offsets": 0}, DenseStatus.BAD_WINDOW),
    ({"offsets": 0, "slots": (2, 2)}, DenseStatus.BAD_OFFSETS),
    ({"slots": (2, 2), "step": (0, 0)}, DenseStatus.BAD_SLOT), ({"config": TINY}, DenseStatus.BAD_WINDOW)])
def test_refusals_in_their_order(change: dict[str, object], status: DenseStatus) -> None:
    held = {0, 1, 3}  # slot 3 is none of the board's
    good = {"window": 8, "offsets": 6, "slots": (0, 1), "step": (1, 1), "config": TINY_DENSE, "size": SIZE}
    assert check_dense(**{**good, **change}, held=held) is status  # type: ignore[arg-type]


def test_a_refused_job_has_no_winners() -> None:
    assert run_dense(replace(JOB, right=2), PAIR, TINY_DENSE, SIZE) == (DenseStatus.BAD_SLOT, None)


@pytest.mark.parametrize("step", [(1, 1), (3, 2), (48, 36), (255, 7)])
def test_step_takes_its_columns_and_rows(step: tuple[int, int]) -> None:
    status, result = run_dense(replace(JOB, step=step), PAIR, TINY_DENSE, SIZE)
    whole = dense(PAIR[0], PAIR[1], JOB.search)
    assert status is DenseStatus.OK and result is not None
    for name in ("index", "best", "lower", "upper", "rest", "agrees"):
        expected = np.array([[getattr(whole, name)[y, x] for x in range(0, SIZE[0], step[0])]
                             for y in range(0, SIZE[1], step[1])])
        assert np.array_equal(getattr(result, name), expected), name
    assert np.array_equal(result.found, result.index != ABSENT)


@pytest.mark.parametrize("change", [
    {}, {"most": 20}, {"most": 0}, {"margin": 3}, {"margin": 2047}, {"check": True},
    {"most": 25, "margin": 1, "check": True}])
def test_valid_pixel_by_pixel(change: dict[str, object]) -> None:
    job = replace(JOB, **change)  # type: ignore[arg-type]
    result = run_dense(job, PAIR, TINY_DENSE, SIZE)[1]
    assert result is not None
    for y, x in np.ndindex(result.valid.shape):
        best, rest = int(result.best[y, x]), int(result.rest[y, x])
        assert result.valid[y, x] == (
            bool(result.found[y, x]) and best <= job.most and (rest == ABSENT or rest - best >= job.margin)
            and (bool(result.agrees[y, x]) or not job.check))


def test_an_offset_without_rest_is_valid_whatever_the_margin() -> None:
    result = run_dense(replace(JOB, search=DensePass(8, 2), margin=2047), PAIR, TINY_DENSE, SIZE)[1]
    assert result is not None and (result.rest == ABSENT).all() and np.array_equal(result.valid, result.found)


@pytest.mark.parametrize(("change", "message"), [
    ({"left": 8}, "left is 8"), ({"right": -1}, "right is -1"), ({"most": 2048}, "most is 2048"),
    ({"margin": -1}, "margin is -1"), ({"step": (1, 256)}, "step is 256"), ({"step": (-1, 1)}, "step is -1"),
    ({"step": (1, 1, 1)}, "step is"), ({"step": 2}, "step is 2: must be two numbers"), ({"step": None}, "step is None"),
    ({"search": None}, "search is None: must be a DensePass"), ({"search": (16, 8)}, "search is"),
    ({"left": 0.5}, "left is 0.5: must be a whole number"),
    ({"most": 12.0}, "most is 12.0")])
def test_what_fits_no_register_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(JOB, **change)  # type: ignore[arg-type]


def test_numbers_of_any_integer_type_are_taken() -> None:
    """What computes with numbers of fewer bits, as the registers' words do, gets Python's."""
    job = replace(JOB, left=np.uint8(1), step=(np.int16(2), np.int64(3)), check=np.int8(2),  # type: ignore[arg-type]
                  search=DensePass(np.int16(8), np.uint8(4), np.int16(-2)))  # type: ignore[arg-type]
    assert job == replace(JOB, left=1, step=(2, 3), check=True, search=DensePass(8, 4, -2))
    numbers = job.left, *job.step, job.search.window, job.search.start
    assert all(type(n) is int for n in numbers) and job.check is True
