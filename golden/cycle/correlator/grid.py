# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_grid`: the frame-level `grid`, one job at a time."""

from __future__ import annotations

from collections import deque

from golden.correlate import Job, grid
from golden.cycle.model import Inputs, Values
from golden.structs import pack_job, unpack_job


class GridModel:
    """Offers the jobs of a command one by one, with an idle clock between any two; a count of 0 acts as 1.

    A job is offered only if `job_ready_i` was set in the clock before. `job_o` is undefined while not valid.
    """

    INPUTS = ("rst_i", "job_valid_i", "job_i", "count_x_i", "count_y_i", "step_x_i", "step_y_i", "job_ready_i")
    OUTPUTS = ("job_ready_o", "job_valid_o", "job_o")

    def __init__(self) -> None:
        self.jobs: deque[Job] = deque()
        self.between = self.room = False  # the idle clock; job_ready_i in the clock before

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        jobs = self.jobs
        valid = bool(jobs) and not self.between and self.room
        out: Values = {"job_ready_o": int(not jobs), "job_valid_o": int(valid),
                                      "job_o": pack_job(jobs[0]) if valid else None}
        self.between, self.room = False, bool(i["job_ready_i"])
        if i["rst_i"]:
            jobs.clear()
        elif jobs:
            if valid:
                jobs.popleft()
                self.between = bool(jobs)
        elif i["job_valid_i"]:
            count = max(i["count_x_i"], 1), max(i["count_y_i"], 1)
            jobs.extend(grid(unpack_job(i["job_i"]), count, (i["step_x_i"], i["step_y_i"])))
        return out
