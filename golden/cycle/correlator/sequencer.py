# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_sequencer`."""

from __future__ import annotations

from collections import deque

from golden.correlate import Status
from golden.cycle.correlator.walker import WalkerModel, row_counts
from golden.cycle.model import Inputs, Values
from golden.structs import CONTEXT, STEP_ROW, TICKET, unpack_job


class SequencerModel:
    """Ticket, context, mask, grants and rows of offsets, followed by a `WalkerModel`."""

    INPUTS = ("rst_i", "ticket_valid_i", "ticket_i", "tpl_done_i", "rows_written_i", "ctx_ready_i", "row_ready_i")
    OUTPUTS = ("ticket_ready_o", "rows_freed_o", "bank_free_o", "ctx_valid_o", "ctx_o", "row_valid_o", "row_offsets_o",
               "step_valid_o", "step_o", "mask_o", "busy_o")
    PREPARE = 4

    def __init__(self, group_bits: int, pitch: int, ring_rows: int, drain_clocks: int) -> None:
        self.group_bits, self.pitch, self.ring_rows = group_bits, pitch, ring_rows
        self.walker = WalkerModel(pitch, ring_rows, drain_clocks)
        self.word: int | None = None
        self.masks: deque[int | None] = deque([None] * 5)  # mask_o of the coming clocks, the next first
        self._reset()

    def _reset(self) -> None:
        self.state, self.prepared = "idle", 0
        self.ctx_valid = self.row_valid = self.granted = False
        self.token: int | None = None
        self.mask_width = 0
        self.loaded = False  # the operands of the requested row are loaded
        self.dy = 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        walked = self.walker.step({"rst_i": i["rst_i"], "row_valid_i": int(self.token is not None),
                                   "row_i": self.token or 0})
        idle, token_pending = self.state == "idle", self.token is not None
        ticket = None if self.word is None else TICKET.unpack(self.word)
        job = None if ticket is None else unpack_job(ticket["job"])
        ctx = None
        if ticket is not None and job is not None:
            ctx = CONTEXT.pack({"tag": job.tag, "surface": job.surface, "status": ticket["status"],
                                "offsets_x": job.offsets_x, "offsets_y": job.offsets_y, "area": ticket["area"]})
        self.masks.append(self._mask(self.mask_width))
        out: Values = {
            "ticket_ready_o": int(idle), "rows_freed_o": walked["rows_freed_o"], "bank_free_o": walked["bank_free_o"],
            "ctx_valid_o": int(self.ctx_valid), "ctx_o": ctx, "row_valid_o": int(self.row_valid),
            "row_offsets_o": None if job is None else job.offsets_x, "step_valid_o": walked["step_valid_o"],
            "step_o": walked["step_o"], "mask_o": self.masks.popleft(),
            "busy_o": int(not idle or token_pending or bool(walked["busy_o"]))}

        if walked["row_ready_o"]:
            self.token = None
        if idle:
            self.word = i["ticket_i"]
            self.prepared = 0
            if i["ticket_valid_i"]:
                self.state = "prepare"
        elif ticket is not None and job is not None:
            if self.state == "prepare":
                self.prepared += 1
                if self.prepared == self.PREPARE:
                    self.state, self.ctx_valid = "context", True
            elif self.state == "context":
                if i["ctx_ready_i"]:
                    self.ctx_valid = False
                    self.state = "mask" if ticket["status"] == Status.OK else "idle"
                    self.dy = 0
            elif self.state == "mask":
                if job.width == self.mask_width or (walked["drained_o"] and not token_pending):
                    self.mask_width, self.state = job.width, "rows"
            elif self.state == "rows":
                need = ticket["row"] + self.dy + job.height
                ahead = (i["rows_written_i"] - need) % (2 * self.ring_rows)
                if self.dy == job.offsets_y:
                    self.state = "idle"
                elif self.granted and self.loaded:
                    self.token = self._row(ticket)
                    self.granted = False
                    self.dy += 1
                elif self.row_valid:
                    if i["row_ready_i"]:
                        self.row_valid, self.granted = False, True
                elif not self.granted and not token_pending:
                    self.row_valid = True
                self.loaded = ahead < self.ring_rows and bool(i["tpl_done_i"] >> ticket["bank"] & 1)
        if i["rst_i"]:
            self._reset()
        return out

    def _mask(self, width: int) -> int:
        window = (1 << width) - 1
        return window if width > self.group_bits else window << self.group_bits | window

    def _row(self, ticket: dict[str, int]) -> int:
        """The current row of offsets as a packed `row_t`."""
        job = unpack_job(ticket["job"])
        wide = job.width > self.group_bits
        steps = job.height if wide else -(-job.height // 2)
        passes = max(-(-(job.offsets_x - 1) // self.pitch), 1)
        last_lanes = job.offsets_x - (passes - 1) * self.pitch
        top = ticket["row"] + self.dy
        final = self.dy == job.offsets_y - 1
        before = last_lanes if self.dy else self.pitch + 1
        return STEP_ROW.pack({
            "final_row": final, "bank": ticket["bank"], "wide": wide, "odd": job.height % 2,
            "ring_row": top % self.ring_rows, "last_lanes": last_lanes,
            **row_counts(steps, passes, max(before - steps, 0), max(self.pitch - steps, 0)),
            "free_to": (top + (job.height if final else 1)) % (2 * self.ring_rows)})
