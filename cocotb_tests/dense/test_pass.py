# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_pass` and `slog_dense_room` against their cycle models on every clock."""

import random
from collections.abc import Mapping

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.dense_pass import DensePassModel
from golden.cycle.dense.room import DenseRoomModel
from golden.cycle.dense.structs import CANCELLED, DENSE_JOB, LOST, OK
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import TINY_DENSE
from golden.traffic.dense_block import any_job, pack_start
from golden.traffic.lasting import lasting
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

STARTS = 60
CLOCKS = 4000
ENDS = {"all rows, cancelled", "all rows, lost", "rows missing, lost"}
"""Ends of live passes that must be met."""
TALL = 3
"""Number of the start whose image is as tall as a register can tell."""
PATIENCE = 400
"""Clocks without a row after which a host cancels: what a row or an end waits for may never come."""


def _enough(seen: Mapping[str, int]) -> bool:
    """Whether every end has been seen, and stalls, rows and tails often."""
    return (min(seen.get(name, 0) for name in ("stall_o", "row_o", "tail_o", "reset among rows")) > 5
            and {f"status {n}" for n in (0, 1, 4, CANCELLED, LOST)} | ENDS <= seen.keys())


def _host(rng: random.Random, seen: dict[str, int]) -> Stimulus:
    """Starts and cancels at any time; plan, feed, room, frames and sink answer after any time; a reset now and then."""
    for number in lasting(STARTS, 10 * STARTS, lambda: _enough(seen)):
        job = {**any_job(rng, TINY_DENSE, 48), "step_y": rng.choice((1, 1, 2, 3, 5, 255))}
        room, height, words = ready_pattern(rng.choice(SHAPES), rng), rng.randint(8, 20), rng.randint(1, 48)
        status, planned, cancel = rng.choice((0, 0, 0, 1, 4)), rng.randint(3, 20), rng.choice((0.0, 0.0, 0.005, 0.05))
        quiet, reset, rows = 0, rng.randint(1, 300) if number % 8 == 1 else -1, 0
        there = ready_pattern(rng.choice(SHAPES), rng)
        # When both frames are whole, and when one is lost; a pass over frames that are there waits for none.
        whole = rng.choice((0, 0, rng.randint(1, 300), 10 * PATIENCE))
        lost = rng.randint(1, 300) if whole and rng.random() < 0.4 else 10 * PATIENCE
        if number == TALL:
            height, status, cancel, whole, job["step_y"] = rng.randint(513, 1023), 0, 0.0, 0, 255
        out = yield {"start_i": 1, "job_i": pack_start(job), "image_width_i": 48, "image_height_i": height,
                     "cancel_i": rng.getrandbits(1)}
        clock = 0
        while not out["done_o"] and clock != reset:
            clock += 1
            quiet = 0 if out["row_o"] or out["reserve_o"] else quiet + 1
            rows += out["row_o"] or 0
            seen["reset among rows"] = seen.get("reset among rows", 0) + (clock == reset and 0 < rows < height)
            now = clock >= min(whole, lost)
            ends = {"whole_i": int(now and whole <= lost), "lost_i": int(now and lost < whole),
                    "there_i": int(next(there) or whole == 0 or now), "keep_i": rng.getrandbits(2)}
            stop = rng.random() < cancel or quiet > PATIENCE
            out = yield {**ends, "start_i": int(rng.random() < 0.1), "job_i": rng.getrandbits(DENSE_JOB.bits),
                         "image_width_i": rng.getrandbits(10), "cancel_i": int(stop),
                         "planned_i": int(clock == planned), "status_i": status, "pitch_i": 9 + number % 3,
                         "row_words_i": words, "feed_busy_i": int(quiet < 20), "room_i": next(room),
                         "empty_i": int(quiet > 2 and rng.random() < 0.2)}
        if not out["done_o"]:
            yield {"rst_i": 1, "job_i": rng.getrandbits(DENSE_JOB.bits)}
        for _ in range(rng.choice((0, 1, 3))):
            yield {"job_i": rng.getrandbits(DENSE_JOB.bits), "cancel_i": rng.getrandbits(1)}


def _words(rng: random.Random) -> Stimulus:
    """Rows of any number of words as soon as there is room or later, taken at once, slowly, or not for long."""
    depth, owed, since, words = params()["Depth"], 0, 0, 0
    for t in range(CLOCKS):
        if since == 0:
            words = rng.choice((0, 1, depth, rng.randint(1, depth)))
        pace = (0.0, 0.3, 1.0)[t // 100 % 3]
        taken = int(owed > 0 and rng.random() < pace)
        reset = int(t % 1500 == 1499)
        out = yield {"rst_i": reset, "words_i": words, "taken_i": taken, "reserve_i": 0}
        owed, since = (0, 0) if reset else (owed - taken, since + 1)
        if since > 2 and out["room_o"] and owed + words <= depth and not reset and rng.random() < 0.5:
            yield {"words_i": words, "reserve_i": 1}
            owed, since = owed + words, 0


@cocotb.test()
async def every_clock(dut) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    seen: dict[str, int] = {}

    def watch(_: Inputs, out: Outputs) -> None:
        for name in ("room_o", "empty_o", "stall_o", "row_o", "tail_o"):
            seen[name] = seen.get(name, 0) + (out.get(name) or 0)
        if out.get("done_o"):
            seen[f"status {out['status_o']}"] = 1
            missing = "rows missing" if seen.get("tails") else "all rows"
            named = {CANCELLED: "cancelled", LOST: "lost", OK: "good"}
            seen[f"{missing}, {named.get(out['status_o'], 'refused')}"] = 1
            seen["tails"] = 0
        seen["tails"] = seen.get("tails", 0) + (out.get("tail_o") or 0)

    if dut._name == "slog_dense_room":
        await check_cycles(dut, DenseRoomModel(params()["Depth"]), _words(rng), watch)
        assert CLOCKS // 10 < seen["room_o"] < CLOCKS and seen["empty_o"] > 10
    else:
        await check_cycles(dut, DensePassModel(params()["Flush"]), _host(rng, seen), watch)
        assert _enough(seen), seen


@pytest.mark.parametrize(("part", "parameters"), [("pass", {"Flush": 12}), ("room", {"Depth": 20})])
def test_pass(part: str, parameters: dict[str, int]) -> None:
    simulate(f"slog_dense_{part}", __name__, parameters)
