# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_intake`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values
from golden.cycle.peak.structs import SCORING


class PeakIntakeModel:
    """Scores with their positions, two clocks after the mismatch is taken."""

    INPUTS = ("rst_i", "row_coming_i", "row_refused_i", "row_last_x_i", "row_first_i", "row_last_i", "scoring_i",
              "released_i", "mismatch_valid_i", "mismatch_i", "surf_ok_i")
    OUTPUTS = ("row_taken_o", "mismatch_ready_o", "score_valid_o", "score_first_o", "score_last_o", "score_x_o",
               "score_o", "bank_o", "surf_valid_o", "surf_first_o", "surf_last_o")
    SCORE = OUTPUTS[3:7]

    def __init__(self, banks: int) -> None:
        self.banks = banks
        self.clear()

    def clear(self) -> None:
        """No row in work; the next one goes into bank 0."""
        self.row: Inputs | None = None
        self.x, self.bank, self.used, self.open, self.surf_ok = 0, self.banks - 1, 0, 0, 0
        self.flying: deque[Values | None] = deque([None, None])

    @property
    def ready_pattern(self) -> bool:
        """A score can be taken in this clock."""
        return self.row is not None and bool(self.surf_ok or not SCORING.unpack(self.row["scoring_i"])["surface"])

    @property
    def ends(self) -> bool:
        """The next score is the last of its row."""
        return self.row is not None and self.x == self.row["row_last_x_i"]

    def takes(self, mismatch_valid: int) -> bool:
        """A row is taken in this clock."""
        return bool(self.open and (self.row is None or (mismatch_valid and self.ready_pattern and self.ends)))

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        row, now, ready_pattern, ends = self.row, self.flying[0], self.ready_pattern, self.ends
        take = self.takes(i["mismatch_valid_i"])
        out: Values = {"row_taken_o": int(take), "mismatch_ready_o": int(ready_pattern),
                        "score_valid_o": int(now is not None), "bank_o": 0, "surf_valid_o": 0,
                        **dict.fromkeys((*self.SCORE, "surf_first_o", "surf_last_o")), **(now or {})}
        if i["rst_i"]:
            self.clear()
            return out
        scored: Values | None = None
        if ready_pattern and i["mismatch_valid_i"] and row is not None:
            begins, scoring = self.x == 0, SCORING.unpack(row["scoring_i"])
            surface = scoring["surface"]
            scored = {"score_first_o": int(begins), "score_last_o": int(ends), "score_x_o": self.x,
                      "score_o": scoring["area"] - i["mismatch_i"], "bank_o": 1 << self.bank, "surf_valid_o": surface,
                      "surf_first_o": int(begins and row["row_first_i"]) if surface else None,
                      "surf_last_o": int(ends and row["row_last_i"]) if surface else None}
            self.x += 1
            if ends:
                self.row = None
        self.flying.popleft()
        self.flying.append(scored)
        self.open = int(i["row_coming_i"] and not take and (self.used < self.banks or i["released_i"] > 0))
        self.surf_ok = i["surf_ok_i"]
        self.used += take - i["released_i"]
        if take:
            self.bank = (self.bank + 1) % self.banks
            if not i["row_refused_i"]:
                self.row, self.x = dict(i), 0
        return out
