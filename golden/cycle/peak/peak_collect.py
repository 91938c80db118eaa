# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_collect`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values
from golden.cycle.peak.structs import OUTCOME, VERDICT, or_no_score
from golden.params import SCORE_BITS


class PeakCollectModel:
    """The neighbours of a job's best, and its verdict three clocks after the scan of its last row."""

    INPUTS = ("rst_i", "near_first_i", "near_end_i", "near_west_i", "near_centre_i", "near_east_i",
              "near_above_i", "near_middle_i", "near_below_i", "far_valid_i", "far_i", "outcome_i")
    OUTPUTS = ("around_valid_o", "around_o", "verdict_valid_o", "verdict_o")
    COLUMNS = (("near_west_i", (0, 3, 5)), ("near_centre_i", (1, None, 6)), ("near_east_i", (2, 4, 7)))
    """Per column flag the neighbours it fills, above, middle and below."""

    def __init__(self) -> None:
        self.around = [0] * 8
        self.ended = 0
        self.runner_up = 0
        self.verdicts: deque[int | None] = deque([None] * 3)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        verdict = self.verdicts.popleft()
        around = sum(or_no_score(v) << k * SCORE_BITS for k, v in enumerate(self.around))
        out: Values = {"around_valid_o": self.ended, "around_o": around if self.ended else None,
                        "verdict_valid_o": int(verdict is not None), "verdict_o": verdict}
        self.ended = i["near_end_i"]
        if i["near_first_i"]:
            self.around = [0] * 8
        for flag, places in self.COLUMNS:
            for place, row in zip(places, ("near_above_i", "near_middle_i", "near_below_i"), strict=True):
                if i[flag] and place is not None:
                    self.around[place] = i[row]
        done = None
        if i["far_valid_i"]:
            o = OUTCOME.unpack(i["outcome_i"])
            self.runner_up = max(o["other"], i["far_i"] if o["fresh"] else self.runner_up)
            if o["last"]:
                done = VERDICT.pack({**o, "score": or_no_score(o["score"]), "runner_up": or_no_score(self.runner_up)})
        self.verdicts.append(done)
        if i["rst_i"]:
            self.ended, self.verdicts = 0, deque([None] * 3)
        return out
