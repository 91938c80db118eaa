# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_capture_channel`."""

from __future__ import annotations

from collections import deque

from golden.structs import Layout

CHECK_CLOCKS = 5
"""Clocks for which a starting capture checks whether its slot is busy."""
HOPS = 2
"""Clocks by which the words of the queues follow their levels."""
IDLE, ARMED, CHECK, WRITE, FINISH = range(5)
PROGRESS = Layout(("held", 1), ("writing", 1), ("done", 1), ("slot", 3), ("rows", 10))
"""`progress_t`: what a camera's capture tells of the frame in its slot."""


class CaptureChannelModel:
    """The captures of one camera; the fields are the registers of the module."""

    def __init__(self, slot_words: int, words_per_row: int) -> None:
        self.slot_words, self.words_per_row = slot_words, words_per_row
        self.state, self.slot, self.check, self.was_valid, self.row, self.addr = IDLE, 0, 0, 0, 0, 0
        self.busy: deque[int] = deque([0] * 3)  # busy of the three clocks before
        # word, last, start, done, abort of the clock before
        self.came: tuple[int | None, int, int, int, int] = (None, 0, 0, 0, 0)
        self.push: tuple[int, int] | None = None  # enters the queue in this clock
        self.left = [False] * (HOPS + 1)  # by clocks ago: finishing, and the last word had left the queue
        self.clears = self.restores = self.finishes = False  # commands to the valid bit of the slot in this clock
        self.fifo: deque[tuple[int, int]] = deque()
        self.ends = 0
        """Whether the word that enters the queue in this clock is a row's last."""
        self.pushed = self.rows = 0
        """Rows of the frame that have entered the queue, and those that have left it."""

    @property
    def armed(self) -> bool:
        """A request is waiting or being served."""
        return self.state != IDLE

    @property
    def writing(self) -> bool:
        """From frame start to the end of the capture."""
        return self.state in (CHECK, WRITE, FINISH)

    @property
    def progress(self) -> int:
        """`progress_t`: a row is counted 2 clocks after its last word has left the queue, if no other waits then."""
        return PROGRESS.pack({"held": self.armed, "writing": self.state in (WRITE, FINISH), "done": self.finishes,
                              "slot": self.slot * self.armed, "rows": self.rows})

    def edge(self, *, rst: int, arm: bool, cancel: bool, slot: int, busy: int, valid: int, word: int | None, last: int,
             start: int, done: int, abort: int, pop: bool) -> None:
        """Take the clock edge."""
        came = (None, 0, 0, 0, 0) if rst else (word, last, start, done, abort)
        (word, last, start, done, abort), self.came = self.came, came
        self.busy.appendleft(busy)
        busy_before, busy = self.busy.pop(), self.busy[2]
        starts = self.state == ARMED and bool(start) and not arm and not cancel and not rst
        restores = (self.state == CHECK and self.check == 1 and bool(busy) and bool(self.was_valid) and not abort
                    and not cancel and not rst)
        if self.clears:
            self.was_valid = valid
        finished = self.finishes
        finishes = self.state == FINISH and self.left[-1] and not finished and not cancel and not rst
        left = [self.push is None and not self.fifo, *self.left[:-1]]
        self.left = [self.state == FINISH and was and not rst for was in left]
        self.clears, self.restores, self.finishes = starts, restores, finishes
        self._count(rst, last)
        arrived = self.push
        self.push = (self.addr, word) if word is not None and self.state == WRITE and not rst else None
        state, checked = self.state, self.check == 0
        if state == ARMED:
            self.check = CHECK_CLOCKS - 1
            self.row = self.addr = self.slot * self.slot_words
        else:
            self.check = max(self.check - 1, 0)
            if self.push:
                if last:
                    self.row += self.words_per_row
                    self.addr = self.row
                else:
                    self.addr += 1
        if rst or cancel:
            self.state = IDLE
        elif arm:
            self.state = ARMED
        elif state == ARMED:
            self.state = CHECK if start else ARMED
        elif state == CHECK:
            if abort:
                self.state = ARMED
            elif checked:
                self.state = ARMED if busy_before else WRITE
        elif state == WRITE:
            self.state = ARMED if abort else FINISH if done else WRITE
        elif finished:
            self.state = IDLE
        if arm:
            self.slot = slot
        if rst:
            self.fifo.clear()
        else:
            if pop:
                self.fifo.popleft()
            if arrived:
                self.fifo.append(arrived)

    def _count(self, rst: int, last: int) -> None:
        """Count rows; `last` is of the word that enters the queue in the next clock."""
        if rst or self.state == ARMED:
            self.pushed = self.rows = 0
        else:
            if not self.fifo:
                self.rows = self.pushed
            self.pushed += int(self.push is not None and self.ends)
        self.ends = last
