# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_job_plan`."""

from __future__ import annotations

from dataclasses import dataclass

from golden.correlate import Job, Status, check
from golden.cycle.model import Inputs, Values
from golden.params import Config
from golden.structs import LOAD, unpack_job


def plan_latency(config: Config) -> int:
    """Clocks from start to valid outputs."""
    return config.words_per_row.bit_length() + 5


@dataclass(frozen=True)
class Load:
    """A rectangle of bits in the store: `rows` rows of `bits` bits from column `x` of line `line` (over all slots)."""

    line: int
    x: int
    bits: int
    rows: int

    def packed(self, config: Config) -> int:
        """The rectangle as a packed `load_t`."""
        g = config.group_bits
        touched = range(self.x // g, (self.x + self.bits - 1) // g + 1)
        return LOAD.pack({"addr": self.line * config.words_per_row + touched[0], "shift": self.x % g,
                          "words_in": len(touched) - 1, "words_out": -(-self.bits // g) - 1, "rows": self.rows - 1})


def loads(job: Job, config: Config) -> tuple[Load, Load]:
    """Template and search rectangle of an acceptable job."""
    return (Load(job.tpl_slot * config.max_height + job.tpl_y, job.tpl_x, job.width, job.height),
            Load(job.search_slot * config.max_height + job.search_y, job.search_x,
                 job.width + job.offsets_x - 1, job.height + job.offsets_y - 1))


class JobPlanModel:
    """The loads of a job; undefined from a start until `plan_latency` clocks later, and for jobs no image can hold."""

    INPUTS = ("rst_i", "start_i", "job_i")
    OUTPUTS = ("tpl_o", "search_o")

    def __init__(self, config: Config) -> None:
        self.config = config
        self.left = 0
        self.answer: tuple[int, int] | None = None

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        c = self.config
        known = self.answer if self.left <= 1 and not i["start_i"] else None
        out: Values = {"tpl_o": None if known is None else known[0],
                                      "search_o": None if known is None else known[1]}
        if self.left > 1:
            self.left -= 1
        if i["start_i"]:
            job = unpack_job(i["job_i"])
            good = check(job, c, (c.max_width, c.max_height), [True] * 8) is Status.OK
            self.left = plan_latency(c)
            self.answer = None
            if good:
                template, search = loads(job, c)
                self.answer = template.packed(c), search.packed(c)
        if i["rst_i"] and self.left > 1:
            self.answer = None
        return out
