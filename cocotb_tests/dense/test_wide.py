# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_wide` against its cycle model on every clock, and its maps against the frame level."""

import random

import cocotb
import numpy as np
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.wide import DenseWideModel
from golden.dense import dense
from golden.traffic.dense_wide import KINDS, WideTraffic, random_pair
from sim.testbench.runner import simulate

PASSES = 5


@cocotb.test()
async def every_clock(dut) -> None:
    """Passes of all starts; a reset in the middle of the second."""
    p, rng = params(), random.Random(cocotb.RANDOM_SEED)
    offsets, window = p["Offsets"], p["Window"]
    passes = [random_pair(rng, offsets, window, p["MaxWidth"], KINDS[n % len(KINDS)]) for n in range(PASSES)]
    traffic = WideTraffic(passes, rng, offsets, window, cut=1)
    await check_cycles(dut, DenseWideModel(offsets, window), traffic.stimulus(), traffic.observe)
    assert len(traffic.maps) == PASSES
    for (index, best), (left, right, one) in zip(traffic.maps, passes, strict=True):
        wanted = dense(left, right, one)
        assert np.array_equal(index, wanted.index) and np.array_equal(best, wanted.best), one


@pytest.mark.parametrize(("offsets", "window", "width"), [(8, 16, 40), (4, 8, 24)])
def test_wide(offsets: int, window: int, width: int) -> None:
    simulate("slog_dense_wide", __name__, {"Offsets": offsets, "Window": window, "MaxWidth": width})


@pytest.mark.parametrize(("offsets", "window", "width"), [(40, 32, 72), (24, 4, 16)])
def test_many_groups(offsets: int, window: int, width: int) -> None:
    """Windows of the largest size; more groups than a row has words, so that two rows are in the engine at a time."""
    simulate("slog_dense_wide", __name__, {"Offsets": offsets, "Window": window, "MaxWidth": width})
