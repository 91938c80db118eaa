# SPDX-License-Identifier: Apache-2.0
"""Cycle models of `slog_dense_group` and `slog_dense_engine`."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import or_zero
from golden.cycle.dense.lanes import DenseLanesModel
from golden.cycle.dense.memory import DenseMemoryModel
from golden.cycle.dense.structs import LEFT, NO_BACK, NO_WINNER, RIGHT
from golden.cycle.dense.winner import DenseBackModel, DenseWinnerModel
from golden.cycle.model import Inputs, Values

OK_LAG, OUT_LAG = 4, 5
"""Clocks by which the ok bits and the winners follow the pixels."""


def flush_clocks(offsets: int, max_window: int) -> int:
    """Clocks of a flush before a pass."""
    return 3 * offsets + max_window + 8


def pixel_latency(offsets: int) -> int:
    """From a left pixel to its winner."""
    return 2 * offsets + 6


def back_latency(offsets: int) -> int:
    """From a right pixel to its own winner."""
    return 3 * offsets + 6


class DenseGroupModel:
    """A few offsets: sums, memory and winners wired together.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "clear_i", "base_i", "used_i", "left_i", "right_i", "left_ok_i", "right_ok_i", "winner_i",
              "back_i")
    OUTPUTS = ("left_o", "right_o", "left_ok_o", "right_ok_o", "winner_o", "back_o")

    def __init__(self, lanes: int) -> None:
        self.lanes, self.memory = DenseLanesModel(lanes), DenseMemoryModel()
        self.winner, self.back = DenseWinnerModel(lanes), DenseBackModel(lanes)

    @property
    def out(self) -> Values:
        known = {**self.lanes.out, **self.winner.out, **self.back.out}
        return {name: known[name] for name in self.OUTPUTS}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out, made = self.out, self.lanes.out
        coming, going = LEFT.unpack(i["left_i"]), LEFT.unpack(or_zero(made["left_o"]))
        above = self.memory.out["above_o"]
        run = (coming["in_row"] | going["in_row"]) & ~i["clear_i"]
        self.memory.step({"rst_i": i["rst_i"], "run_i": run,
                          "first_i": coming["in_row"] & coming["first"] | going["in_row"] & going["first"],
                          "sum_i": or_zero(made["sum_o"])})
        self.lanes.step({**{name: i[name] for name in DenseLanesModel.INPUTS if name in i}, "above_i": or_zero(above)})
        scores = {"base_i": i["base_i"], "score_i": or_zero(made["score_o"])}
        self.winner.step({**scores, "winner_i": i["winner_i"]})
        self.back.step({**scores, "back_i": i["back_i"]})
        return out


class DenseEngineModel:
    """Groups one behind the other. The winner is defined with its valid; what is in flight in a flush is dropped.
    """

    INPUTS = ("rst_i", "flush_i", "shrink_i", "offsets_i", "left_valid_i", "first_i", "left_incoming_i",
              "left_leaving_i", "left_ok_i", "right_valid_i", "right_incoming_i", "right_leaving_i", "right_ok_i")
    OUTPUTS = ("winner_valid_o", "winner_o", "back_valid_o", "back_o")

    def __init__(self, offsets: int, lanes: int, max_window: int) -> None:
        self.offsets, self.max_window = offsets, max_window
        self.groups = [DenseGroupModel(lanes) for _ in range(offsets // lanes)]
        self.lanes = lanes
        self.planes: deque[tuple[int, int]] = deque([(0, 0)] * (max_window + 1))
        """(left, right) bits of the columns before, the newest first: incoming, leaving."""
        self.marks = self.first = 0
        self.oks: deque[tuple[int, int]] = deque([(0, 0)] * (OK_LAG + 1))
        self.flushes: deque[int] = deque([0] * len(self.groups))
        self.valid: deque[tuple[int, int]] = deque([(0, 0)] * OUT_LAG)
        self.used = self.held = 0
        self.flush = self.shrink = 0
        """Of the clock before."""

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        valid, found = self.valid[-1], self.groups[-1].out
        out: Values = {"winner_valid_o": valid[0], "back_valid_o": valid[1],
                       "winner_o": found["winner_o"] if valid[0] else None,
                       "back_o": found["back_o"] if valid[1] else None}
        ends = LEFT.unpack(or_zero(found["left_o"]))["in_row"], RIGHT.unpack(or_zero(found["right_o"]))["in_row"]
        flushed = self.flushes[-1]
        self._move(i)
        self.valid.pop()
        self.valid.appendleft(ends)
        if i["rst_i"] or flushed:
            self.valid = deque([(0, 0)] * OUT_LAG)
        left, right = i["left_valid_i"], i["right_valid_i"]
        self.planes.pop()
        self.planes.appendleft((left * (2 * i["left_incoming_i"] + i["left_leaving_i"]),
                                right * (2 * i["right_incoming_i"] + i["right_leaving_i"])))
        self.oks.pop()
        self.oks.appendleft((left * i["left_ok_i"], right * i["right_ok_i"]))
        self.marks, self.first = (0 if i["rst_i"] else 2 * left + right), i["first_i"]
        self.flushes.pop()
        self.flushes.appendleft(self.flush | self.held)
        self.held &= 1 - self.flush
        self.flush, self.shrink = i["flush_i"], i["shrink_i"]
        if i["rst_i"]:
            self.flushes, self.held, self.flush = deque([1] * len(self.groups)), 1, 0
        self.used = (1 << min(i["offsets_i"], self.offsets)) - 1
        return out

    def _move(self, i: Inputs) -> None:
        """A clock of the groups."""
        ago = self.planes[self.max_window >> self.shrink]
        bits = [now << 2 | then for now, then in zip(self.planes[0], ago, strict=True)]  # as BITS has them
        coming: Values = {"left_o": LEFT.pack({"in_row": self.marks >> 1, "first": self.first, "bits": bits[0]}),
                          "right_o": RIGHT.pack({"in_row": self.marks & 1, "bits": bits[1]}),
                          "left_ok_o": self.oks[-1][0], "right_ok_o": self.oks[-1][1], "winner_o": NO_WINNER,
                          "back_o": NO_BACK}
        for g, (group, flush) in enumerate(zip(self.groups, self.flushes, strict=True)):
            handed = {f"{name[:-2]}_i": or_zero(value) for name, value in coming.items()}
            base = g * self.lanes
            coming = group.step({**handed, "rst_i": i["rst_i"], "clear_i": flush, "base_i": base,
                                 "used_i": self.used >> base & (1 << self.lanes) - 1})
