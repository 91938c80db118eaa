# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_plan`."""

from __future__ import annotations

from dataclasses import dataclass

from golden.cycle.bits import signed
from golden.cycle.dense.structs import BAD_OFFSETS, BAD_SLOT, BAD_STEP, BAD_WINDOW, DENSE_JOB, OK, PLAN
from golden.cycle.model import Inputs, Values

SETTLE = 8
"""Clocks that every plan takes."""
OVERHEAD = 3
"""Clocks from the start to `done_o` besides those that the plan takes."""
HERE = 2
"""Clocks from the start of a live job to `here_i`."""


@dataclass(frozen=True)
class DenseBuild:
    """Parameters of `slog_dense`; lengths in pixels.

    Attributes:
        width: bits of a store word.
        max_width: longest row.
        max_height: rows of a slot.
        words_per_row: store words of a row.
        slots: of the store.
        offsets, lanes: of the engine.
        max_window, sizes: its largest window, and how many there are, each half the one before.
        out_depth: words of the output queue.
    """

    width: int
    max_width: int
    max_height: int
    words_per_row: int
    slots: int
    offsets: int
    lanes: int
    max_window: int
    sizes: int
    out_depth: int

    @property
    def addr_bits(self) -> int:
        """Bits of a store word's address."""
        return (self.slots * self.max_height * self.words_per_row - 1).bit_length()


def unpack_job(word: int) -> dict[str, int]:
    """Fields of a `dense_job_t`, signed where they are."""
    job = DENSE_JOB.unpack(word)
    return {**job, "start": signed(job["start"], 10), "down": signed(job["down"], 10)}


def status_of(job: dict[str, int], build: DenseBuild, size: tuple[int, int], present: tuple[int, int]) -> int:
    """What the check says of `job`; `size` is (width, height), `present` whether the slots hold a frame, or will."""
    windows = [build.max_window >> s for s in range(build.sizes)]
    if job["window"] not in windows or job["window"] > min(size):
        return BAD_WINDOW
    if not 1 <= job["offsets"] <= build.offsets:
        return BAD_OFFSETS
    if not all(slot < build.slots and there
               for slot, there in zip((job["left_slot"], job["right_slot"]), present, strict=True)):
        return BAD_SLOT
    return OK if job["step_x"] and job["step_y"] else BAD_STEP


def plan_of(job: dict[str, int], build: DenseBuild, width: int) -> dict[str, int]:
    """Fields of the plan of an acceptable job, in an image `width` pixels wide."""
    start, window = job["start"], job["window"]
    first = max(0, -start - build.offsets + 1)
    skip = first % build.width
    column = first - skip
    ahead, end = start + column, width - max(start, 0)
    slot_words = build.max_height * build.words_per_row
    right = job["right_slot"] * slot_words - job["down"] * build.words_per_row + column // build.width
    return {"shrink": (build.max_window // window).bit_length() - 1, "mask": -window & 0x3FF,
            "left": job["left_slot"] * slot_words, "right": right & 0xFFFF, "above": window * build.words_per_row,
            "pitch": max(width + 2 * build.lanes + 1, build.offsets + build.width + 8),
            "left_delay": max(0, -ahead), "right_delay": max(0, ahead), "column": column, "skip": skip,
            "count": end - column & 0x3FF, "meets": int(end > first), "words": -(-width // job["step_x"])}


class DensePlanModel:
    """The check and the plan of a job. Status and plan are undefined before they are done and when the job changes."""

    INPUTS = ("rst_i", "start_i", "job_i", "image_width_i", "image_height_i", "slot_valid_i", "here_i")
    OUTPUTS = ("done_o", "status_o", "plan_o")

    def __init__(self, build: DenseBuild) -> None:
        self.build = build
        self.left = 0
        self.starting = 0
        """Clocks until `here_i` counts of a live job that was started."""
        self.known: tuple[int, int, int] | None = None
        self.status, self.plan = OK, 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        asked = i["job_i"], i["image_width_i"], i["image_height_i"]
        done = self.left == 1
        if not done and (self.left or asked != self.known):
            out: Values = {"done_o": 0, "status_o": None, "plan_o": None}
        else:
            out = {"done_o": int(done), "status_o": self.status, "plan_o": None if self.status else self.plan}
        if asked != self.known:
            self.known = None
        self.left = max(0, self.left - 1)
        job = unpack_job(i["job_i"])
        if i["rst_i"]:
            self.left, self.starting, self.known = 0, 0, None
        elif i["start_i"]:
            valid = i["slot_valid_i"]
            self._start(job, i, (valid >> job["left_slot"] & 1, valid >> job["right_slot"] & 1))
            self.starting, self.known = HERE * job["live"], asked
        elif self.starting:
            self.starting -= 1
            if not self.starting:
                self._start(job, i, (i["here_i"] & 1, i["here_i"] >> 1))
                self.left -= HERE
        return out

    def _start(self, job: dict[str, int], i: Inputs, present: tuple[int, int]) -> None:
        """Find out what comes of the job, and when, counted from its start."""
        size = i["image_width_i"], i["image_height_i"]
        self.status = status_of(job, self.build, size, present)
        clocks = SETTLE
        if self.status == OK:
            plan = plan_of(job, self.build, size[0])
            self.plan = PLAN.pack(plan)
            clocks = max(SETTLE, plan["words"], abs(job["down"]))
        self.left = clocks + OVERHEAD
