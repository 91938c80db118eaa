# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_engine` against its cycle model on every clock, and its maps against the frame level."""

import random

import cocotb
import numpy as np
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from docs.tools.waves import WAVES
from golden.correlate import Plane
from golden.cycle.dense.engine import DenseEngineModel
from golden.dense import DensePass, dense
from golden.traffic.dense import DenseTraffic
from sim.testbench.runner import simulate

PASSES = 5


def _pass(rng: random.Random, number: int) -> tuple[Plane, Plane, DensePass]:
    """Two planes that resemble each other somewhere in the search range, and a search; the first pass searches for
    all offsets there are."""
    p = params()
    window = p["MaxWindow"] >> rng.randrange(p["Sizes"]) if number else p["MaxWindow"]
    offsets = rng.choice((1, 2, p["Offsets"], rng.randint(1, p["Offsets"]))) if number else p["Offsets"]
    one = DensePass(window, offsets, rng.choice((0, 1 - offsets, rng.randint(-9, 9))), rng.choice((0, 0, -2, 3)))
    shape = rng.randint(window + 4, window + 9), rng.randint(max(window, 2 * p["Lanes"]), p["MaxWidth"])
    dice = np.random.default_rng(rng.getrandbits(32))
    left = (dice.random(shape) < rng.choice((0.5, 0.03))).astype(np.uint8)
    right = np.roll(left, (-one.down, -one.start - rng.randrange(offsets)), (0, 1))
    return left, right ^ (dice.random(shape) < rng.choice((0.0, 0.1))).astype(np.uint8), one


@cocotb.test()
async def every_clock(dut) -> None:
    """Passes of all sizes; a reset in the middle of the second."""
    p, rng = params(), random.Random(cocotb.RANDOM_SEED)
    passes = [_pass(rng, number) for number in range(PASSES)]
    traffic = DenseTraffic(passes, rng, p["Offsets"], p["Lanes"], p["MaxWindow"], cut=1)
    model = DenseEngineModel(p["Offsets"], p["Lanes"], p["MaxWindow"])
    await check_cycles(dut, model, traffic.stimulus(), traffic.observe)
    assert len(traffic.maps) == PASSES
    for found, (left, right, one) in zip(traffic.maps, passes, strict=True):
        wanted = dense(left, right, one)
        for name in vars(wanted):
            assert np.array_equal(getattr(found, name), getattr(wanted, name)), (one, name)


@cocotb.test()
async def timing_diagram(dut) -> None:
    p = params()
    await check_diagram(dut, "dense", DenseEngineModel(p["Offsets"], p["Lanes"], p["MaxWindow"]))


@pytest.mark.parametrize(("offsets", "lanes", "window", "sizes", "width"), [(8, 4, 16, 2, 40), (16, 8, 32, 3, 60)])
def test_engine(offsets: int, lanes: int, window: int, sizes: int, width: int) -> None:
    simulate("slog_dense_engine", __name__, {"Offsets": offsets, "Lanes": lanes, "MaxWindow": window, "Sizes": sizes,
                                             "MaxWidth": width})


def test_timing_diagram() -> None:
    """The picture in the documentation, of an engine that is small enough to draw."""
    wave = WAVES["dense"]()
    simulate(wave.top, __name__, wave.parameters, testcase="timing_diagram")
