# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_fetch`."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from golden.correlate import Status
from golden.cycle.correlator.align import AlignModel
from golden.cycle.correlator.job_check import JobCheckModel
from golden.cycle.correlator.job_plan import loads
from golden.cycle.model import Inputs, Values
from golden.cycle.store.store import STORE_LATENCY
from golden.params import Config
from golden.structs import TICKET, unpack_job

PAUSE = 3
"""Clocks between a job's two rectangles: end detected, next plan loaded, first row begun."""
READ_DELAY = 2
"""Clocks from the choice of a word to its store read: address computed, address registered."""


@dataclass(frozen=True)
class Read:
    """A store read and its use: where `emit` is set, it gives aligned word `word` of operand row `row`."""

    addr: int
    shift: int
    emit: bool
    begins: bool
    row_end: bool
    load_end: bool
    tpl: bool
    wide: bool
    bank: int
    row: int
    word: int
    ring_end: bool


class FetchModel:
    """Per job: check, ticket, template reads, search reads; all reads of a job are listed when it is accepted."""

    INPUTS = ("rst_i", "job_valid_i", "job_i", "image_width_i", "image_height_i", "slot_valid_i", "rd_data_i",
              "ticket_ready_i", "rows_freed_i", "bank_free_i")
    OUTPUTS = ("job_ready_o", "slot_busy_o", "rd_valid_o", "rd_addr_o", "wr_valid_o", "wr_tpl_o", "wr_wide_o",
               "wr_bank_o", "wr_row_o", "wr_word_o", "wr_data_o", "ticket_valid_o", "ticket_o", "tpl_done_o",
               "rows_written_o", "busy_o")

    def __init__(self, config: Config) -> None:
        self.config = config
        self.counter = 2 * config.ring_rows
        self.check = JobCheckModel(config)
        self.align = AlignModel(config.group_bits)
        self.job = 0
        self.ticket: int | None = None
        self.data = 0  # rd_data_i of the clock before
        self.slot_valid = 0  # slot_valid_i of the clock before
        self.sides: list[Read] = []  # indexed by the side words of the align model
        self._reset()

    def _reset(self) -> None:
        self.state = "idle"
        self.busy_slots = 0
        self.offered = False
        self.banks_used = 0
        self.bank = 1
        self.reads: deque[Read] = deque()
        self.flight: list[int | None] = [None] * (READ_DELAY + STORE_LATENCY + 2)
        self.pause = 0  # clocks before the next rectangle's first read
        self.ring, self.full = 0, False
        self.limits = deque([self.config.ring_rows] * 2)  # for the next clock and the one after
        self.rows_written = 0
        self.tpl_done = 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        arriving, asking = self.flight[-1], self.flight[READ_DELAY]
        aligned = self.align.step({
            "rst_i": i["rst_i"], "in_valid_i": int(arriving is not None),
            "in_emit_i": int(arriving is not None and self.sides[arriving].emit), "in_data_i": self.data,
            "in_shift_i": 0 if arriving is None else self.sides[arriving].shift, "in_side_i": arriving or 0})
        side = None if aligned["out_side_o"] is None else self.sides[aligned["out_side_o"]]
        self.data = i["rd_data_i"]
        checked = self.check.step({**{k: i[k] for k in ("rst_i", "image_width_i", "image_height_i")},
                                   "slot_valid_i": self.slot_valid, "start_i": int(self.state == "start"),
                                   "job_i": self.job})
        self.slot_valid = i["slot_valid_i"]
        out: Values = {
            "job_ready_o": int(self.state == "idle"), "slot_busy_o": self.busy_slots,
            "rd_valid_o": int(asking is not None), "rd_addr_o": None if asking is None else self.sides[asking].addr,
            "wr_valid_o": aligned["out_valid_o"], "wr_data_o": aligned["out_data_o"],
            "wr_tpl_o": None if side is None else int(side.tpl), "wr_wide_o": None if side is None else int(side.wide),
            "wr_bank_o": None if side is None else side.bank, "wr_row_o": None if side is None else side.row,
            "wr_word_o": None if side is None else side.word,
            "ticket_valid_o": int(self.offered), "ticket_o": self.ticket, "tpl_done_o": self.tpl_done,
            "rows_written_o": self.rows_written, "busy_o": int(self.state != "idle" or self.offered)}

        if aligned["out_valid_o"] and side is not None and side.row_end:
            self._write_row(side)
        state, ring = self.state, self.ring
        self._read_store(i["rows_freed_i"])
        self._advance(state, ring, i, checked)
        if i["rst_i"]:
            self._reset()
        return out

    def _write_row(self, side: Read) -> None:
        """Count an operand row whose last word is written in this clock."""
        if not side.tpl:
            self.rows_written = (self.rows_written + 1) % self.counter
        elif side.load_end:
            self.tpl_done |= 1 << side.bank

    def _read_store(self, rows_freed: int) -> None:
        """Choose the next word to read, if its ring row is free; `rows_freed` is the walker's count."""
        self.flight.pop()
        paused, self.pause = self.pause, max(self.pause - 1, 0)
        reading = bool(self.reads) and not paused and (
            self.reads[0].tpl or not self.reads[0].begins or not self.full)
        if reading:
            read = self.reads.popleft()
            self.sides.append(read)
            self.flight.insert(0, len(self.sides) - 1)
            if read.ring_end:
                self.ring = (self.ring + 1) % self.counter
            if not self.reads:
                self.state = "end"
            elif read.tpl and not self.reads[0].tpl:
                self.pause = PAUSE
        else:
            self.flight.insert(0, None)
        self.full = self.ring == self.limits.popleft()
        self.limits.append((rows_freed + self.config.ring_rows) % self.counter)

    def _advance(self, state: str, ring: int, i: Inputs, checked: Values) -> None:
        """Take the job from `state` of this clock to the next: accepted, checked, its ticket issued, its reads listed.

        Args:
            state: this clock's; the store read may have changed `self.state`.
            ring: this clock's ring row, where the search rectangle of a new job begins.
            i: inputs.
            checked: outputs of the job check.
        """
        free_bank = self.banks_used < 2
        self.banks_used -= i["bank_free_i"]
        offered = self.offered
        if i["ticket_ready_i"]:
            self.offered = False
        if state == "idle":
            self.job, self.busy_slots = i["job_i"], 0
            if i["job_valid_i"]:
                self.state = "mark"
        elif state == "mark":
            job = unpack_job(self.job)
            self.state, self.busy_slots = "start", 1 << job.tpl_slot | 1 << job.search_slot
        elif state == "start":
            self.state = "check"
        elif state == "check":
            if checked["done_o"]:
                self.state = "wait"
        elif state == "wait":
            if not offered and (checked["status_o"] != Status.OK or free_bank):
                self.state = "issue"
        elif state == "issue":
            status, area = checked["status_o"], checked["area_o"]
            assert status is not None and area is not None
            self.ticket = TICKET.pack({"job": self.job, "status": status, "bank": 1 - self.bank, "row": ring,
                                       "area": area})
            self.offered = True
            if status != Status.OK:
                self.state = "idle"
            else:
                self.state = "load"
                self.banks_used += 1
                self.bank = 1 - self.bank
                self.tpl_done &= ~(1 << self.bank)
                self.reads.extend(self._layout())
                self.pause = 1
        elif state == "end":
            self.state = "over"
        elif state == "over":
            self.state = "idle"

    def _layout(self) -> Iterator[Read]:
        """Every read of the current job: template before search, row by row, word by word."""
        c = self.config
        job = unpack_job(self.job)
        for tpl, load in zip((True, False), loads(job, c), strict=True):
            words = range(load.x // c.group_bits, (load.x + load.bits - 1) // c.group_bits + 1)
            aligned = -(-load.bits // c.group_bits)
            for row in range(load.rows):
                for k, word in enumerate(words):
                    yield Read(
                        addr=(load.line + row) * c.words_per_row + word, shift=load.x % c.group_bits, emit=k < aligned,
                        begins=k == 0, row_end=k == aligned - 1, load_end=row == load.rows - 1, tpl=tpl,
                        wide=job.width > c.group_bits, bank=self.bank,
                        row=row if tpl else (self.ring + row) % c.ring_rows, word=k,
                        ring_end=not tpl and word == words[-1])
