"""Cycle models of `slog_walker` and `slog_sequencer`."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from golden.correlate import Status
from golden.structs import CONTEXT, ROW, STEP, TICKET, unpack_job


def counts(steps: int, passes: int, gap_row: int, gap_pass: int) -> dict[str, int]:
    """These counts as fields of a `row_t`: less one or two, in two's complement."""
    return {"steps": (steps - 2) % 256, "passes": (passes - 2) % 64, "gap_row": (gap_row - 1) % 128,
            "gap_pass": (gap_pass - 1) % 128}


def row_steps(row: dict[str, int], pitch: int, ring_rows: int) -> Iterator[dict[str, int] | None]:
    """What the walker does with a `row_t`, clock by clock: a `step_t`, or None in a gap."""
    steps, passes = (row["steps"] + 2) % 256, (row["passes"] + 2) % 64
    for chunk in range(passes):
        yield from [None] * ((row["gap_pass" if chunk else "gap_row"] + 1) % 128)
        for s in range(steps):
            last = s == steps - 1
            yield {"valid": 1, "first": int(s == 0), "last": int(last), "wide": row["wide"],
                   "row_b": int(bool(row["wide"]) or not (last and row["odd"])), "bank": row["bank"], "tpl_step": s,
                   "ring_row": (row["ring_row"] + (s if row["wide"] else 2 * s)) % ring_rows, "chunk": chunk,
                   "lanes": row["last_lanes"] if chunk == passes - 1 else pitch}


class WalkerModel:
    """Holds what is left of the row in work. `step_o` is undefined between steps."""

    INPUTS = ("rst_i", "row_valid_i", "row_i")
    OUTPUTS = ("row_ready_o", "step_valid_o", "step_o", "rows_freed_o", "bank_free_o", "busy_o", "drained_o")

    def __init__(self, pitch: int, ring_rows: int, drain_clocks: int) -> None:
        self.pitch, self.ring_rows, self.drain_clocks = pitch, ring_rows, drain_clocks
        self.last: int | None = None
        self._reset()

    def _reset(self) -> None:
        self.left: deque[dict[str, int] | None] = deque()
        self.row: dict[str, int] = {}
        self.coming: dict[str, int] | None = None  # the step of the next clock
        self.valid = self.freed = self.bank_free = 0
        self.freeing: tuple[int, int] | None = None  # rows_freed_o and bank_free_o of the next clock
        self.drain, self.drained = self.drain_clocks, False

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = len(self.left) <= 1
        out: dict[str, int | None] = {
            "row_ready_o": int(ready), "step_valid_o": self.valid, "step_o": self.last if self.valid else None,
            "rows_freed_o": self.freed, "bank_free_o": self.bank_free,
            "busy_o": int(bool(self.left) or self.coming is not None or bool(self.valid)),
            "drained_o": int(self.drained)}
        active = bool(self.left)
        step, self.coming = self.coming, self.left.popleft() if self.left else None
        self.valid = int(step is not None)
        ended = active and not self.left
        self.bank_free = 0
        if self.freeing is not None:
            self.freed, self.bank_free = self.freeing
        self.freeing = (self.row["free_to"], self.row["final_row"]) if ended else None
        taken = bool(ready and i["row_valid_i"])
        self.drained = not active and not taken and step is None and self.drain == 0
        self.drain = self.drain_clocks if step is not None else max(self.drain - 1, 0)
        if step is not None:
            self.last = STEP.pack({**step, "valid": 0})
        if taken:
            self.row = ROW.unpack(i["row_i"])
            self.left.extend(row_steps(self.row, self.pitch, self.ring_rows))
        if i["rst_i"]:
            self._reset()
        return out


class SequencerModel:
    """Front of the sequencer (ticket, context, mask, grants, rows) before a `WalkerModel`."""

    INPUTS = ("rst_i", "ticket_valid_i", "ticket_i", "tpl_done_i", "rows_written_i", "ctx_ready_i", "row_ready_i")
    OUTPUTS = ("ticket_ready_o", "rows_freed_o", "bank_free_o", "ctx_valid_o", "ctx_o", "row_valid_o", "row_offsets_o",
               "step_valid_o", "step_o", "mask_o", "busy_o")
    PREPARE = 4

    def __init__(self, group_bits: int, pitch: int, ring_rows: int, drain_clocks: int) -> None:
        self.group_bits, self.pitch, self.ring_rows = group_bits, pitch, ring_rows
        self.walker = WalkerModel(pitch, ring_rows, drain_clocks)
        self.word: int | None = None
        self.masks: deque[int | None] = deque([None] * 5)  # of the next clocks
        self._reset()

    def _reset(self) -> None:
        self.state, self.prepared = "idle", 0
        self.ctx_valid = self.row_valid = self.granted = False
        self.token: int | None = None
        self.mask_width = 0
        self.there = False  # the operands of the row asked for are loaded
        self.dy = 0

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
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
        out: dict[str, int | None] = {
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
                elif self.granted and self.there:
                    self.token = self._row(ticket)
                    self.granted = False
                    self.dy += 1
                elif self.row_valid:
                    if i["row_ready_i"]:
                        self.row_valid, self.granted = False, True
                elif not self.granted and not token_pending:
                    self.row_valid = True
                self.there = ahead < self.ring_rows and ticket_done(i["tpl_done_i"], ticket["bank"])
        if i["rst_i"]:
            self._reset()
        return out

    def _mask(self, width: int) -> int:
        window = (1 << width) - 1
        return window if width > self.group_bits else window << self.group_bits | window

    def _row(self, ticket: dict[str, int]) -> int:
        """The present row of offsets as a packed `row_t`."""
        job = unpack_job(ticket["job"])
        wide = job.width > self.group_bits
        steps = job.height if wide else -(-job.height // 2)
        passes = max(-(-(job.offsets_x - 1) // self.pitch), 1)
        last_lanes = job.offsets_x - (passes - 1) * self.pitch
        top = ticket["row"] + self.dy
        final = self.dy == job.offsets_y - 1
        before = last_lanes if self.dy else self.pitch + 1
        return ROW.pack({
            "final_row": final, "bank": ticket["bank"], "wide": wide, "odd": job.height % 2,
            "ring_row": top % self.ring_rows, "last_lanes": last_lanes,
            **counts(steps, passes, max(before - steps, 0), max(self.pitch - steps, 0)),
            "free_to": (top + (job.height if final else 1)) % (2 * self.ring_rows)})


def ticket_done(done: int, bank: int) -> bool:
    """Whether `bank`'s bit is set in `done`."""
    return bool(done >> bank & 1)
