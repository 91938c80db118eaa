# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_rows`."""

from __future__ import annotations

from collections import deque

from golden.correlate import Status
from golden.cycle.model import Inputs, Values
from golden.cycle.peak.structs import SCORE_ROW, SCORING
from golden.structs import CONTEXT


class PeakRowsModel:
    """The rows of a job in order. A row remains at the output for one clock after it was taken."""

    INPUTS = ("rst_i", "ctx_valid_i", "ctx_i", "row_taken_i")
    OUTPUTS = ("ctx_ready_o", "row_coming_o", "row_o", "scoring_o")

    def __init__(self) -> None:
        self.rows: deque[int] = deque()
        self.scoring: int | None = None
        self.taken = 0
        """The front row was taken in the clock before."""

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rows = self.rows
        load = len(rows) == self.taken
        out: Values = {"ctx_ready_o": int(load), "row_o": rows[0] if rows else None,
                        "scoring_o": self.scoring if rows else None,
                        "row_coming_o": None if i["row_taken_i"] else int(not load or i["ctx_valid_i"])}
        if self.taken:
            rows.popleft()
        self.taken = i["row_taken_i"]
        if i["rst_i"]:
            rows.clear()
            self.taken = 0
        elif load and i["ctx_valid_i"]:
            c = CONTEXT.unpack(i["ctx_i"])
            count = c["offsets_y"] if c["status"] == Status.OK else 1
            rows.extend(SCORE_ROW.pack({"tag": c["tag"], "status": c["status"], "last_x": (c["offsets_x"] - 1) % 1024,
                                  "y": y, "first": y == 0, "last": y == count - 1}) for y in range(count))
            self.scoring = SCORING.pack({**c, "one": c["offsets_x"] == 1, "two": c["offsets_x"] == 2})
        return out
