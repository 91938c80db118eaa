# SPDX-License-Identifier: Apache-2.0
"""The wide dense engine's cycle model against the frame level: the same winner and best score for every pixel."""

from __future__ import annotations

import random

import numpy as np
import pytest

from golden.cycle.dense.wide import DenseWideModel
from golden.cycle.model import run_model
from golden.dense import dense
from golden.traffic.dense_wide import KINDS, WideTraffic, random_pair


@pytest.mark.parametrize(("offsets", "window", "width"), [(4, 4, 21), (8, 8, 24), (16, 16, 33), (40, 4, 17)])
def test_maps(offsets: int, window: int, width: int) -> None:
    """Passes of several starts and directions, with planes of each kind, one after a reset in its middle."""
    found = 0
    for seed in range(3):
        rng = random.Random(seed)
        passes = [random_pair(rng, offsets, window, width, kind) for kind in KINDS]
        traffic = WideTraffic(passes, rng, offsets, window, cut=1)
        run_model(DenseWideModel(offsets, window), traffic.stimulus(), traffic.observe)
        assert len(traffic.maps) == len(passes)
        for (index, best), (left, right, one) in zip(traffic.maps, passes, strict=True):
            wanted = dense(left, right, one)
            assert np.array_equal(index, wanted.index) and np.array_equal(best, wanted.best), (seed, one)
            found += int((wanted.best >= 0).sum())
    assert found > 300
