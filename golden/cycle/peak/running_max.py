# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_running_max`."""

from __future__ import annotations

from collections import deque

from golden.cycle.model import Inputs, Values

MAX_LATENCY = 3
"""Clocks from the last sample of a row to its maximum."""


class RunningMaxModel:
    """Largest value of each row and its first index; undefined while not valid."""

    INPUTS = ("rst_i", "in_valid_i", "in_first_i", "in_last_i", "in_value_i", "in_index_i")
    OUTPUTS = ("out_valid_o", "out_value_o", "out_index_o")

    def __init__(self) -> None:
        self.row: list[tuple[int, int]] = []
        self.due: deque[tuple[int, int] | None] = deque([None] * MAX_LATENCY)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        now = self.due.popleft()
        done = None
        if i["in_valid_i"]:
            if i["in_first_i"]:
                self.row = []
            self.row.append((i["in_value_i"], i["in_index_i"]))
            if i["in_last_i"]:
                done = max(self.row, key=lambda sample: (sample[0], -sample[1]))
        self.due.append(done)
        if i["rst_i"]:
            self.due = deque([None] * MAX_LATENCY)
        return {"out_valid_o": int(now is not None), "out_value_o": now[0] if now else None,
                "out_index_o": now[1] if now else None}
