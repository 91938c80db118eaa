# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_array`."""

from __future__ import annotations

from golden.cycle.array.timing import core_latency, score_bits
from golden.cycle.model import Inputs, Values


class ArrayModel:
    """Counts the mismatches of each lane as the operands arrive and schedules the scores of the pass.

    The whole array is frozen while `move_i` is low. After a reset `mismatch_o` is undefined until the data path has
    drained, except when a score is due; the score of a pass whose first step was lost to a reset is undefined.
    """

    INPUTS = ("rst_i", "move_i", "mask_i", "valid_i", "first_i", "last_i", "lanes_i", "tpl_a_i", "tpl_b_i",
              "search_a_i", "search_b_i")
    OUTPUTS = ("mismatch_valid_o", "mismatch_o")

    def __init__(self, group_bits: int, lanes: int) -> None:
        self.group_bits, self.lanes = group_bits, lanes
        self.latency = core_latency(group_bits)
        self.flush = score_bits(group_bits) + 4
        self.now = 0  # enabled clocks
        self.clean = self.flush  # time from which idle outputs are defined
        self.due: dict[int, int | None] = {}  # time -> mismatch
        self.counts: list[int | None] = [None] * lanes

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge.

        Raises:
            ValueError: if two scores are due at once.
        """
        valid = self.now in self.due
        out: Values = {
            "mismatch_valid_o": int(valid),
            "mismatch_o": self.due.get(self.now, 0 if self.now >= self.clean else None)}
        if i["rst_i"]:
            self.due.clear()
            self.counts = [None] * self.lanes
            self.clean = self.now + 1 + self.flush
        elif i["move_i"] and i["valid_i"]:
            self._count(i)
        if i["move_i"] or i["rst_i"]:
            self.due.pop(self.now, None)
            self.now += 1
        return out

    def _count(self, i: Inputs) -> None:
        g = self.group_bits
        bits = (1 << g) - 1
        mask_a, mask_b = i["mask_i"] & bits, i["mask_i"] >> g
        for k in range(self.lanes):
            count = (((i["tpl_a_i"] ^ i["search_a_i"] >> k) & mask_a).bit_count()
                     + ((i["tpl_b_i"] ^ i["search_b_i"] >> k) & mask_b).bit_count())
            before = 0 if i["first_i"] else self.counts[k]
            self.counts[k] = None if before is None else before + count
        if i["last_i"]:
            for k in range(i["lanes_i"]):
                time = self.now + self.latency + k
                if time in self.due:
                    raise ValueError("passes end too close together")
                self.due[time] = self.counts[k]
