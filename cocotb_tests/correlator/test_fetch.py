# SPDX-License-Identifier: Apache-2.0
"""`slog_fetch` against its cycle model on every clock; its parts are tested at full size in files of their own."""

import random
from collections import Counter, deque

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.correlate import Job, Status
from golden.cycle.correlator.fetch import PAUSE, FetchModel
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.store import STORE_LATENCY
from golden.params import TINY
from golden.structs import TICKET, pack_job, unpack_job
from golden.traffic.jobs import mixed
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.coverage.record import met
from sim.testbench.runner import simulate

SIZE = (47, 35)
VALID = [True, False, True, True, False, True, False, False]
RING = 2 * TINY.ring_rows


def _search_rows(ticket: dict[str, int]) -> int:
    job = unpack_job(ticket["job"])
    return job.height + job.offsets_y - 1


def _tickets_taken(rng: random.Random, jobs: list[Job], source: str, sink: str, reset_at: int | None) -> Stimulus:
    """Jobs in; a simplified sequencer takes the tickets and frees rows and banks some time later.

    The store returns noise, which does not affect the control of the unit; every output is compared.
    """
    offer, take = ready_pattern(source, rng), ready_pattern(sink, rng)
    waiting = [pack_job(j) for j in jobs]
    held: deque[dict[str, int]] = deque()  # tickets taken whose bank is not yet free
    offered = False
    give = t = 0
    total = begun = back = 0  # search rows: written, before those of the oldest ticket, freed
    valid = sum(1 << s for s in range(8) if VALID[s])
    left = 40
    while left:
        assert t < 20000, "the jobs never end"
        bank_free, give = give, 0
        offered = bool(waiting) and (offered or bool(next(offer)))
        reset = int(t == reset_at)
        job = waiting[0] if offered else rng.getrandbits(98)
        out = yield {"rst_i": reset, "job_valid_i": int(offered), "job_i": job, "image_width_i": SIZE[0],
                     "image_height_i": SIZE[1], "slot_valid_i": valid, "rd_data_i": rng.getrandbits(TINY.group_bits),
                     "ticket_ready_i": (ready := next(take)), "rows_freed_i": back % RING, "bank_free_i": bank_free}
        t += 1
        if reset:
            held.clear()
            give = total = begun = back = 0
            offered = False
            continue
        if offered and out["job_ready_o"]:
            waiting.pop(0)
            offered = False
        if out["ticket_valid_o"] and ready:
            assert out["ticket_o"] is not None
            ticket = TICKET.unpack(out["ticket_o"])
            if ticket["status"] == Status.OK:
                assert ticket["row"] == (begun + sum(_search_rows(h) for h in held)) % RING
                held.append(ticket)
        total += ((out["rows_written_o"] or 0) - total) % RING
        if held and out["tpl_done_o"] >> held[0]["bank"] & 1 and next(take):
            end = begun + _search_rows(held[0])
            # Rows are freed one by one while the window still fits, the rest together with the bank.
            if total >= end:
                if rng.random() < 0.2:
                    begun = back = end
                    give = 1
                    held.popleft()
            elif total - back >= unpack_job(held[0]["job"]).height:
                back += 1
        left = 40 if waiting or held or out["busy_o"] else left - 1


@cocotb.test()
@cocotb.parametrize(source=("none", "random"), sink=SHAPES)
async def every_clock(dut, source: str, sink: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs = mixed(rng, TINY, SIZE, VALID, 20, most_offsets=120)
    counts: Counter[str] = Counter()

    def count(i: Inputs, out: Outputs) -> None:
        for name in ("rd_valid_o", "wr_valid_o"):
            counts[name] += bool(out[name])
        counts["ticket"] += bool(out["ticket_valid_o"] and i["ticket_ready_i"])

    await check_cycles(dut, FetchModel(TINY), _tickets_taken(rng, jobs, source, sink, None), count)
    assert counts["ticket"] == 20
    assert counts["rd_valid_o"] >= counts["wr_valid_o"] > 500


@cocotb.test()
@cocotb.parametrize(reset_at=(60, 165, 402))
async def reset_in_work(dut, reset_at: int) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    jobs = mixed(rng, TINY, SIZE, VALID, 12, most_offsets=60)
    tickets = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal tickets
        tickets += bool(out["ticket_valid_o"] and i["ticket_ready_i"])

    await check_cycles(dut, FetchModel(TINY), _tickets_taken(rng, jobs, "none", "none", reset_at), count)
    assert tickets >= 10


@cocotb.test()
async def latency(dut) -> None:
    """The latencies in the header of the module, from an idle unit."""
    job = Job(0, 5, 3, 8, 2, 2, 7, 4, 2, 2)
    at: dict[str, int] = {}
    clock = 0

    def script() -> Stimulus:
        fixed = {"image_width_i": SIZE[0], "image_height_i": SIZE[1], "slot_valid_i": 0xFF, "job_i": pack_job(job)}
        yield fixed | {"job_valid_i": 1}
        for _ in range(60):
            yield fixed

    def note(_i: Inputs, out: Outputs) -> None:
        nonlocal clock
        for name in ("ticket_valid_o", "rd_valid_o", "wr_valid_o", "tpl_done_o", "rows_written_o"):
            if out[name] and name not in at:
                at[name] = clock
        clock += 1

    await check_cycles(dut, FetchModel(TINY), script(), note)
    align = 1 + 4  # with the register before slog_align
    read = 18
    # Template: two rows of two words, one aligned word each; search: three rows of 9 bits across two words.
    assert at == {"ticket_valid_o": 14, "rd_valid_o": read, "wr_valid_o": read + STORE_LATENCY + align,
                  "tpl_done_o": read + 2 + STORE_LATENCY + align + 1,
                  "rows_written_o": read + 4 + PAUSE + 1 + STORE_LATENCY + align + 1}


@cocotb.test()
async def offered_at_any_time(dut) -> None:
    """Refused jobs, each after a pause that is a clock longer: they wait for every time down to none."""
    job = pack_job(Job(0, 5, 3, 8, 2, 2, 7, 4, 0, 2))
    waits: list[int] = []

    def script() -> Stimulus:
        fixed = {"image_width_i": SIZE[0], "image_height_i": SIZE[1], "slot_valid_i": 0xFF, "ticket_ready_i": 1}
        for pause in range(40):
            for _ in range(pause):
                yield fixed
            waits.append(0)
            while not (yield fixed | {"job_valid_i": 1, "job_i": job})["job_ready_o"]:
                waits[-1] += 1

    await check_cycles(dut, FetchModel(TINY), script())
    assert {0, 1, 2, 8} <= set(waits) and waits[-1] == 0


@cocotb.test()
@cocotb.parametrize(words=(1, 2))
async def full_ring(dut, words: int) -> None:
    """Rows of one or two words stop when the ring is full to its last row, and continue as rows are freed."""
    job = Job(0, 5, 3, 3, 2, 2, 8, 0, 6 * words - 3, 34)
    steps = (0, 1, 2, 3)
    written: list[int] = []

    def script() -> Stimulus:
        fixed = {"image_width_i": SIZE[0], "image_height_i": SIZE[1], "slot_valid_i": 0xFF, "job_i": pack_job(job),
                 "ticket_ready_i": 1}
        yield fixed | {"job_valid_i": 1}
        for freed in steps:
            out: Outputs = {}
            for _ in range(130 if freed == 0 else 24):
                out = yield fixed | {"rows_freed_i": freed}
            written.append(out["rows_written_o"] or 0)

    await check_cycles(dut, FetchModel(TINY), script())
    assert written == [TINY.ring_rows + freed for freed in steps]
    met("ring", {f"full, rows of {words} words": written.count(TINY.ring_rows), "freed row by row when full": 1})


@cocotb.test()
async def template_beside_a_full_ring(dut) -> None:
    """The rows of one job fill the ring: the next job's template is read all the same, its search rows wait."""
    jobs = [pack_job(Job(0, 5, 3, 3, 3, 2, 8, 0, 3, TINY.ring_rows - 2)), pack_job(Job(0, 5, 3, 8, 2, 2, 7, 4, 2, 2))]
    seen: list[tuple[int, int]] = []

    def script() -> Stimulus:
        fixed = {"image_width_i": SIZE[0], "image_height_i": SIZE[1], "slot_valid_i": 0xFF, "ticket_ready_i": 1}
        taken = 0
        for freed in (0, 3):
            out: Outputs = {}
            for _ in range(300):
                out = yield fixed | {"job_valid_i": int(taken < 2), "job_i": jobs[min(taken, 1)], "rows_freed_i": freed}
                taken += taken < 2 and bool(out["job_ready_o"])
            seen.append((out["tpl_done_o"] or 0, out["rows_written_o"] or 0))

    await check_cycles(dut, FetchModel(TINY), script())
    assert seen == [(3, TINY.ring_rows), (3, TINY.ring_rows + 3)]


def test_fetch() -> None:
    c = TINY
    simulate("slog_fetch", __name__,
             {"Width": c.group_bits, "MaxHeight": c.max_height, "WordsPerRow": c.words_per_row, "Slots": c.slots,
              "MinWindow": c.min_window, "MaxWindow": c.max_window, "RingRows": c.ring_rows})
