# SPDX-License-Identifier: Apache-2.0
"""`slog_walker` against its cycle model on every clock."""

import random
from collections.abc import Callable

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.array.timing import drain_clocks
from golden.cycle.correlator.walker import WalkerModel, row_counts
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY
from golden.structs import STEP, STEP_ROW
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

MOST = 800
"""Most rows of a run beyond those asked for."""


def _random_row(rng: random.Random, pitch: int, ring: int) -> int:
    steps = rng.choice((1, 1, 2, 3, rng.randint(1, 16)))
    return STEP_ROW.pack({
        "final_row": rng.getrandbits(1), "bank": rng.getrandbits(1), "wide": rng.getrandbits(1),
        "odd": rng.getrandbits(1), "ring_row": rng.randrange(ring), "last_lanes": rng.randint(1, pitch + 1),
        "free_to": rng.randrange(2 * ring),
        **row_counts(steps, passes=rng.choice((1, 1, 2, 3, 6)), gap_row=rng.choice((0, 0, 1, pitch)),
                     gap_pass=rng.choice((0, 0, 1, 2, pitch)))})


def _rows(rng: random.Random, source: str, pitch: int, ring: int, count: int, reset_at: int,
          enough: Callable[[], bool]) -> Stimulus:
    """`count` random rows, and on until `enough()`, offered by the stall shape `source`, with a reset in clock
    `reset_at`."""
    offer = ready_pattern(source, rng)
    row: int | None = None
    clock = 0
    while count > 0 or not enough():
        assert count > -MOST, "too little is met"
        if row is None and next(offer):
            row = _random_row(rng, pitch, ring)
        reset = int(clock == reset_at)
        out = yield {"rst_i": reset, "row_valid_i": int(row is not None),
                     "row_i": rng.getrandbits(STEP_ROW.bits) if row is None else row}
        clock += 1
        if row is not None and out["row_ready_o"] and not reset:
            row = None
            count -= 1
    for _ in range(250):
        yield {"rst_i": 0}


@cocotb.test()
@cocotb.parametrize(source=SHAPES)
async def every_clock(dut, source: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    p = params()
    steps = passes = drained = 0

    def count(_i: Inputs, out: Outputs) -> None:
        nonlocal steps, passes, drained
        drained += bool(out["drained_o"])
        if out["step_valid_o"]:
            assert out["step_o"] is not None
            steps += 1
            passes += STEP.unpack(out["step_o"])["last"]

    model = WalkerModel(p["Pitch"], p["RingRows"], p["DrainClocks"])

    def enough() -> bool:
        return steps > 400 and passes > 120

    await check_cycles(dut, model, _rows(rng, source, p["Pitch"], p["RingRows"], 80, 300, enough), count)
    assert enough() and drained > 50


@cocotb.test()
async def reset_in_any_clock(dut) -> None:
    """A short row is cut by a reset after any number of clocks; then nothing comes until the array is drained."""
    p = params()
    row = STEP_ROW.pack({"final_row": 1, "bank": 1, "wide": 0, "odd": 0, "ring_row": 3, "last_lanes": 2, "free_to": 9,
                         **row_counts(2, passes=2, gap_row=1, gap_pass=1)})
    drained = 0

    def stimulus() -> Stimulus:
        nonlocal drained
        for moment in range(1, 16):
            offered = 1
            for t in range(moment + 1):
                out = yield {"row_valid_i": offered, "row_i": row, "rst_i": int(t == moment)}
                offered &= not out["row_ready_o"]
            for _ in range(p["DrainClocks"] + 6):
                out = yield {}
            drained += bool(out["drained_o"])

    await check_cycles(dut, WalkerModel(p["Pitch"], p["RingRows"], p["DrainClocks"]), stimulus())
    assert drained == 15


def test_walker() -> None:
    simulate("tb_walker", __name__,
             {"Pitch": TINY.pitch, "RingRows": TINY.ring_rows,
              "DrainClocks": drain_clocks(TINY.group_bits, TINY.lanes)})
