# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_feed`, with `slog_dense_stream`, against its cycle model on every clock."""

import random
from collections import deque
from collections.abc import Generator

import cocotb

from cocotb_tests.env.check import check_cycles
from golden.cycle.bits import or_zero
from golden.cycle.dense.feed import DenseFeedModel
from golden.cycle.dense.plan import plan_of
from golden.cycle.dense.structs import PLAN
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.store import STORE_LATENCY
from golden.params import DENSE
from golden.traffic.dense_block import any_job, build_of
from sim.testbench.runner import simulate

PASSES = 6


class _Passes:
    """Rows of one pass after another at the closest or farther apart, and a store of words by chance; a reset among
    them."""

    def __init__(self, rng: random.Random) -> None:
        self.rng, self.build = rng, build_of(DENSE, 0)
        self.flight: deque[int] = deque([0] * STORE_LATENCY)
        self.columns = self.overlaps = 0

    def stimulus(self) -> Stimulus:
        """Every pass, the first of full width."""
        for number in range(PASSES):
            width = DENSE.max_width if number == 0 else self.rng.randint(18, 200)
            job = any_job(self.rng, DENSE, width)
            if number == 0:  # both planes' rows at once
                job["start"] = 0
            height = job["window"] + self.rng.randint(int(number == 1), 8)
            if number == 1:  # the right plane ends early: its first row outside is one that leaves the windows, too
                job |= {"start": 0, "down": -height}
                height += 1
            if number == 2:  # rows of the left plane leave the windows before the right plane's first one does
                job |= {"start": 0, "down": self.rng.randint(1, 3)}
                height = job["window"] + 4
            fields = plan_of(job, self.build, width)
            held = {"plan_i": PLAN.pack(fields), "down_i": job["down"] & 0x3FF, "width_i": width, "height_i": height}
            rows = 3 if number == 0 else held["height_i"]
            yield from self._clock(held)
            yield from self._clock(held, begin_i=1)
            for _ in range(self.rng.choice((1, 1, 4))):
                yield from self._clock(held)
            for y in range(rows):
                yield from self._clock(held, row_i=1)
                if number == PASSES // 2 and y == rows // 2:
                    yield from self._clock(held, rst_i=1)
                    break
                for _ in range(fields["pitch"] - 1 + self.rng.choice((0, 0, 1, 9))):
                    yield from self._clock(held)
            while (yield from self._clock(held)):
                pass

    def _clock(self, held: Inputs, **pulses: int) -> Generator[Inputs, Outputs, bool]:
        """A clock; returns whether rows are under way."""
        word = self.flight.popleft()
        out = yield {**held, **pulses, "rd_data_i": word}
        self.flight.append(self.rng.getrandbits(DENSE.group_bits))
        return bool(out["busy_o"])

    def watch(self, _: Inputs, out: Outputs) -> None:
        """Count columns, and clocks in which both planes' rows are sent."""
        self.columns += or_zero(out["left_valid_o"])
        self.overlaps += or_zero(out["left_valid_o"]) & or_zero(out["right_valid_o"])


@cocotb.test()
async def every_clock(dut) -> None:
    passes = _Passes(random.Random(cocotb.RANDOM_SEED))
    await check_cycles(dut, DenseFeedModel(passes.build), passes.stimulus(), passes.watch)
    assert passes.columns > 3000 and passes.overlaps > 500


def test_feed() -> None:
    """On the words of the board; `test_block` has the small ones of the board tiny."""
    build = build_of(DENSE, 0)
    simulate("slog_dense_feed", __name__, {"Width": build.width, "WordsPerRow": build.words_per_row,
                                           "AddrW": build.addr_bits})
