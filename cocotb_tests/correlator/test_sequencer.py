# SPDX-License-Identifier: Apache-2.0
"""`slog_sequencer`, including its walker, against its cycle model on every clock."""

import random
from collections import Counter, deque

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from golden.correlate import Job, Status, check
from golden.cycle.array.timing import drain_clocks
from golden.cycle.correlator.sequencer import SequencerModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.params import FULL, TINY, Config
from golden.structs import STEP, TICKET, pack_job, unpack_job
from golden.traffic.jobs import mixed
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

SIZE = (47, 35)
VALID = [True] * 6 + [False] * 2
RING = 2 * TINY.ring_rows
ENDS = ("ticket", "ctx", "row", "load")


def _model() -> SequencerModel:
    return SequencerModel(TINY.group_bits, TINY.pitch, TINY.ring_rows, drain_clocks(TINY.group_bits, TINY.lanes))


def _tickets(rng: random.Random, jobs: list[Job], shapes: dict[str, str], reset_at: int | None) -> Stimulus:
    """A simplified fetch unit: tickets in order while a bank is free, templates and rows written some time later."""
    ends = {name: ready_pattern(shape, rng) for name, shape in shapes.items()}
    waiting = deque(jobs)
    loading: deque[tuple[int, int]] = deque()  # (bank, rows still to write)
    bank, used, done, written, given = 1, 0, 0, 0, 0
    ticket: int | None = None
    t = 0
    quiet = 60
    while quiet:
        assert t < 20000, "the jobs never end"
        if ticket is None and waiting and used < 2 and next(ends["ticket"]):
            job = waiting[0]
            status = check(job, TINY, SIZE, VALID)
            if status is Status.OK:
                bank, used = 1 - bank, used + 1
                done &= ~(1 << bank)
            waiting.popleft()
            ticket = TICKET.pack({"job": pack_job(job), "status": status, "row": given,
                                  "bank": bank if status is Status.OK else 1 - bank,
                                  "area": job.width * job.height & 0x7FFF})
            if status is Status.OK:
                rows = job.height + job.offsets_y - 1
                loading.append((bank, rows))
                given = (given + rows) % RING
        reset = int(t == reset_at)
        out = yield {"rst_i": reset, "ticket_valid_i": int(ticket is not None),
                     "ticket_i": rng.getrandbits(TICKET.bits) if ticket is None else ticket, "tpl_done_i": done,
                     "rows_written_i": written, "ctx_ready_i": next(ends["ctx"]), "row_ready_i": next(ends["row"])}
        t += 1
        if reset:
            loading.clear()
            bank, used, done, written, given = 1, 0, 0, 0, 0
            if ticket is not None:
                waiting.appendleft(unpack_job(TICKET.unpack(ticket)["job"]))
            ticket = None
            continue
        if ticket is not None and out["ticket_ready_o"]:
            ticket = None
        used -= out["bank_free_o"] or 0
        if loading and bool(next(ends["load"])):
            loading_bank, missing = loading[0]
            freed = out["rows_freed_o"]
            assert freed is not None
            if not done >> loading_bank & 1:
                done |= 1 << loading_bank
            elif (written - freed) % RING < TINY.ring_rows:
                written = (written + 1) % RING
                loading[0] = loading_bank, missing - 1
                if missing == 1:
                    loading.popleft()
        quiet = 60 if waiting or loading or ticket is not None or out["busy_o"] else quiet - 1


@cocotb.test()
@cocotb.parametrize(shape=SHAPES, end=("all", *ENDS))
async def every_clock(dut, shape: str, end: str) -> None:
    """Each end stalled by itself, and all together."""
    if shape == "none" and end != "all":
        return
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs = mixed(rng, TINY, SIZE, VALID, 12, most_offsets=40)
    shapes = {e: shape if end in ("all", e) else "none" for e in ENDS}
    counts: Counter[str] = Counter()

    def count(i: Inputs, out: Outputs) -> None:
        counts["ctx"] += bool(out["ctx_valid_o"] and i["ctx_ready_i"])
        counts["row"] += bool(out["row_valid_o"] and i["row_ready_i"])
        if out["step_valid_o"]:
            assert out["step_o"] is not None
            step = STEP.unpack(out["step_o"])
            counts["scores"] += step["lanes"] * step["last"]

    await check_cycles(dut, _model(), _tickets(rng, jobs, shapes, None), count)
    good = [j for j in jobs if check(j, TINY, SIZE, VALID) is Status.OK]
    assert counts["ctx"] == len(jobs) == 12
    assert counts["row"] == sum(j.offsets_y for j in good) > 20
    assert counts["scores"] == sum(j.offsets_x * j.offsets_y for j in good) > 100


@cocotb.test()
@cocotb.parametrize(reset_at=(45, 130, 401))
async def reset_in_work(dut, reset_at: int) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs = mixed(rng, TINY, SIZE, VALID, 12, most_offsets=60)
    contexts = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal contexts
        contexts += bool(out["ctx_valid_o"] and i["ctx_ready_i"])

    await check_cycles(dut, _model(), _tickets(rng, jobs, dict.fromkeys(ENDS, "none"), reset_at), count)
    assert contexts >= 8


def _alone(config: Config, job: Job, row: int, bank: int) -> Inputs:
    """Inputs for a job whose ticket is offered while nothing else goes on; its rows are all written."""
    ticket = {"job": pack_job(job), "status": Status.OK, "row": row, "bank": bank,
              "area": job.width * job.height & 0x7FFF}
    return {"ticket_valid_i": 1, "ticket_i": TICKET.pack(ticket), "ctx_ready_i": 1, "row_ready_i": 1, "tpl_done_i": 3,
            "rows_written_i": (row + job.height + job.offsets_y - 1) % (2 * config.ring_rows)}


@cocotb.test()
async def reset_in_any_clock(dut) -> None:
    """A short job is cut by a reset after any number of clocks, and offered again in the next clock."""
    inputs = _alone(TINY, Job(0, 5, 3, 8, 2, 0, 7, 4, 2, 1), 0, 0)
    ends = 0

    def stimulus() -> Stimulus:
        nonlocal ends
        for moment in range(1, 60):
            offered = 1
            for t in range(moment + 1):
                out = yield {**inputs, "ticket_valid_i": offered, "rst_i": int(t == moment)}
                offered &= not out["ticket_ready_o"]
                ends += bool(out["bank_free_o"])

    await check_cycles(dut, _model(), stimulus())
    assert ends >= 5


@cocotb.test()
async def full_size(dut) -> None:
    """Windows of every width modulo the mask's units, the widest rows, and templates that come after the rows."""
    config = FULL
    rng = random.Random(cocotb.RANDOM_SEED)
    shapes = [(config.max_window, 127, 513, 1), (8, 3, 633, 2), *((w, 2, rng.randint(1, 40), 1) for w in range(57, 74)),
              *((rng.randint(8, 128), rng.randint(8, 60), rng.randint(1, 80), 2) for _ in range(10))]
    scores = 0

    def stimulus() -> Stimulus:
        row = 0
        for n, (width, height, across, down) in enumerate(shapes):
            inputs = _alone(config, Job(0, 0, 0, width, height, 1, 0, 0, across, down), row, n % 2)
            wait = rng.choice((0, 100))
            busy, t = True, 0
            while busy:
                out = yield {**inputs, "ticket_valid_i": int(t == 0), "tpl_done_i": 3 if t >= wait else 0}
                t, busy = t + 1, t < 2 or bool(out["busy_o"])
            row = inputs["rows_written_i"]

    def count(_i: Inputs, out: Outputs) -> None:
        nonlocal scores
        if out["step_valid_o"]:
            assert out["step_o"] is not None
            step = STEP.unpack(out["step_o"])
            scores += step["lanes"] * step["last"]

    model = SequencerModel(config.group_bits, config.pitch, config.ring_rows,
                           drain_clocks(config.group_bits, config.lanes))
    await check_cycles(dut, model, stimulus(), count)
    assert scores == sum(across * down for _, _, across, down in shapes)


@pytest.mark.parametrize(("config", "testcase"), [(TINY, "every_clock|reset_in"), (FULL, "full_size")],
                         ids=lambda value: getattr(value, "name", None))
def test_sequencer(config: Config, testcase: str) -> None:
    simulate("tb_sequencer", __name__,
             {"GroupBits": config.group_bits, "Pitch": config.pitch, "RingRows": config.ring_rows,
              "DrainClocks": drain_clocks(config.group_bits, config.lanes)}, testcase=testcase)
