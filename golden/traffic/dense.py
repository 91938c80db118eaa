# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the dense engine for its tests: planes that are sent row by row, and maps of what comes out.

`DenseTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL together.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

import numpy as np

from golden.correlate import Plane
from golden.cycle.dense.engine import flush_clocks, pixel_latency
from golden.cycle.dense.structs import BACK, NO_SUM, WINNER
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.dense import ABSENT, DenseMap, DensePass

IDLE: Inputs = dict.fromkeys(("rst_i", "flush_i", "left_valid_i", "first_i", "left_incoming_i", "left_leaving_i",
                              "left_ok_i", "right_valid_i", "right_incoming_i", "right_leaving_i", "right_ok_i"), 0)


@dataclass
class DenseTraffic:
    """One pass after another through an engine.

    Attributes:
        passes: left and right plane, uint8 (H, W), and what is searched for.
        rng: for the pauses between rows, and for what the ports carry outside rows.
        offsets, lanes, max_window: of the engine.
        cut: number of the pass that a reset ends in its middle; it is sent again.
    """

    passes: list[tuple[Plane, Plane, DensePass]]
    rng: random.Random
    offsets: int
    lanes: int
    max_window: int
    cut: int = -1
    winners: list[dict[str, int]] = field(default_factory=list)
    backs: list[dict[str, int]] = field(default_factory=list)
    maps: list[DenseMap] = field(default_factory=list)
    clocks: int = 0

    def stimulus(self) -> Stimulus:
        """Every pass, each after a flush, and the time until its last result."""
        for number, (left, right, one) in enumerate(self.passes):
            settings = {"shrink_i": (self.max_window // one.window).bit_length() - 1, "offsets_i": one.offsets}
            if number == self.cut:
                yield from self._pass(left[:len(left) // 2], right[:len(left) // 2], one, settings)
                yield {**IDLE, **settings, "rst_i": 1, "flush_i": 1}
            self.winners.clear()
            self.backs.clear()
            yield from self._pass(left, right, one, settings)
            for _ in range(pixel_latency(self.offsets) + self.offsets + self.rng.randint(0, 3)):
                yield {**self._noise(), **settings}
            self.maps.append(self._map(left.shape, one))

    def observe(self, i: Inputs, out: Outputs) -> None:
        """Take the outputs of a clock."""
        self.clocks += 1
        if out["winner_valid_o"] and not i["flush_i"]:
            self.winners.append(WINNER.unpack(out["winner_o"]))
        if out["back_valid_o"] and not i["flush_i"]:
            self.backs.append(BACK.unpack(out["back_o"]))

    def _noise(self) -> Inputs:
        """A clock between rows: ports that carry bits of a pixel hold anything."""
        noise = {name: self.rng.getrandbits(1) for name in IDLE if name.endswith("ing_i") or name == "first_i"}
        return {**IDLE, **noise, **{f"{side}_ok_i": self.rng.getrandbits(2) for side in ("left", "right")}}

    def _pass(self, left: Plane, right: Plane, one: DensePass, settings: Inputs) -> Stimulus:
        for _ in range(flush_clocks(self.offsets, self.max_window) + self.rng.randint(0, 4)):
            yield {**self._noise(), **settings, "flush_i": 1}
        (height, width), first = left.shape, self._first(one)
        sent: dict[int, Inputs] = {}
        # The flush lasts a clock longer inside.
        begin = 1 + max(0, -one.start - first) + self.rng.randint(0, 2)
        for y in range(height):
            for x in range(width):
                sent.setdefault(begin + x, {}).update(self._left(left, one, x, y))
            for x in range(first, width - max(one.start, 0)):
                sent.setdefault(begin + one.start + x, {}).update(self._right(right, one, x, y))
            # The memory of the row above needs a pause, and a row's right winners must be out before the next one's.
            pause = max(2 * self.lanes + 1, self.offsets - width)
            begin += width + pause + self.rng.choice((0, 0, 1, 7))
        for clock in range(max(sent) + 1):
            yield {**self._noise(), **settings, **sent.get(clock, {})}

    def _first(self, one: DensePass) -> int:
        """The first column of the right plane that a window of the left one meets."""
        return max(0, -one.start - self.offsets + 1)

    @staticmethod
    def _bit(plane: Plane, x: int, y: int) -> int:
        """A pixel, 0 above and below the plane."""
        return int(plane[y, x]) if 0 <= y < len(plane) else 0

    def _left(self, plane: Plane, one: DensePass, x: int, y: int) -> Inputs:
        ok = min(x, y) >= one.window - 1
        return {"left_valid_i": 1, "first_i": int(y == 0), "left_incoming_i": self._bit(plane, x, y),
                "left_leaving_i": self._bit(plane, x, y - one.window), "left_ok_i": ok << y % 2}

    def _right(self, plane: Plane, one: DensePass, x: int, y: int) -> Inputs:
        row = y - one.down
        leaving = self._bit(plane, x, row - one.window) if y >= one.window else 0
        ok = min(x, row) >= one.window - 1 and row < len(plane)
        return {"right_valid_i": 1, "right_incoming_i": self._bit(plane, x, row), "right_leaving_i": leaving,
                "right_ok_i": ok << y % 2}

    def _map(self, shape: tuple[int, int], one: DensePass) -> DenseMap:
        """What came out, as a map."""
        height, width = shape
        names = "index", "best", "lower", "upper", "rest"
        fields = {name: np.array([w[name] for w in self.winners]).reshape(shape).astype(np.int16) for name in names}
        found = fields["best"] != NO_SUM
        seen = slice(self._first(one), min(width, width - one.start))
        theirs = np.full(shape, ABSENT, np.int16)
        theirs[:, seen] = np.array([b["index"] for b in self.backs]).reshape(height, -1)
        back = np.full(shape, ABSENT, np.int16)
        y, x = np.nonzero(found)
        back[y, x] = theirs[y, x - one.start - fields["index"][y, x]]
        for name in names[1:]:
            fields[name][fields[name] == NO_SUM] = ABSENT
        fields["index"][~found] = ABSENT
        return DenseMap(**fields, back=back)
