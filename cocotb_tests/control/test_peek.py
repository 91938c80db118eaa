# SPDX-License-Identifier: Apache-2.0
"""`slog_peek` against its cycle model on every clock: words of one and of two parts, new addresses at every moment."""

import random
from collections import Counter

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.control.peek import PeekModel
from golden.cycle.model import Inputs, Stimulus, Values
from golden.traffic.lasting import lasting
from sim.coverage.record import met
from sim.testbench.runner import simulate

CLOCKS = 6000
APART = 3
"""Clocks from one command of the host to the next: no register access is shorter."""


class PeekPort:
    """`PeekModel` by port names.

    `data_o` is undefined while not ready and for as long after as the module states.
    """

    INPUTS = ("rst_i", "go_i", "address_i", "take_i", "peek_ready_i", "peek_done_i", "peek_data_i")
    OUTPUTS = ("ready_o", "data_o", "peek_valid_o", "peek_addr_o")

    def __init__(self, group_bits: int, store_words: int) -> None:
        self.peek = PeekModel(group_bits, store_words)
        self.shown: int | None = None
        self.calm = 0  # clocks for which `shown` has been the word's part

    @property
    def settled(self) -> bool:
        """The next read gets its data."""
        return self.peek.ready and self.peek.data == self.shown and self.calm > self.peek.chunks

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        p = self.peek
        out: Values = {"ready_o": int(p.ready), "data_o": p.data if self.settled else None,
                       "peek_valid_o": int(p.valid), "peek_addr_o": p.address if p.valid else None}
        self.calm = self.calm + 1 if p.ready and p.data == self.shown else 0
        self.shown = p.data
        if i["rst_i"]:
            p.reset()
            self.calm = 0
        else:
            p.edge(go=i["go_i"], address=i["address_i"], take=bool(i["take_i"]), ready=i["peek_ready_i"],
                   done=i["peek_done_i"], data=i["peek_data_i"])
        return out


def _enough(seen: Counter[str]) -> bool:
    """Whether each of the six meetings has been seen often."""
    return len(seen) == 6 and min(seen.values()) >= 5


def _traffic(rng: random.Random, port: PeekPort, bits: int, words: int, seen: Counter[str]) -> Stimulus:
    """New addresses, some outside the store, while the word of the one before is asked for, on its way or there; the
    store takes a peek by preference as the address changes."""
    p = port.peek
    address = idle = 0
    answer: int | None = None  # clocks until the store's word
    for t in lasting(CLOCKS, 10 * CLOCKS, lambda: _enough(seen)):
        idle += 1
        rst = int(t % 401 == 400 or (idle < 10 and rng.random() < 0.01))
        may = idle >= APART and not rst
        go = int(may and rng.random() < (0.3 if p.valid else 0.05))
        take = int(may and not go and port.settled and rng.random() < 0.5)
        if go:
            address = rng.choice((rng.randrange(words), words - 1, words, 1 << 23, rng.getrandbits(24)))
        if go or take:
            idle = 0
        ready = int(answer is None and rng.random() < (0.8 if p.go else 0.15))
        done = int(answer == 0)
        seen["new address as its word is asked for"] += p.go and p.valid and not ready
        seen["new address as the store takes the one before"] += p.go and p.valid and bool(ready)
        seen["new address as a word is on its way"] += p.go and p.flight
        seen["read past the last word"] += bool(take) and p.address >= words
        seen["read of the last part"] += bool(take) and p.started and p.chunk == p.chunks - 1
        seen["read before an address"] += bool(take) and not p.started
        out = yield {"rst_i": rst, "go_i": go, "address_i": address, "take_i": take, "peek_ready_i": ready,
                     "peek_done_i": done, "peek_data_i": rng.getrandbits(bits)}
        if answer is not None:
            answer = None if done else answer - 1
        if ready and out["peek_valid_o"]:
            answer = rng.randrange(7)
        if rst:
            answer = None


@cocotb.test()
async def every_clock(dut) -> None:
    seen: Counter[str] = Counter()
    bits, words = params()["GroupBits"], params()["StoreWords"]
    port = PeekPort(bits, words)
    await check_cycles(dut, port, _traffic(random.Random(cocotb.RANDOM_SEED), port, bits, words, seen))
    dut._log.info(f"{dict(seen)}")
    met("peek under load", seen)
    assert _enough(seen), seen


@pytest.mark.parametrize("bits", [8, 64])
def test_peek(bits: int) -> None:
    simulate("slog_peek", __name__, {"GroupBits": bits, "StoreWords": 1000})
