# SPDX-License-Identifier: Apache-2.0
"""`slog_store` against its cycle model on every clock: two slices of five banks, of 512, 512, 256, 128 and 16 words."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.diagram import check_diagram
from cocotb_tests.env.params import params
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.store import STORE_LATENCY, StoreModel
from golden.traffic.stalls import SHAPES, coin, ready_pattern
from sim.testbench.runner import simulate

CLOCKS = 1500
WORDS, BANK_WORDS = 1424, 512
BANKS = 512, 1024, 1280, 1408
"""Where banks begin behind the first one."""


def _accesses(rng: random.Random, words: int, width: int, reads: str, peeks: str) -> Stimulus:
    """Writes, reads and peeks at hot addresses and at bank edges; no read of what was written in the clock before, but
    peeks of it."""
    hot = [0, words - 1, *rng.sample(range(words), 12), *BANKS, *(start - 1 for start in BANKS)]
    # A rare peek comes at any time of the one before.
    read, peek = ready_pattern(reads, rng), coin(0.15, rng) if peeks == "rare" else ready_pattern(peeks, rng)
    peeked: int | None = None
    pending: int | None = None
    written: int | None = None
    for t in range(CLOCKS):
        if peeked is None and next(peek):
            peeked = rng.choice(hot)
        rd_valid, rd_addr, wr_addr = next(read), rng.choice([a for a in hot if a != written]), rng.choice(hot)
        if pending is not None and rng.random() < 0.5:
            wr_addr = pending
        wr_valid = int(rng.random() < 0.5)
        written = wr_addr if wr_valid else None
        out = yield {"rst_i": int(t == CLOCKS // 2), "wr_valid_i": wr_valid, "wr_addr_i": wr_addr,
                     "wr_data_i": rng.getrandbits(width), "rd_valid_i": rd_valid, "rd_addr_i": rd_addr,
                     "peek_valid_i": int(peeked is not None),
                     "peek_addr_i": rng.choice(hot) if peeked is None else peeked}
        if out["peek_done_o"]:
            pending = None
        if peeked is not None and out["peek_ready_o"]:
            pending, peeked = peeked, None


@cocotb.test()
@cocotb.parametrize(reads=SHAPES, peeks=("none", "random", "rare"))
async def every_clock(dut, reads: str, peeks: str) -> None:
    rng = random.Random(cocotb.RANDOM_SEED)
    values: set[int] = set()
    done = undefined = 0

    def count(i: Inputs, out: Outputs) -> None:
        nonlocal done, undefined
        done += bool(out["peek_done_o"])
        undefined += bool(out["peek_done_o"]) and out["peek_data_o"] is None
        if out["rd_data_o"] is not None:
            values.add(out["rd_data_o"])

    p = params()
    await check_cycles(dut, StoreModel(p["Words"]), _accesses(rng, p["Words"], p["Width"], reads, peeks), count)
    assert len(values) > 100
    # Reads in every clock leave no clock for a peek.
    assert done == 0 if reads == "none" else done > 15
    # Some peeks met the clock after a write to their word, most did not.
    assert reads == "none" or 0 < undefined < 0.9 * done


@cocotb.test()
async def latency(dut) -> None:
    """Read to data 10 clocks; peek to done 11 clocks, plus the wait for a clock without a read."""
    p = params()
    seen: list[tuple[int, str, int | None]] = []
    quiet = {"rst_i": 0, "wr_valid_i": 0, "rd_valid_i": 0, "peek_valid_i": 0}

    def script() -> Stimulus:
        yield {**quiet, "wr_valid_i": 1, "wr_addr_i": 700, "wr_data_i": 0xA5}
        yield {**quiet, "wr_valid_i": 1, "wr_addr_i": 3, "wr_data_i": 0x3C}
        yield {**quiet, "rd_valid_i": 1, "rd_addr_i": 700}
        for _ in range(STORE_LATENCY + 1):
            yield quiet
        yield {**quiet, "peek_valid_i": 1, "peek_addr_i": 3}
        for _ in range(STORE_LATENCY + 2):
            yield quiet
        yield {**quiet, "peek_valid_i": 1, "peek_addr_i": 700}
        for _ in range(3):
            yield {**quiet, "rd_valid_i": 1, "rd_addr_i": 3}
        for _ in range(STORE_LATENCY + 1):
            yield quiet

    clock = 0

    def note(_i: Inputs, out: Outputs) -> None:
        nonlocal clock
        if out["peek_done_o"]:
            seen.append((clock, "peek", out["peek_data_o"]))
        if out["rd_data_o"] is not None and not any(kind == "read" for _, kind, _ in seen):
            seen.append((clock, "read", out["rd_data_o"]))
        clock += 1

    await check_cycles(dut, StoreModel(p["Words"]), script(), note)
    assert seen == [(2 + STORE_LATENCY, "read", 0xA5), (5 + 2 * STORE_LATENCY, "peek", 0x3C),
                    (11 + 3 * STORE_LATENCY, "peek", 0xA5)]


@cocotb.test()
async def timing_diagram(dut) -> None:
    await check_diagram(dut, "store", StoreModel(params()["Words"]))


def test_store() -> None:
    simulate("slog_store", __name__, {"Width": 8, "Words": WORDS, "BankWords": BANK_WORDS, "SliceW": 4})
