# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_pass`."""

from __future__ import annotations

from golden.cycle.dense.plan import unpack_job
from golden.cycle.dense.structs import CANCELLED, LOST, OK
from golden.cycle.model import Inputs, Values

IDLE, TAKE, MARK, PLAN, FLUSH, ROWS, DRAIN, EMPTY, TAIL, OVER = range(10)
READING = MARK, PLAN, FLUSH, ROWS, DRAIN
"""States in which the job's slots are marked."""
MAPPING = ROWS, DRAIN, EMPTY, TAIL
"""States in which what comes out of the engine is of a map."""


class DensePassModel:
    """The states of a pass. Words of a row are undefined before the first pass.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "start_i", "job_i", "cancel_i", "image_width_i", "image_height_i", "planned_i", "status_i",
              "pitch_i", "row_words_i", "feed_busy_i", "keep_i", "there_i", "whole_i", "lost_i", "room_i", "empty_i")
    OUTPUTS = ("slot_busy_o", "job_o", "slots_o", "image_width_o", "image_height_o", "plan_o", "begin_o",
               "flush_o", "clear_o", "row_o", "words_o", "reserve_o", "reading_o", "tail_o", "busy_o", "done_o",
               "status_o", "stall_o")

    def __init__(self, flush: int) -> None:
        self.flush = flush
        self.came: tuple[int | None, int | None, int | None] = None, None, None
        """Job and size of the clock before."""
        self.job: int | None = None
        self.size: tuple[int | None, int | None] = None, None
        self.feeds = 0
        """Whether the feed was busy in the clock before."""
        self.gap: int | None = None
        self.words: int | None = None
        self.has: bool | None = None
        """Whether the next row has words, one clock late."""
        self.rows = 0
        self._stop()

    def _stop(self) -> None:
        self.state, self.status = IDLE, OK
        self.quit = self.early = False
        self.planned: int | None = None
        """Status of the plan that was done in the clock before."""
        self.left = self.wait = 0
        """Clocks of the flush, and until a row may start."""
        self.tail = 0
        """Whether the tail's state was that of the clock before."""
        self.pulses = dict.fromkeys(("begin_o", "row_o", "reserve_o", "tail_o", "stall_o", "slot_busy_o"), 0)
        self.pulses["clear_o"] = 1

    @property
    def out(self) -> Values:
        return {**self.pulses, "job_o": self.job, "slots_o": self._slots_of_job(),
                "image_width_o": self.size[0], "image_height_o": self.size[1],
                "plan_o": int(self.state == MARK), "flush_o": int(self.state == FLUSH), "words_o": self.words,
                "reading_o": int(self.state in READING),
                "done_o": int(self.state == OVER),
                "busy_o": int(self.state != IDLE), "status_o": self.status}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out, state = self.out, self.state
        started = self.pulses["row_o"]
        due = state == ROWS and self.wait == 0 and not started
        whole = self.rows <= (self.gap or 0)
        ending = due and (whole or self.quit)
        going = due and not ending and bool(i["room_i"]) and bool(i["there_i"])
        accepted = self.planned == OK
        ended = state == EMPTY and bool(i["empty_i"])
        self.pulses = {
            "begin_o": int(accepted), "row_o": int(going), "tail_o": self.tail,
            "reserve_o": int((going and self.gap == 0) or (ended and self.early)), "clear_o": int(state not in MAPPING),
            "stall_o": int(due and not ending and bool(i["there_i"]) and not going),
            "slot_busy_o": self._slots(i["keep_i"]) if state in READING else 0}
        self.tail = int(state == TAIL)
        self.words = 1 if state in (EMPTY, TAIL) else None if self.has is None else i["row_words_i"] * self.has
        self.has = None if self.gap is None else not self.gap
        freed = state == DRAIN and not self.feeds and bool(i["whole_i"] or self.quit)
        self._status(i, freed)
        self.state = self._next(i, ending, freed, ended)
        self.feeds = i["feed_busy_i"]
        self._count(i, state, bool(started))
        self.planned = i["status_i"] if state == PLAN and i["planned_i"] and self.planned is None else None
        if ending:
            self.early = not whole
        if state == TAIL:
            self.early = False
        self.quit = state != IDLE and (self.quit or bool(i["cancel_i"] or i["lost_i"]))
        if state in (IDLE, TAKE):
            self.job, self.size, self.early = self.came[0], self.came[1:], False
        self.came = i["job_i"], i["image_width_i"], i["image_height_i"]
        if i["rst_i"]:
            self._stop()
        return out

    def _slots(self, keep: int) -> int:
        """A bit for each slot of the job's planes in `keep`, bit 0 the left one."""
        slots = self._slots_of_job() or 0
        return (slots if keep & 1 else 0) & 0xFF | (slots >> 8 if keep & 2 else 0)

    def _slots_of_job(self) -> int | None:
        """A bit for each plane's slot, the right one's from bit 8 on; None before the first job."""
        if self.job is None:
            return None
        job = unpack_job(self.job)
        return 1 << job["left_slot"] | 1 << 8 + job["right_slot"]

    def _status(self, i: Inputs, freed: bool) -> None:
        if self.planned is not None:
            self.status = self.planned
        elif freed:
            self.status = LOST if i["lost_i"] else CANCELLED if self.early or not i["whole_i"] else OK

    def _next(self, i: Inputs, ending: bool, freed: bool, ended: bool) -> int:
        """The state of the next clock."""
        after = {IDLE: (i["start_i"], TAKE), TAKE: (True, MARK), MARK: (True, PLAN),
                 PLAN: (self.planned is not None, OVER if self.planned else FLUSH),
                 FLUSH: (self.left == self.flush - 1, ROWS), ROWS: (ending, DRAIN),
                 DRAIN: (freed, EMPTY),
                 EMPTY: (ended, TAIL if self.early else OVER), TAIL: (True, EMPTY), OVER: (True, IDLE)}
        moves, state = after[self.state]
        return state if moves else self.state

    def _count(self, i: Inputs, state: int, started: bool) -> None:
        """Rows and clocks."""
        self.left = self.left + 1 if state == FLUSH else 0
        self.wait = max(0, self.wait - 1)
        if state == FLUSH:
            self.rows, self.gap, self.wait = self.size[1] or 0, 0, 0
        elif started:
            self.rows -= 1
            self.gap = (self.gap or unpack_job(self.job or 0)["step_y"]) - 1
            self.wait = i["pitch_i"] - 2
