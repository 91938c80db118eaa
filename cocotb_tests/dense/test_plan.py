# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_plan` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.dense.plan import DensePlanModel
from golden.cycle.dense.structs import DENSE_JOB
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.dense_job import STEP_MAX, DenseStatus
from golden.params import DENSE
from golden.traffic.dense_block import any_job, bad_job, build_of, pack_start
from golden.traffic.lasting import lasting
from sim.coverage.record import met
from sim.testbench.runner import simulate

JOBS = 120
EXTREMES = {"start": (-512, 511), "down": (-512, 511), "step_x": (STEP_MAX,), "step_y": (STEP_MAX,),
            "offsets": (1, DENSE.dense_offsets)}
BUILD = build_of(DENSE, 2048)
PARAMETERS = {"Width": BUILD.width, "MaxHeight": BUILD.max_height, "WordsPerRow": BUILD.words_per_row,
              "Slots": BUILD.slots, "Offsets": BUILD.offsets, "Lanes": BUILD.lanes, "MaxWindow": BUILD.max_window,
              "Sizes": BUILD.sizes}


def _starts(rng: random.Random, jobs: list[dict[str, int]], seen: list[int]) -> Stimulus:
    """Jobs of every kind, good and bad, each held until it is done, some longer, some started anew after a reset; they
    are appended to `jobs`. They end when each status has been `seen`."""
    for number in lasting(JOBS, 10 * JOBS, lambda: set(seen) == set(range(5))):
        size = rng.randint(34, 640), rng.choice((16, 34, 480, rng.randint(34, 480)))
        job = (bad_job if number % 3 == 0 else any_job)(rng, DENSE, size[0])
        job["live"] = rng.getrandbits(1)
        valid, here = rng.choice((7, 7, 255, rng.getrandbits(8))), rng.choice((3, 3, rng.getrandbits(2)))
        if number % 12 == 5:  # a slot that the board has not, although its bits say that it holds a frame
            job[rng.choice(("left_slot", "right_slot"))], valid, here = rng.randint(DENSE.slots, 7), 255, 3
        jobs.append(job)
        held = {"job_i": pack_start(job), "image_width_i": size[0], "image_height_i": size[1]}
        out = yield {**held, "start_i": 1, "slot_valid_i": valid}
        cut = rng.randint(1, 20) if number % 10 == 9 else -1
        out = yield {**held, "slot_valid_i": rng.getrandbits(8), "here_i": rng.getrandbits(2)}
        while not out["done_o"] and cut:
            out = yield {**held, "slot_valid_i": rng.getrandbits(8), "here_i": here}
            cut -= 1
        for _ in range(rng.choice((0, 1, 5))):
            yield {**held, "slot_valid_i": rng.getrandbits(8), "here_i": here}
        if not out["done_o"]:
            yield {**held, "rst_i": 1}
        for _ in range(rng.choice((0, 1, 3))):
            yield {"job_i": rng.getrandbits(DENSE_JOB.bits), "image_width_i": rng.getrandbits(10)}


@cocotb.test()
async def every_clock(dut) -> None:
    seen: list[int] = []
    jobs: list[dict[str, int]] = []

    def watch(_: Inputs, out: Outputs) -> None:
        if out["done_o"]:
            seen.append(out["status_o"])

    await check_cycles(dut, DensePlanModel(BUILD), _starts(random.Random(cocotb.RANDOM_SEED), jobs, seen),
                       watch)
    assert set(seen) == set(range(5)) and seen.count(0) > JOBS // 3
    met("dense statuses", {status.name: seen.count(status) for status in DenseStatus})
    met("extreme dense searches", {f"{name} {value}": sum(job[name] == value for job in jobs)
                                   for name, values in EXTREMES.items() for value in values})


def test_plan() -> None:
    simulate("slog_dense_plan", __name__, PARAMETERS)
