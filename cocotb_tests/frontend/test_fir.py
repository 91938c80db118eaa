# SPDX-License-Identifier: Apache-2.0
"""`slog_fir` against its cycle model on every clock."""

import random

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.frontend.fir import FirModel, fir_latency
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate


def _windows(rng: random.Random, shape: str, p: dict[str, int]) -> Stimulus:
    """Random windows, and coefficients that change whenever the pipeline is empty; resets in between."""
    radius, latency = p["Radius"], fir_latency(p["Radius"], p["SumW"])
    bits = p["DataW"] * (2 * radius + 1)
    offer = ready_pattern(shape, rng)
    for run in range(12):
        coef = rng.getrandbits(18 * (radius + 1) * p["Kernels"])
        if rng.random() < 0.5:
            yield {"coef_i": coef, "window_i": rng.getrandbits(bits)}
        for _ in range(60):
            yield {"valid_i": next(offer), "coef_i": coef, "window_i": rng.getrandbits(bits)}
        if run % 4 == 3:
            yield {"rst_i": 1, "valid_i": 1, "coef_i": coef}
        for _ in range(latency):
            yield {"coef_i": coef, "window_i": rng.getrandbits(bits)}


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def every_clock(dut, shape: str) -> None:
    p = params()
    values: set[int] = set()

    def count(i: Inputs, out: Outputs) -> None:
        if out["sum_o"] is not None:
            values.add(out["sum_o"])

    model = FirModel(p["Radius"], p["DataW"], p["Kernels"], p["SumW"], p["Bias"])
    await check_cycles(dut, model, _windows(random.Random(cocotb.RANDOM_SEED), shape, p), count)
    assert len(values) > 100


@pytest.mark.parametrize("shape", [
    {"Radius": 8, "DataW": 8, "Kernels": 2, "SumW": 24, "Bias": 64},
    {"Radius": 8, "DataW": 32, "Kernels": 1, "SumW": 36, "Bias": -1},
    {"Radius": 3, "DataW": 18, "Kernels": 1, "SumW": 36, "Bias": 5},
    {"Radius": 16, "DataW": 32, "Kernels": 1, "SumW": 35, "Bias": -1},
], ids=["column", "row", "small", "large"])
def test_fir(shape: dict[str, int]) -> None:
    simulate("slog_fir", __name__, shape)
