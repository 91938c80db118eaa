# SPDX-License-Identifier: Apache-2.0
"""`slog_job_plan` at more than full size against its cycle model on every clock."""

import random
from dataclasses import replace

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.correlator.job_plan import JobPlanModel, plan_latency
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import FULL
from golden.structs import pack_job
from golden.traffic.jobs import KINDS, acceptable, mixed
from sim.testbench.runner import simulate

LARGEST = replace(FULL, max_width=9 * FULL.group_bits, max_height=900, slots=8)
"""A board that needs every bit of addresses, rows and slots; words per row are no power of two."""


@cocotb.test()
@cocotb.parametrize(resets=[False, True])
async def every_clock(dut, resets: bool) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    config = LARGEST
    size = (config.max_width, config.max_height)
    jobs = [acceptable(rng, config, size, kind) for kind in KINDS for _ in range(12)]
    jobs += mixed(rng, config, size, [True] * 7 + [False], 30)
    rng.shuffle(jobs)
    defined = 0

    def asked() -> Stimulus:
        for n, job in enumerate(jobs):
            yield {"rst_i": 0, "start_i": 1, "job_i": pack_job(job)}
            cut = resets and n % 5 == 4
            for t in range(plan_latency(config) + rng.choice((0, 0, 4))):
                yield {"rst_i": int(cut and t == 2), "start_i": 0, "job_i": pack_job(job)}

    def count(_i: Inputs, out: Outputs) -> None:
        nonlocal defined
        defined += out["tpl_o"] is not None

    await check_cycles(dut, JobPlanModel(config), asked(), count)
    assert defined > len(jobs) // 2


def test_job_plan() -> None:
    simulate("slog_job_plan", __name__,
             {"Width": LARGEST.group_bits, "MaxHeight": LARGEST.max_height, "WordsPerRow": LARGEST.words_per_row})
