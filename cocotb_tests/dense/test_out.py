# SPDX-License-Identifier: Apache-2.0
"""`slog_dense_out` against its cycle model on every clock."""

import random

import cocotb

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.dense.out import DenseOutModel
from golden.cycle.dense.structs import CHECKED, NO_SUM
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.traffic.stalls import SHAPES, ready_pattern
from sim.testbench.runner import simulate

MAPS = 24
DEPTH = 32
LARGEST = 32 * 32  # sum of a window of which every bit differs


def _pixel(rng: random.Random, most: int, margin: int) -> int:
    """A pixel near the limits of what is valid, or anything."""
    best = max(0, min(NO_SUM, most + rng.randint(-2, 2)))
    rest = rng.choice((NO_SUM, min(NO_SUM, best + max(0, margin + rng.randint(-2, 2))), best))
    pixel = {name: rng.getrandbits(bits) for name, bits in CHECKED.fields}
    return CHECKED.pack({**pixel, "found": rng.random() < 0.9, "best": best, "rest": max(best, rest)})


class _Maps:
    """Maps of small images, each after a clear; rows wait for room. Some maps end with a tail, one with a reset."""

    def __init__(self, rng: random.Random) -> None:
        self.rng, self.held = rng, 0
        self.sink = ready_pattern("none", rng)
        self.fixed: Inputs = {}

    def stimulus(self) -> Stimulus:
        """Every map."""
        for number in range(MAPS):
            self.sink = ready_pattern(SHAPES[number % len(SHAPES)], self.rng)
            height, early, cut = self.rng.randint(1, 12), number % 5 == 4, number == MAPS // 2
            if number < 2:  # as many words as there are
                height = 12
            self._choose(height, **({"image_width_i": 20, "step_x_i": 1, "step_y_i": 1} if number < 2 else {}))
            for left in reversed(range(self.rng.randint(1, 4))):
                yield from self._clock(clear_i=1, valid_i=self.rng.getrandbits(1) if left else 0)
            yield from self._rows(self.rng.randrange(height) if early or cut else height)
            if cut:  # before the last pixel of a row
                yield from self._drain()
                for _ in range(self.fixed["image_width_i"] - 1):
                    yield from self._clock(
                        valid_i=1, pixel_i=_pixel(self.rng, self.fixed["most_i"], self.fixed["margin_i"]))
                yield from self._clock(rst_i=1)
                self.held = 0
            elif early:
                yield from self._drain()
                self.held = 1
                yield from self._clock(tail_i=1)
            yield from self._drain()

    def _choose(self, height: int, **chosen: int) -> None:
        """What is constant in a map."""
        rng = self.rng
        steps = [rng.choice((1, 1, 2, 3, rng.randint(1, 20), 255)) for _ in range(2)]
        self.fixed = {"image_width_i": rng.randint(2, 20), "image_height_i": height, "step_x_i": steps[0],
                      "step_y_i": steps[1], "most_i": rng.choice((NO_SUM, rng.randint(0, 100), 0)),
                      "margin_i": rng.choice((0, rng.randint(0, 100), LARGEST, NO_SUM)), "check_i": rng.getrandbits(1),
                      **chosen}

    def _clock(self, **values: int) -> Stimulus:
        noise = self.rng.getrandbits(CHECKED.bits)
        out = yield {**self.fixed, "pixel_i": noise, "map_tready_i": next(self.sink), **values}
        self.held -= out["taken_o"] or 0

    def _rows(self, rows: int) -> Stimulus:
        fixed = self.fixed
        for y in range(rows):
            words = -(-fixed["image_width_i"] // fixed["step_x_i"]) if y % fixed["step_y_i"] == 0 else 0
            while self.held + words > DEPTH:
                yield from self._clock()
            self.held += words
            for _ in range(fixed["image_width_i"]):
                while self.rng.random() < 0.05:
                    yield from self._clock()
                yield from self._clock(valid_i=1, pixel_i=_pixel(self.rng, fixed["most_i"], fixed["margin_i"]))
            for _ in range(self.rng.choice((2, 3, 9))):
                yield from self._clock()

    def _drain(self) -> Stimulus:
        while self.held:
            yield from self._clock()


@cocotb.test()
async def every_clock(dut) -> None:
    seen = {"words": 0, "valid": 0, "last": 0}

    def watch(i: Inputs, out: Outputs) -> None:
        if out["map_tvalid_o"] and i["map_tready_i"]:
            seen["words"] += 1
            seen["valid"] += out["map_tdata_o"] >> 54
            seen["last"] += out["map_tlast_o"]

    maps = _Maps(random.Random(cocotb.RANDOM_SEED))
    await check_cycles(dut, DenseOutModel(params()["Depth"]), maps.stimulus(), watch)
    assert seen["last"] >= MAPS - 2 and seen["words"] > 10 * MAPS
    assert seen["words"] // 8 < seen["valid"] < seen["words"]


def test_out() -> None:
    simulate("slog_dense_out", __name__, {"Depth": DEPTH})
