# SPDX-License-Identifier: Apache-2.0
"""The dense engine's cycle model against the frame level: every field of every pixel."""

from __future__ import annotations

import random

import numpy as np
import pytest

from golden.correlate import Plane
from golden.cycle.dense.engine import DenseEngineModel
from golden.cycle.model import run_model
from golden.dense import DensePass, dense
from golden.traffic.dense import DenseTraffic


def _planes(seed: int, shape: tuple[int, int]) -> tuple[Plane, Plane]:
    rng = np.random.default_rng(seed)
    left = (rng.random(shape) < 0.5).astype(np.uint8)
    return left, np.roll(left, (0, -3), (0, 1)) ^ (rng.random(shape) < 0.1).astype(np.uint8)


@pytest.mark.parametrize(("offsets", "lanes", "passes"), [
    (8, 4, [DensePass(8, 8), DensePass(16, 5, -3, 1), DensePass(8, 8, 4, -2)]),
    (12, 4, [DensePass(16, 12), DensePass(8, 1, 2), DensePass(8, 12, -11, 3)])])
def test_maps_are_those_of_the_frame_level(offsets: int, lanes: int, passes: list[DensePass]) -> None:
    rng = random.Random(offsets)
    planes = [(*_planes(k, (18 + 3 * k, 23 + 9 * k)), one) for k, one in enumerate(passes)]
    traffic = DenseTraffic(planes, rng, offsets, lanes, 16)
    run_model(DenseEngineModel(offsets, lanes, 16), traffic.stimulus(), traffic.observe)
    assert len(traffic.maps) == len(passes)
    for found, (left, right, one) in zip(traffic.maps, planes, strict=True):
        wanted = dense(left, right, one)
        for name in vars(wanted):
            assert np.array_equal(getattr(found, name), getattr(wanted, name)), (one, name)
