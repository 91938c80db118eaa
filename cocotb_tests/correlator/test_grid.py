# SPDX-License-Identifier: Apache-2.0
"""`slog_grid` against its cycle model, and so the frame-level grid, on every clock."""

import random
from collections.abc import Callable

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from golden.cycle.correlator.grid import GridModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.structs import JOB, unpack_job
from golden.traffic.lasting import lasting
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

CLOCKS = 400


def _commands(rng: random.Random, source: str, sink: str, enough: Callable[[], bool]) -> Stimulus:
    """Random grids, some beyond the coordinate range, with one reset in mid-grid, until there are `enough`."""
    offer, take = ready_pattern(source, rng), ready_pattern(sink, rng)
    held: Inputs | None = None
    room = 0  # stays set until a job is offered
    for t in lasting(CLOCKS, 10 * CLOCKS, enough):
        garbage = {"job_i": rng.getrandbits(JOB.bits), "count_x_i": rng.choice((0, 1, 1, 2, 5)),
                   "count_y_i": rng.choice((0, 1, 1, 2, 4)), "step_x_i": rng.choice((0, 1, 16, 300, 1023)),
                   "step_y_i": rng.choice((0, 1, 16, 300, 1023))}
        if held is None and next(offer):
            held = garbage
        room = room or next(take)
        out = yield {"rst_i": int(t == CLOCKS // 2), "job_valid_i": int(held is not None), "job_ready_i": room,
                     **(held or garbage)}
        if out["job_ready_o"]:
            held = None
        if out["job_valid_o"]:
            room = 0


@cocotb.test()
@cocotb.parametrize(source=SHAPES, sink=SHAPES)
async def every_clock(dut, source: str, sink: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs, edge = 0, 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal jobs, edge
        if out["job_valid_o"] and i["job_ready_i"]:
            jobs += 1
            edge += 1023 in (unpack_job(out["job_o"]).tpl_x, unpack_job(out["job_o"]).search_y)

    def enough() -> bool:
        return jobs > CLOCKS // 12 and edge > 0

    await check_cycles(dut, GridModel(), _commands(rng, source, sink, enough), count)
    assert enough()


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "correlator", GridModel())


@cocotb.test()
async def large_grids(dut) -> None:
    """Grids of up to 1023 jobs across or down, each cut by a reset after its first jobs; then one that ends."""
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs = 0

    def stimulus() -> Stimulus:
        for n in range(60):
            counts = (2, 1) if n == 59 else rng.sample((rng.getrandbits(10), rng.randint(1, 3)), 2)
            grid = {"job_i": rng.getrandbits(JOB.bits), "step_x_i": rng.getrandbits(10),
                    "step_y_i": rng.getrandbits(10), "count_x_i": counts[0], "count_y_i": counts[1]}
            offered = True
            for _ in range(rng.randint(12, 40)):
                out = yield {**grid, "job_valid_i": int(offered), "job_ready_i": 1}
                offered = offered and not out["job_ready_o"]
            if n < 59:
                yield {**grid, "rst_i": 1}

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal jobs
        jobs += bool(out["job_valid_o"] and not i["rst_i"])

    await check_cycles(dut, GridModel(), stimulus(), count)
    assert jobs > 100


def test_grid() -> None:
    simulate("slog_grid", __name__)
