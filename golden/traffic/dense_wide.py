# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the wide dense engine for its tests: planes sent word by word, and maps of what comes out.

`WideTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL together.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from golden.correlate import Plane
from golden.cycle.dense.wide import COLUMNS, WIDE_WINNER, DenseWideModel, wide_flush_clocks, wide_latency
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.dense import ABSENT, Counts, DensePass

Pair = tuple[Plane, Plane, DensePass]
"""Left and right plane, uint8 (H, W), and what is searched for."""


Kind = Literal["full", "lean", "opposite"]
"""Planes that resemble each other somewhere among the offsets; the same, nearly empty, so that many offsets are equal;
planes that differ nearly everywhere, and everywhere but at the left."""
KINDS: tuple[Kind, ...] = "full", "lean", "opposite"


def random_pair(rng: random.Random, offsets: int, window: int, max_width: int, kind: Kind) -> Pair:
    """Two planes and a search.

    Args:
        rng: of everything.
        offsets, window: of the engine.
        max_width: most columns.
        kind: how the planes differ.
    """
    one = DensePass(window, offsets, rng.choice((0, 1 - offsets, -offsets // 2, rng.randint(-9, 9), 4)),
                    rng.choice((0, 0, -2, 3)))
    shape = rng.randint(window + 4, window + 9), rng.randint(max(window, 4 * COLUMNS), max_width)
    dice = np.random.default_rng(rng.getrandbits(32))
    if kind == "opposite":
        right = (dice.random(shape) < 0.1).astype(np.uint8)
        right[:, shape[1] // 3:] = 0
        return np.ones(shape, np.uint8), right, one
    left = (dice.random(shape) < (0.03 if kind == "lean" else 0.5)).astype(np.uint8)
    right = np.roll(left, (-one.down, -one.start - rng.randrange(offsets)), (0, 1))
    return left, right ^ (dice.random(shape) < rng.choice((0.0, 0.1))).astype(np.uint8), one


@dataclass
class WideTraffic:
    """One pass after another through an engine.

    Attributes:
        passes: what is sent; every search is for all offsets of the engine, with its window.
        rng: for the pauses between rows, and for what the ports carry outside rows.
        offsets, window: of the engine.
        cut: number of the pass that a reset ends in its middle; it is sent again.
        maps: of each pass the best offset's number and its mismatches, int16 (H, W), ABSENT where there is none.
    """

    passes: list[Pair]
    rng: random.Random
    offsets: int
    window: int
    cut: int = -1
    words: list[int] = field(default_factory=list)
    maps: list[tuple[Counts, Counts]] = field(default_factory=list)
    clocks: int = 0

    def stimulus(self) -> Stimulus:
        """Every pass, each after a flush, and the time until its last result."""
        for number, (left, right, one) in enumerate(self.passes):
            if number == self.cut:
                yield from self._pass(left[:len(left) // 2], right[:len(left) // 2], one)
                yield {**self._noise(), "rst_i": 1, "flush_i": 1}
            self.words.clear()
            yield from self._pass(left, right, one)
            for _ in range(wide_latency(self.offsets) + self.rng.randint(0, 3)):
                yield self._noise()
            self.maps.append(self._map(left.shape))

    def observe(self, i: Inputs, out: Outputs) -> None:
        """Take the outputs of a clock."""
        self.clocks += 1
        if out["winner_valid_o"] and not i["flush_i"]:
            self.words.append(out["winner_o"])

    def _noise(self) -> Inputs:
        """A clock between rows: ports that carry a word's bits hold anything."""
        noise = {name: self.rng.getrandbits(COLUMNS) for name in DenseWideModel.INPUTS
                 if name.endswith(("ing_i", "ok_i"))}
        return {**dict.fromkeys(DenseWideModel.INPUTS, 0), **noise,
                **{name: self.rng.getrandbits(1) for name in ("first_i", "left_odd_i", "right_odd_i")}}

    def _pass(self, left: Plane, right: Plane, one: DensePass) -> Stimulus:
        for _ in range(wide_flush_clocks(self.offsets, self.window) + self.rng.randint(0, 4)):
            yield {**self._noise(), "flush_i": 1}
        height, width = left.shape
        words = -(-width // COLUMNS)
        first = max(0, -one.start - self.offsets + 1)  # column of the right plane that a window of the left one meets
        sent: dict[int, Inputs] = {}
        # The flush lasts a clock longer inside.
        begin = 1 + -min(0, (one.start + first) // COLUMNS) + self.rng.randint(0, 2)
        for y in range(height):
            for x in range(width):
                self._send(sent, begin, x, "left", self._column(left, one, x, y, y) | {"first": int(y == 0)}, y)
            for x in range(first, width - max(one.start, 0)):
                self._send(sent, begin, x + one.start, "right", self._column(right, one, x, y - one.down, y), y)
            pause = max(1, (self.offsets // COLUMNS - words) // 2 + 1)
            begin += words + pause + self.rng.choice((0, 0, 1, 7))
        for clock in range(max(sent) + 1):
            yield {**self._noise(), **sent.get(clock, {})}

    @staticmethod
    def _send(sent: dict[int, Inputs], begin: int, place: int, side: str, column: dict[str, int], y: int) -> None:
        """Put a column into its word: it is `place` columns after the left row's first."""
        clock, j = divmod(place, COLUMNS)
        word = sent.setdefault(begin + clock, {})
        if f"{side}_valid_i" not in word:
            word |= {f"{side}_valid_i": 1, f"{side}_odd_i": y % 2,
                     **{f"{side}_{name}_i": 0 for name in ("incoming", "leaving", "ok")}}
        for name in ("incoming", "leaving", "ok"):
            word[f"{side}_{name}_i"] |= column[name] << j
        if "first" in column:
            word["first_i"] = column["first"]

    def _column(self, plane: Plane, one: DensePass, x: int, row: int, y: int) -> dict[str, int]:
        """What is sent of a plane's column where the left row is `y` and the plane's own `row`."""
        leaving = row - one.window
        return {"incoming": int(plane[row, x]) if 0 <= row < len(plane) else 0,
                "leaving": int(plane[leaving, x]) if y >= one.window and 0 <= leaving < len(plane) else 0,
                "ok": int(min(x, row) >= one.window - 1 and row < len(plane))}

    def _map(self, shape: tuple[int, int]) -> tuple[Counts, Counts]:
        """What came out, as maps."""
        height, width = shape
        mask = (1 << WIDE_WINNER.bits) - 1
        found = [WIDE_WINNER.unpack(word >> j * WIDE_WINNER.bits & mask) for word in self.words for j in range(COLUMNS)]
        absent, index, best = (np.array([each[name] for each in found]).reshape(height, -1)[:, :width].astype(np.int16)
                               for name in ("absent", "index", "sum"))
        index[absent == 1], best[absent == 1] = ABSENT, ABSENT
        return index, best
