# SPDX-License-Identifier: Apache-2.0
"""Cameras as a live pass sees them, without video: requests for slots, and frames that come row by row, or do not.

`camera` gives a camera's `progress_t` clock by clock and keeps the promises of `slog_capture`: a frame that is written
becomes whole or is lost, its rows never become fewer, and a request may go, move or wait again.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass

from golden.correlate import Plane
from golden.cycle.store.capture_channel import CHECK_CLOCKS, PROGRESS

FATES = "whole", "abort", "cancel", "move"
"""What may become of a frame."""
READABLE = 4
"""Clocks from the clock in which a row is counted to that in which it may be read."""


@dataclass
class CameraRequest:
    """What a camera does with one request.

    Attributes:
        slot: that the request is for.
        rows: of a frame.
        pace: clocks between rows, at least and at most.
        wait: clocks, and one, before the frame begins to be written.
        fate: one of FATES, of the first frame.
        at: rows written when it happens; 0: before anything is written, when an abort ends nothing.
        again: clocks after an abort until the next frame, which becomes whole; None: there is none.
        other: slot that the request moves to.
    """

    slot: int
    rows: int
    pace: tuple[int, int] = (1, 1)
    wait: int = 0
    fate: str = "whole"
    at: int = 0
    again: int | None = 0
    other: int = 7


@dataclass
class Shown:
    """A clock of a camera: its progress, the row that is written in this clock (before it is counted) or None, whether
    the slot becomes valid in the next clock or invalid, and whether the row is of the request's first frame."""

    progress: int
    row: int | None = None
    slot: int = 0
    valid: int | None = None
    first: bool = True

    @property
    def slot_of(self) -> int:
        """The slot in its progress."""
        return PROGRESS.unpack(self.progress)["slot"]


def _progress(slot: int, rows: int, writing: bool, done: bool = False) -> int:
    return PROGRESS.pack({"held": 1, "writing": writing, "done": done, "slot": slot, "rows": rows})


def camera(request: CameraRequest, rng: random.Random) -> Generator[Shown, bool, None]:
    """The clocks of one request, until it is gone. Sent back is whether the slot is kept by a pass: a frame that would
    begin then gives way."""
    slot, first, struck = request.slot, True, False  # struck: its fate has happened
    kept = False
    for _ in range(1 + request.wait):
        kept = yield Shown(_progress(slot, 0, False))
    while True:
        fate = "whole" if struck else request.fate
        if fate != "whole" and request.at == 0:
            if fate == "abort":
                struck = True
                kept = yield Shown(_progress(slot, 0, False))
                continue
            if fate == "move":
                for _ in range(rng.randint(1, 9)):
                    yield Shown(_progress(request.other, 0, False))
            return
        for _ in range(CHECK_CLOCKS):
            kept = yield Shown(_progress(slot, 0, False), first=first)
        if kept:  # the frame gives way: the next one may be taken
            continue
        yield Shown(_progress(slot, 0, False), slot=slot, valid=0, first=first)
        rows = 0
        while rows < request.rows and (fate == "whole" or rows < request.at):
            for _ in range(rng.randint(*request.pace)):
                yield Shown(_progress(slot, rows, True), first=first)
            yield Shown(_progress(slot, rows, True), row=rows, slot=slot, first=first)
            rows += 1
        for _ in range(rng.randint(1, 8)):
            yield Shown(_progress(slot, rows, True), first=first)
        if fate == "whole":
            yield Shown(_progress(slot, rows, True, done=True), slot=slot, valid=1, first=first)
            return
        if fate != "abort":
            return
        first, struck = False, True
        for _ in range(request.again or 0):
            kept = yield Shown(_progress(slot, 0, False), first=False)
        while request.again is None:
            kept = yield Shown(_progress(slot, 0, False), first=False)


class Arrivals:
    """Two cameras, each with one request at most, that write frames into a store.

    Attributes:
        valid: a bit for each slot that holds a frame.

    Args:
        requests: of the cameras.
        frames: what the slots' requests get, uint8 (H, W) by slot.
        others: what they get when the first frame was aborted.
        held: what the slots hold at first, by slot.
        write: writes a row of a plane into a slot.
        rng: of the cameras' pace.
    """

    def __init__(self, requests: Sequence[CameraRequest | None], frames: Mapping[int, Plane],
                 others: Mapping[int, Plane], held: Mapping[int, Plane], write: Callable[[int, int, Plane], None],
                 rng: random.Random) -> None:
        self.frames, self.others, self.held = frames, others, dict(held)
        self._write = write
        self._cameras = [(one.slot, camera(one, rng)) for one in requests if one]
        self._shown = [next(running) for _, running in self._cameras]
        self._late: list[tuple[int, int, int, Plane]] = []  # clock in which a row can be read, slot, row, plane
        self._clock = 0

    @property
    def valid(self) -> int:
        """A bit for each slot that holds a frame."""
        return sum(1 << slot for slot in self.held)

    def searched(self) -> dict[int, Plane]:
        """The frames that a live pass gets which begins with this clock's progress, by slot."""
        coming = {shown.slot_of: (self.frames if shown.first else self.others)[shown.slot_of]
                  for shown in self._shown if shown.progress and shown.slot_of in self.frames}
        return {**self.held, **coming}

    def progress(self) -> int:
        """Progress of the cameras in this clock."""
        return sum(shown.progress << PROGRESS.bits * c for c, shown in enumerate(self._shown))

    def step(self, kept: int) -> None:
        """The clock edge; `kept` has a bit for each slot that a pass keeps."""
        for c, (slot, running) in enumerate(self._cameras):
            shown = self._shown[c]
            if not shown.progress:  # its request is gone
                continue
            plane = (self.frames if shown.first else self.others)[slot]
            if shown.row is not None:
                self._late.append((self._clock + 1 + READABLE, slot, shown.row, plane))
            if shown.valid:
                self.held[slot] = plane
            elif shown.valid is not None:
                self.held.pop(slot, None)
            try:
                self._shown[c] = running.send(bool(kept >> slot & 1))
            except StopIteration:
                self._shown[c] = Shown(0)
        self._clock += 1
        for due in [late for late in self._late if late[0] <= self._clock]:
            self._write(*due[1:])
            self._late.remove(due)
