"""Cycle models of `slog_capture` and its `slog_capture_channel`."""

from __future__ import annotations

from collections import deque

FIFO_DEPTH = 4
CHECK_CLOCKS = 5
HOPS = 2
"""Clocks that the queues' words are behind their levels."""
IDLE, ARMED, CHECK, WRITE, FINISH = range(5)


class ChannelModel:
    """One camera's captures; the fields are the registers of `slog_capture_channel`."""

    def __init__(self, slot_words: int, words_per_row: int) -> None:
        self.slot_words, self.words_per_row = slot_words, words_per_row
        self.state, self.slot, self.check, self.was_valid, self.row, self.addr = IDLE, 0, 0, 0, 0, 0
        self.busy: deque[int] = deque([0] * 3)  # of the three clocks before
        self.came: tuple[int | None, int, int, int, int] = (None, 0, 0, 0, 0)  # what came in the clock before
        self.push: tuple[int, int] | None = None  # goes into the queue
        self.left = [False] * (HOPS + 1)  # finishing, and by clocks ago: the last word had left the queue
        self.clears = self.restores = self.finishes = False  # what the slot's valid bit hears in this clock
        self.fifo: deque[tuple[int, int]] = deque()

    @property
    def armed(self) -> bool:
        """A request waits or is being served."""
        return self.state != IDLE

    @property
    def writing(self) -> bool:
        """From frame start to finish."""
        return self.state in (CHECK, WRITE, FINISH)

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


class CaptureModel:
    """Two (or one) channels, the valid bits, and camera 0 first into the store. Vectors are packed, camera 0 lowest."""

    INPUTS = ("rst_i", "cmd_valid_i", "cmd_cancel_i", "cmd_camera_i", "cmd_slot_i", "clear_i", "slot_busy_i",
              "word_valid_i", "word_data_i", "word_last_i", "frame_start_i", "frame_done_i", "frame_abort_i")
    OUTPUTS = ("wr_valid_o", "wr_addr_o", "wr_data_o", "slot_valid_o", "armed_o", "writing_o", "refused_o", "done_o")

    def __init__(self, cameras: int, group_bits: int, slots: int, slot_words: int, words_per_row: int) -> None:
        self.cameras, self.group_bits, self.slots = cameras, group_bits, slots
        self.channels = [ChannelModel(slot_words, words_per_row) for _ in range(cameras)]
        self.slot_valid, self.refused, self.done = 0, 0, 0
        self.write: tuple[int, int] | None = None
        self.chosen: list[tuple[int, int] | None] = [None] * (HOPS + 1)  # the store's next, the latest first
        self.command: tuple[bool, int, int] | None = None  # of two clocks before: cancel, camera, slot
        self.coming: tuple[bool, int, int] | None = None  # of the clock before

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock: all come from registers, among them the command of two clocks before."""
        arm, cancel, refused = self._decide()
        return {
            "wr_valid_o": int(self.write is not None),
            "wr_addr_o": self.write[0] if self.write else None,
            "wr_data_o": self.write[1] if self.write else None,
            "slot_valid_o": self.slot_valid,
            "armed_o": sum((arm == c or (ch.armed and cancel != c)) << c for c, ch in enumerate(self.channels)),
            "writing_o": sum(ch.writing << c for c, ch in enumerate(self.channels)),
            "refused_o": refused,
            "done_o": self.done,
        }

    def _decide(self) -> tuple[int | None, int | None, int]:
        """The camera armed, the camera cancelled, whether the last command was refused."""
        if self.command is None:
            return None, None, self.refused
        cancel, camera, slot = self.command
        if cancel:
            return None, camera, 0
        taken = any(ch.writing if c == camera else ch.armed and ch.slot == slot
                    for c, ch in enumerate(self.channels))
        accept = slot < self.slots and camera < self.cameras and not taken
        return (camera, None, 0) if accept else (None, None, 1)

    def step(self, i: dict[str, int]) -> dict[str, int | None]:
        """Outputs of this clock, then the clock edge."""
        out = self.outputs()
        arm, cancel, refused = self._decide()
        slot = self.command[2] if self.command else 0
        pops = next((c for c, ch in enumerate(self.channels) if ch.fifo), None)
        write = self.channels[pops].fifo[0] if pops is not None else None
        valid, any_done = self.slot_valid, False
        mask = (1 << self.group_bits) - 1
        for c, ch in enumerate(self.channels):
            held = ch.slot
            if ch.clears:
                valid &= ~(1 << held)
            if ch.restores or ch.finishes:
                valid |= 1 << held
            any_done |= ch.finishes
            ch.edge(
                rst=i["rst_i"], arm=arm == c, cancel=cancel == c, slot=slot, busy=i["slot_busy_i"] >> held & 1,
                valid=self.slot_valid >> held & 1,
                word=(i["word_data_i"] >> c * self.group_bits) & mask if i["word_valid_i"] >> c & 1 else None,
                last=i["word_last_i"] >> c & 1, start=i["frame_start_i"] >> c & 1, done=i["frame_done_i"] >> c & 1,
                abort=i["frame_abort_i"] >> c & 1, pop=pops == c)
        self.command, self.coming = self.coming, None
        if i["cmd_valid_i"]:
            self.coming = bool(i["cmd_cancel_i"]), i["cmd_camera_i"], i["cmd_slot_i"]
        if i["rst_i"]:
            self.command = self.coming = None
            self.slot_valid, self.refused, self.done, self.write = 0, 0, 0, None
            self.chosen = [None] * (HOPS + 1)
        else:
            self.slot_valid = 0 if i["clear_i"] else valid
            self.refused = refused
            self.done = int(any_done)
            *self.chosen, self.write = write, *self.chosen
        return out
