# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_lanes`."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import pack
from golden.cycle.dense.structs import LEFT, NO_SUM, RIGHT, SUM_BITS
from golden.cycle.model import Inputs, Values

PLANES_BITS = 4


class DenseLanesModel:
    """Running sums of the lanes. A sum is undefined until delta has been cleared with known bits behind it.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("clear_i", "left_i", "right_i", "left_ok_i", "right_ok_i", "used_i", "above_i")
    OUTPUTS = ("sum_o", "score_o", "left_o", "right_o", "left_ok_o", "right_ok_o")

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        # Tokens of the clocks before, the newest first: (bits, ok) of each plane.
        self.left: deque[tuple[int | None, int | None]] = deque([(None, None)] * 2 * lanes)
        self.right: deque[tuple[int | None, int | None]] = deque([(None, None)] * 3 * lanes)
        self.steps: deque[list[int | None]] = deque([[None] * lanes] * 2)
        self.delta: list[int | None] = [None] * lanes
        self.sums: list[int | None] = [None] * lanes
        self.scores: list[int | None] = [None] * lanes

    @property
    def out(self) -> Values:
        return {"sum_o": pack(self.sums, SUM_BITS), "score_o": pack(self.scores, SUM_BITS),
                "left_o": self.left[-1][0], "right_o": self.right[-1][0],
                "left_ok_o": self.left[-1][1], "right_ok_o": self.right[-1][1]}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        self.left.appendleft((i["left_i"], i["left_ok_i"]))
        self.right.appendleft((i["right_i"], i["right_ok_i"]))
        arrived: list[int | None] = []
        for k in range(self.lanes):
            (left, left_ok), (right, right_ok) = self.left[2 * k], self.right[3 * k]
            arrived.append(_change(left, right))
            used = i["used_i"] >> k & 1
            if not used or left_ok == 0 or right_ok == 0:
                self.scores[k] = NO_SUM
            elif left_ok is None or right_ok is None:
                self.scores[k] = None
            else:
                self.scores[k] = self.sums[k] if left_ok & right_ok else NO_SUM
            above, delta = i["above_i"] >> k * SUM_BITS & NO_SUM, self.delta[k]
            self.sums[k] = None if delta is None else above + delta & NO_SUM
            change = self.steps[-1][k]
            self.delta[k] = 0 if i["clear_i"] else None if change is None or delta is None else delta + change
        self.left.pop()
        self.right.pop()
        self.steps.appendleft(arrived)
        self.steps.pop()
        return out


def _change(left: int | None, right: int | None) -> int | None:
    """e of two tokens: what comes in less what leaves, and what both were a window's width ago."""
    if left is None or right is None:
        return None
    x = (LEFT.unpack(left)["bits"]) ^ (RIGHT.unpack(right)["bits"])
    incoming, leaving, incoming_ago, leaving_ago = (x >> bit & 1 for bit in range(PLANES_BITS - 1, -1, -1))
    return incoming - leaving - incoming_ago + leaving_ago
