# SPDX-License-Identifier: Apache-2.0
"""`slog_counters` with few bits, so that the counters wrap: on the board that takes 2**32 events."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.model import Inputs, Stimulus, Values
from sim.testbench.runner import simulate

CLOCKS = 400


class CountersModel:
    """Counts of `events` kinds of event, modulo 2**`bits`, packed, kind 0 lowest."""

    INPUTS = ("rst_i", "event_i")
    OUTPUTS = ("count_o",)

    def __init__(self, events: int, bits: int) -> None:
        self.bits, self.counts, self.came = bits, [0] * events, 0
        self.wraps = 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock, then the clock edge."""
        out = sum(count << self.bits * k for k, count in enumerate(self.counts))
        for k in range(len(self.counts)):
            self.counts[k] += self.came >> k & 1
            self.wraps += self.counts[k] >> self.bits
            self.counts[k] %= 1 << self.bits
        self.came = i["event_i"]
        if i["rst_i"]:
            self.came, self.counts = 0, [0] * len(self.counts)
        return {"count_o": out}


def _traffic(rng: random.Random, events: int) -> Stimulus:
    """Random events, in every clock during a quarter of the time; a reset now and then."""
    for t in range(CLOCKS):
        event = (1 << events) - 1 if t % 80 >= 60 else rng.getrandbits(events)
        yield {"rst_i": int(t % 160 == 159), "event_i": event}


@cocotb.test()
async def every_clock(dut) -> None:
    model = CountersModel(params()["Events"], params()["Bits"])
    await check_cycles(dut, model, _traffic(random.Random(cocotb.RANDOM_SEED), params()["Events"]))
    assert model.wraps > 20


def test_counters() -> None:
    simulate("slog_counters", __name__, {"Events": 3, "Bits": 3})
