# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_video_in`."""

from __future__ import annotations

from dataclasses import dataclass, field

from golden.cycle.model import Inputs, Values


@dataclass(eq=False)
class _Frame:
    """A frame being received or processed; `dead` once it is dropped."""

    dead: bool = False


@dataclass
class _Line:
    """A received line and its frame."""

    frame: _Frame
    row: int
    pixels: list[int]


@dataclass
class _Event:
    """Effect of a beat; it reaches the scheduler one clock later."""

    line: _Line | None = None
    kill: _Frame | None = None
    drops: int = 0


@dataclass
class _Tick:
    """A line being issued; `line` is None for a filler below the last line."""

    line: _Line | None
    out: bool = False
    bottom: int | None = None
    dist: int | None = None
    """Side and distance of the border for the whole line, also if its frame is dropped meanwhile; None without an
    output row."""
    col: int = 0


@dataclass
class _Output:
    """The frame whose rows are being computed."""

    frame: _Frame
    row: int = 0
    begun: bool = False


@dataclass
class _Issue:
    """A pixel on its way to the outputs."""

    px: Values = field(default_factory=dict)
    valid: int = 0
    abort: int = 0


class VideoInModel:
    """Frames and lines as objects: a line of a dead frame is discarded, and none ever waits for another."""

    INPUTS = ("rst_i", "tdata_i", "tvalid_i", "tuser_i", "tlast_i", "width_i", "height_i", "hold_i",
              "abort_i")
    OUTPUTS = ("tready_o", "px_valid_o", "px_data_o", "px_col_o", "px_first_o", "px_last_o", "px_out_o", "px_bottom_o",
               "px_dist_o", "px_live_o", "px_start_o", "px_done_o", "px_abort_o", "accepted_o", "dropped_o", "busy_o")
    LATENCY = 6
    """Clocks from the last beat of a line to its first pixel, from idle."""

    def __init__(self, radius: int) -> None:
        self.radius = radius
        self.data: int | None = None
        self.reads: list[int | None] = [None] * 3
        self._reset()

    def _reset(self) -> None:
        self.state = "closed"
        self.frame = _Frame()
        self.line = _Line(self.frame, 0, [])
        self.event = _Event()
        self.owed, self.dropped = 0, 0
        self.stop = 0  # abort_i of the clock before
        self.complete: _Line | None = None  # the line that is started in this clock
        self.tick: _Tick | None = None
        self.read: _Line | None = None
        self.out: _Output | None = None
        self.pipe = [_Issue() for _ in range(3)]
        self.accepted = 0

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        event, shown = self.event, self.pipe[2]
        if self.reads[2] is not None:
            self.data = self.reads[2]
        line = self.tick.line if self.tick else None
        self.reads = [line.pixels[self.tick.col] if self.tick and line else None, *self.reads[:2]]
        ready = not self.stop and not (i["hold_i"] and self.state != "active")
        out: Values = {
            "tready_o": int(ready), "px_valid_o": shown.valid, "px_data_o": self.data,
            **{f"px_{k}_o": shown.px.get(f"px_{k}_o") for k in ("col", "first", "last", "out", "bottom", "dist")},
            **{f"px_{k}_o": shown.px.get(f"px_{k}_o", 0) for k in ("live", "start", "done")},
            "px_abort_o": shown.abort, "accepted_o": self.accepted, "dropped_o": self.dropped,
            "busy_o": int(self.state == "active" or event.line is not None or self.complete is not None or
                          self.tick is not None or self.out is not None or
                          any(p.valid or p.abort for p in self.pipe))}
        if i["rst_i"]:
            self._reset()
            return out
        self.dropped = int(event.drops > 0 or self.owed > 0)
        self.owed = max(0, self.owed + event.drops - 1)
        killed = event.kill
        issue = self._issue(i, killed)
        self._schedule(i, killed)
        if killed:
            killed.dead = True
        self.complete = event.line
        self.pipe = [issue, *self.pipe[:2]]
        self.accepted = int(issue.px.get("px_done_o") or 0)
        self.event = self._abort() if self.stop else self._receive(i) if ready and i["tvalid_i"] else _Event()
        self.stop = i["abort_i"]
        return out

    def _abort(self) -> _Event:
        """Drop the frame that is being received, if any."""
        if self.state != "active":
            return _Event()
        self.state = "ignore"
        return _Event(kill=self.frame, drops=1)

    def _receive(self, i: Inputs) -> _Event:
        """Check an accepted beat against the frame and store it."""
        event = _Event()
        start, end = i["tuser_i"], i["tlast_i"]
        at_end = len(self.line.pixels) == i["width_i"] - 1
        if (self.state == "active" and (start or end != at_end)) or (self.state == "closed" and not start):
            event.kill, event.drops, self.state = self.frame, 1, "ignore"
        if start:
            self.frame = _Frame()
            self.line = _Line(self.frame, 0, [i["tdata_i"]])
            self.state = "active"
            if end:
                event.drops += 1
                self.state = "ignore"
        elif self.state == "active":
            self.line.pixels.append(i["tdata_i"])
            if end:
                event.line = self.line
                self.line = _Line(self.frame, event.line.row + 1, [])
                if self.line.row == i["height_i"]:
                    self.state = "closed"
        return event

    def _issue(self, i: Inputs, killed: _Frame | None) -> _Issue:
        """The pixel issued in this clock; ends the output frame at its last pixel or when it is `killed`."""
        issue, r, tick, o = _Issue(), self.radius, self.tick, self.out
        dies = o is not None and o.frame is killed
        if tick:
            last = tick.col == i["width_i"] - 1
            left = i["height_i"] - 1 - o.row if o else 0
            if tick.col == 0 and o:
                tick.out, tick.bottom, tick.dist = True, int(left < r), left if left < r else min(o.row, r)
            live = o is not None and not dies
            issue.valid = 1
            issue.px = {
                "px_col_o": tick.col, "px_first_o": int(tick.col == 0), "px_last_o": int(last),
                "px_out_o": int(tick.out), "px_live_o": int(live),
                "px_start_o": int(live and o is not None and not o.begun),
                "px_done_o": int(live and last and left == 0),
                "px_bottom_o": tick.bottom, "px_dist_o": tick.dist}
            if o:
                o.begun, begun = True, o.begun
                if dies:
                    issue.abort = int(begun)
                if last and left == 0:
                    self.out = None
            tick.col += 1
            if last:
                self.tick = None
        elif dies and o:
            issue.abort = int(o.begun)
        if dies:
            self.out = None
        return issue

    def _schedule(self, i: Inputs, killed: _Frame | None) -> None:
        """At the end of a line take the next line, or a filler."""
        line, o = self.complete, self.out
        if self.tick:
            assert line is None, "a line waits"
            return
        if line:
            if line.frame.dead or line.frame is killed:
                return
            self.tick, self.read = _Tick(line), line
            if line.row == self.radius:
                self.out = _Output(line.frame)
            elif o:
                o.row += 1
        elif o and self.state != "active":
            mid_frame = self.read and self.read.row < i["height_i"] - 1 and not self.read.frame.dead
            if not mid_frame:
                self.tick = _Tick(None)
                o.row += 1
