# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_job_check`."""

from __future__ import annotations

from golden.correlate import Job, Status, check
from golden.cycle.model import Inputs, Values
from golden.params import SCORE_BITS, Config
from golden.structs import unpack_job

CHECK_LATENCY = 9
"""Clocks from start to done."""


class JobCheckModel:
    """Status by `golden.correlate.check`; undefined until the first job is done, and from a start to its done."""

    INPUTS = ("rst_i", "start_i", "job_i", "image_width_i", "image_height_i", "slot_valid_i")
    OUTPUTS = ("done_o", "status_o", "area_o")

    def __init__(self, config: Config) -> None:
        self.config = config
        self.left = 0
        self.answer: tuple[Status, int] | None = None
        self.job: Job | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        known = self.answer if self.left <= 1 else None
        out = {"done_o": int(self.left == 1), "status_o": None if known is None else int(known[0]),
               "area_o": None if known is None else known[1]}
        if self.left:
            self.left -= 1
        if i["start_i"]:
            job = unpack_job(i["job_i"])
            slots = [bool(i["slot_valid_i"] >> s & 1) for s in range(8)]
            self.left = CHECK_LATENCY
            self.answer = (check(job, self.config, (i["image_width_i"], i["image_height_i"]), slots),
                           job.width * job.height % (1 << SCORE_BITS))
        if i["rst_i"]:
            if self.left:
                self.answer = None
            self.left = 0
        return out
