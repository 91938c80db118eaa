# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_room`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values


class PeakRoomModel:
    """Scores granted and not yet taken from the queue. A departure counts one clock late, two beside a grant."""

    INPUTS = ("rst_i", "row_valid_i", "row_offsets_i", "taken_i")
    OUTPUTS = ("row_ready_o",)

    def __init__(self, depth: int, max_offsets: int) -> None:
        self.limit = depth - max_offsets
        self.clear()

    def clear(self) -> None:
        """Nothing granted; no grant in the next clock."""
        self.held, self.late, self.ready = 0, 0, 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = self.ready
        if i["rst_i"]:
            self.clear()
        elif i["row_valid_i"] and ready:
            self.ready = 0
            self.held += i["row_offsets_i"]
            self.late += i["taken_i"]
        else:
            self.ready = int(self.held <= self.limit)
            self.held -= self.late
            self.late = i["taken_i"]
        return {"row_ready_o": ready}
