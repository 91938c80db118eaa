"""Cocotb side of the `slog_fir` test."""

import random

import cocotb

from cocotb_tests.env.cycle import Inputs, Outputs, Stimulus, check_cycles
from cocotb_tests.env.params import params
from cocotb_tests.env.stalls import SHAPES, willing
from golden.cycle_log import FirModel, levels


def windows(rng: random.Random, shape: str, p: dict[str, int]) -> Stimulus:
    """Random windows, borders and coefficients, which change whenever the pipeline is empty; resets in between."""
    radius, latency = p["Radius"], 4 + levels(p["Radius"])
    taps = 1 if p["Row"] else 2 * radius + 1
    offer = willing(shape, rng)
    for run in range(12):
        coef = rng.getrandbits(18 * (radius + 1) * p["Kernels"])
        mask = (1 << radius) - 1
        for _ in range(60):
            # Borders half of the time: one side or both.
            beyond = [mask >> k << k if rng.getrandbits(1) else 0 for k in (rng.randint(0, radius), rng.randrange(4))]
            yield {"valid_i": next(offer), "coef_i": coef,
                   "window_i": rng.getrandbits(p["DataW"] * taps), "edge_i": rng.getrandbits(p["DataW"]),
                   "beyond_old_i": beyond[run % 2], "beyond_new_i": beyond[1 - run % 2]}
        if run % 4 == 3:
            yield {"rst_i": 1, "valid_i": 1, "coef_i": coef}
        for _ in range(latency):
            yield {"coef_i": coef, "window_i": rng.getrandbits(p["DataW"] * taps)}


@cocotb.test()
@cocotb.parametrize(shape=SHAPES)
async def every_clock(dut, shape: str) -> None:
    p = params()
    values: set[int] = set()

    def count(i: Inputs, out: Outputs) -> None:
        if out["sum_o"] is not None:
            values.add(out["sum_o"])

    model = FirModel(p["Radius"], p["DataW"], bool(p["Row"]), p["Kernels"], p["SumW"], p["Bias"])
    await check_cycles(dut, model, windows(random.Random(cocotb.RANDOM_SEED), shape, p), count)
    assert len(values) > 100
