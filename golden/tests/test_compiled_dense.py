# SPDX-License-Identifier: Apache-2.0
"""The compiled dense search against the specification, in every variant that this processor can run."""

from __future__ import annotations

import numpy as np
import pytest

from golden.compiled.calls import pack, variants
from golden.correlate import Plane
from golden.dense import DensePass, dense
from golden.dense_job import DenseJob, judge


def _pair(rng: np.random.Generator, width: int, height: int) -> tuple[Plane, Plane]:
    """Random planes, dense or sparse, the right one moved and noisy, so that ties and small counts occur."""
    left = (rng.random((height, width)) < rng.choice([0.5, 0.02])).astype(np.uint8)
    noise = (rng.random((height, width)) < rng.choice([0.0, 0.1])).astype(np.uint8)
    return left, np.roll(left, (int(rng.integers(-3, 4)), int(rng.integers(-9, 10))), (0, 1)) ^ noise


def _same(job: DenseJob, left: Plane, right: Plane) -> None:
    wanted = judge(dense(left, right, job.search), job)
    for name, kernel in variants().items():
        found = kernel.dense(pack(left), pack(right), left.shape[1], job)
        for key, values in vars(wanted).items():
            other = getattr(found, key)
            assert other.dtype == values.dtype and np.array_equal(other, values), (name, key, job)


@pytest.mark.parametrize("seed", range(40))
def test_every_field_of_random_passes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    window, width, height = int(rng.choice([2, 4, 8, 16, 32])), int(rng.integers(33, 140)), int(rng.integers(33, 60))
    offsets = int(rng.integers(1, 40))
    one = DensePass(window, offsets, int(rng.integers(-offsets - 20, 30)), int(rng.integers(-12, 13)))
    step = int(rng.integers(1, 5)), int(rng.integers(1, 4))
    job = DenseJob(0, 1, one, step, int(rng.integers(0, window**2 + 1)), int(rng.integers(0, 9)), bool(seed % 2))
    _same(job, *_pair(rng, width, height))


@pytest.mark.parametrize("one", [
    DensePass(32, 256, -128), DensePass(8, 4, 511), DensePass(8, 4, -512), DensePass(8, 256, -512),
    DensePass(16, 3, 0, 511), DensePass(16, 3, 0, -512), DensePass(32, 64, 0, 1)], ids=str)
def test_passes_that_reach_beyond_the_planes(one: DensePass) -> None:
    _same(DenseJob(0, 1, one, check=True), *_pair(np.random.default_rng(1), 71, 40))


def test_counts_of_whole_windows() -> None:
    """Planes that are each other's negatives: every window's mismatches are all of its pixels."""
    left = np.ones((40, 70), np.uint8)
    _same(DenseJob(0, 1, DensePass(32, 9, -3)), left, 1 - left)
