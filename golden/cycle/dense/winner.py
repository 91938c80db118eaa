# SPDX-License-Identifier: Apache-2.0
"""Cycle models of `slog_dense_winner` and `slog_dense_back`."""

from __future__ import annotations

from collections import deque

from golden.cycle.dense.structs import BACK, NO_SUM, SUM_BITS, WINNER
from golden.cycle.model import Inputs, Values


def take(winner: int | None, score: int | None, index: int) -> int | None:
    """A packed `winner_t` after one offset more."""
    if winner is None or score is None:
        return None
    w = WINNER.unpack(winner)
    if score < w["best"]:
        found = {"fresh": 1, "index": index, "best": score, "lower": w["last"], "upper": NO_SUM, "rest": w["earlier"]}
    elif w["fresh"]:
        found = {**w, "fresh": 0, "upper": score}
    else:
        found = {**w, "rest": min(w["rest"], score)}
    return WINNER.pack({**found, "earlier": w["best"], "last": score})


def take_back(back: int | None, score: int | None, index: int) -> int | None:
    """A packed `back_t` after one offset more."""
    if back is None or score is None:
        return None
    return BACK.pack({"index": index, "best": score}) if score < BACK.unpack(back)["best"] else back


class _Chain:
    """Values that move from lane to lane and take each lane's score.

    Attributes:
        hop: clocks a lane.
        out: outputs of this clock, which do not depend on its inputs.
    """

    hop: int
    name: str

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        # Of each lane, the values on their way through it, the newest first.
        self.moving: list[deque[int | None]] = [deque([None] * self.hop) for _ in range(lanes)]

    @property
    def out(self) -> Values:
        return {f"{self.name}_o": self.moving[-1][-1]}

    def after(self, value: int | None, score: int | None, index: int) -> int | None:
        """What a lane hands on of what came to it."""
        raise NotImplementedError

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        coming: int | None = i[f"{self.name}_i"]
        for k, lane in enumerate(self.moving):
            leaving = lane.pop()
            lane.appendleft(self.after(coming, i["score_i"] >> k * SUM_BITS & NO_SUM, i["base_i"] + k))
            coming = leaving
        return out


class DenseWinnerModel(_Chain):
    """The best of the offsets at each left pixel."""

    INPUTS = ("base_i", "winner_i", "score_i")
    OUTPUTS = ("winner_o",)
    hop, name = 2, "winner"

    def after(self, value: int | None, score: int | None, index: int) -> int | None:
        """See `take`."""
        return take(value, score, index)


class DenseBackModel(_Chain):
    """The best of the offsets at each right pixel."""

    INPUTS = ("base_i", "back_i", "score_i")
    OUTPUTS = ("back_o",)
    hop, name = 3, "back"

    def after(self, value: int | None, score: int | None, index: int) -> int | None:
        """See `take_back`."""
        return take_back(value, score, index)
