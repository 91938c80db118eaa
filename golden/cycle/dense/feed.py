# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_feed`."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import or_zero, signed
from golden.cycle.dense.plan import DenseBuild
from golden.cycle.dense.stream import DenseStreamModel
from golden.cycle.dense.structs import PLAN, ROW
from golden.cycle.model import Inputs, Values
from golden.cycle.store.store import STORE_LATENCY

START = 6
"""Clocks from `row_i` to the start of a row that has no delay."""
NAMES = {"left": ("left_valid_o", "first_o", "left_incoming_o", "left_leaving_o", "left_ok_o"),
         "right": ("right_valid_o", "", "right_incoming_o", "right_leaving_o", "right_ok_o")}
SENT = ("valid_o", "first_o", "incoming_o", "leaving_o", "ok_o")


class DenseFeedModel:
    """Rows of both planes, and the reads of the store that they need.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "begin_i", "row_i", "plan_i", "down_i", "width_i", "height_i", "rd_data_i")
    OUTPUTS = ("rd_valid_o", "rd_addr_o", *NAMES["left"], *filter(None, NAMES["right"]), "busy_o")

    def __init__(self, build: DenseBuild) -> None:
        self.build = build
        self.planes = [DenseStreamModel(build.width, build.addr_bits) for _ in NAMES]
        self.data = [0, 0]
        """Answers of the store, one and two clocks ago."""
        self.row = -1
        self._stop()

    def _stop(self) -> None:
        self.waits: list[int | None] = [None, None]
        """Clocks to the start of each plane's row."""
        self.turn = 0
        self.read: int | None = None
        self.asked: deque[int] = deque([0] * (STORE_LATENCY + 3))
        """Which of the four rows each word on its way is for, one bit each, the newest first."""

    @property
    def out(self) -> Values:
        sent = [plane.out for plane in self.planes]
        out: Values = {"rd_valid_o": int(bool(self.asked[0])), "rd_addr_o": self.read if self.asked[0] else None,
                       "busy_o": int(any(values["busy_o"] for values in sent))}
        for names, values in zip(NAMES.values(), sent, strict=True):
            out |= {name: values[port] for name, port in zip(names, SENT, strict=True) if name}
        return out

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        came, self.read, asked = self.asked[-1], None, 0
        for n, plane in enumerate(self.planes):
            wishes = plane.out
            grant = or_zero(wishes["want_o"]) << 2 * n & 1 << self.turn
            if grant:
                self.read = or_zero(wishes["addr_o"]) >> (self.turn - 2 * n) * self.build.addr_bits
                self.read &= (1 << self.build.addr_bits) - 1
                asked = grant
            start = self.waits[n] == 0
            plane.step({"rst_i": i["rst_i"], "start_i": int(start), "mask_i": PLAN.unpack(i["plan_i"])["mask"],
                        "row_i": self._row(n, i) if self.waits[n] == 1 else 0, "grant_i": grant >> 2 * n,
                        "came_i": came >> 2 * n & 3, "data_i": self.data[1]})
        self.data = [i["rd_data_i"], self.data[0]]
        self.asked.pop()
        self.asked.appendleft(asked)
        self.turn = (self.turn + 1) % 4
        self._wait(i)
        if i["rst_i"]:
            self._stop()
        return out

    def _wait(self, i: Inputs) -> None:
        """A clock of the delays, and the beginnings of passes and rows."""
        self.waits = [wait - 1 if wait else None for wait in self.waits]
        if i["row_i"]:
            self.row += 1
            plan = PLAN.unpack(i["plan_i"])
            self.waits = [START - 1 + plan["left_delay"],
                          START - 1 + plan["right_delay"] if plan["meets"] else None]
        if i["begin_i"]:
            self.row = -1

    def _row(self, plane: int, i: Inputs) -> int:
        """What a plane's stream sends as the present row."""
        plan, height, lines = PLAN.unpack(i["plan_i"]), i["height_i"], self.build.words_per_row
        window, y = -plan["mask"] & 0x3FF, self.row
        r = y - (signed(i["down_i"], 10) if plane else 0)
        incoming = plan["right" if plane else "left"] + y * lines
        bits = (1 << self.build.addr_bits) - 1
        ok = window - 1 <= r < height
        return ROW.pack({"incoming": incoming & bits, "leaving": incoming - plan["above"] & bits,
                         "has_incoming": 0 <= r < height, "has_leaving": y >= window and 0 <= r - window < height,
                         "column": plan["column"] if plane else 0, "skip": plan["skip"] if plane else 0,
                         "count": plan["count"] if plane else i["width_i"], "ok": ok << y % 2,
                         "first": y == 0 and not plane})
