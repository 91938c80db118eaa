# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_room`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class DenseRoomModel:
    """Places for words that are neither reserved nor taken."""

    INPUTS = ("rst_i", "words_i", "reserve_i", "taken_i")
    OUTPUTS = ("room_o", "empty_o")

    def __init__(self, depth: int) -> None:
        self.depth = self.free = depth
        self.taken = 0
        """Whether a word was taken in the clock before."""
        self.out: Values = {"room_o": None, "empty_o": None}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        self.out = {"room_o": int(self.free >= i["words_i"]),
                    "empty_o": int(self.free == self.depth and not i["reserve_i"])}
        self.free += self.taken - i["reserve_i"] * i["words_i"]
        self.taken = i["taken_i"]
        if i["rst_i"]:
            self.free, self.taken = self.depth, 0
        return out
