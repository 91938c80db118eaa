# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the peak unit for its tests: a sequencer and an array that send jobs, a host that takes results.

`PeakTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL together.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import repeat

import numpy as np

from golden.correlate import Result, Status, Surface, peak
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.structs import CONTEXT, RESULT, pack_result


def surface_beats(scores: Surface) -> list[tuple[int, int, int]]:
    """(tdata, tuser, tlast) of the stream of a surface, in raster order."""
    flat = [int(s) for s in scores.flat]
    return [(s, int(k == 0), int(k == len(flat) - 1)) for k, s in enumerate(flat)]


@dataclass(frozen=True)
class PeakTask:
    """A job at the peak unit: scores (offsets_y, offsets_x) of a window of `area` pixels, or why it is refused."""

    scores: Surface
    area: int
    status: Status = Status.OK
    surface: bool = False
    tag: int = 0

    def context(self) -> int:
        """Packed `context_t`."""
        rows, cols = self.scores.shape
        return CONTEXT.pack({"tag": self.tag, "surface": self.surface, "status": self.status, "offsets_x": cols,
                             "offsets_y": rows, "area": self.area})

    def result(self) -> int:
        """Packed `result_t` that the board must give, from the frame-level search."""
        found = peak(self.scores) if self.status is Status.OK else ()
        return pack_result(Result(self.tag, self.status, *found))

    def stream(self) -> list[tuple[int, int, int]]:
        """Beats of its surface; none if it was not asked for or the job is refused."""
        return surface_beats(self.scores) if self.surface and self.status is Status.OK else []


def random_task(rng: random.Random, cols: int, rows: int, area: int, top: int | None = None) -> PeakTask:
    """Random scores 0..`top` (a small `top` makes ties), on one of several slopes that move the best."""
    top = area if top is None else min(top, area)
    scores = np.random.default_rng(rng.getrandbits(32)).integers(0, top + 1, (rows, cols))
    slope = rng.choice(("none", "none", "rising", "falling", "across"))
    y, x = np.indices(scores.shape)
    ramp = {"none": 0 * x, "rising": y, "falling": -y, "across": x}[slope]
    return PeakTask(np.clip(scores + ramp, 0, area).astype(np.int32), area, tag=rng.getrandbits(16),
                    surface=rng.random() < 0.3)


def refused_task(rng: random.Random) -> PeakTask:
    """A refused job with random values in its context."""
    size = rng.randint(0, 3), rng.randint(0, 3)
    return PeakTask(np.zeros(size, dtype=np.int32), rng.getrandbits(15), Status(rng.randint(1, 4)),
                    bool(rng.getrandbits(1)), rng.getrandbits(16))


@dataclass
class PeakTraffic:
    """Jobs into a peak unit, results and surfaces out of it.

    Like the sequencer it requests the next row while the current one is in work. The first score of a row follows its
    first step by `latency` clocks; a row takes `period` clocks or one per offset, whichever is more. `scores`,
    `results` and `surface` hold whether that stream moves in a clock.
    """

    tasks: list[PeakTask]
    rng: random.Random
    latency: int = 27
    period: int = 1
    scores: Iterator[int] = field(default_factory=lambda: repeat(1))
    results: Iterator[int] = field(default_factory=lambda: repeat(1))
    surface: Iterator[int] = field(default_factory=lambda: repeat(1))
    reset_at: int | None = None
    limit: int = 100_000

    packed_results: list[int] = field(default_factory=list)
    streamed: list[tuple[int, int, int]] = field(default_factory=list)
    waits: int = 0
    """Clocks in which the sequencer was ready to start a row and had no grant."""
    clocks: int = 0

    def stimulus(self) -> Stimulus:
        """Run until every job has its result and every score is streamed.

        Raises:
            AssertionError: if that takes more than `limit` clocks.
        """
        self._restart()
        streams = sum(len(t.stream()) for t in self.tasks)
        while len(self.packed_results) < len(self.tasks) or len(self.streamed) < streams:
            assert self.clocks < self.limit, "the peak unit is stuck"
            inputs = self._inputs()
            self._note(inputs, (yield inputs))
            self.clocks += 1

    def _restart(self) -> None:
        """Begin again with the first job."""
        self.contexts = deque((t.context(), int(t.status is Status.OK) * t.scores.shape[0]) for t in self.tasks)
        self.rows = deque((t.scores[y], t.area) for t in self.tasks if t.status is Status.OK
                          for y in range(t.scores.shape[0]))
        self.open_rows = 0
        self.granted: deque[tuple[Surface, int]] = deque()
        self.flying: deque[tuple[int, int]] = deque()
        self.next_start = 0
        self.packed_results.clear()
        self.streamed.clear()

    def _inputs(self) -> Inputs:
        """Inputs of this clock; data are random where nothing is offered."""
        rng, t = self.rng, self.clocks
        if self.granted and t >= self.next_start:
            row, area = self.granted.popleft()
            self.flying.extend((t + self.latency + x, area - int(s)) for x, s in enumerate(row))
            self.next_start = t + max(len(row), self.period)
        elif self.rows and t >= self.next_start:
            self.waits += 1
        asks = bool(self.open_rows and not self.granted)
        due = bool(self.flying and self.flying[0][0] <= t and next(self.scores))
        # The next context is offered when the last row of the one before is granted.
        offers = bool(self.contexts and not self.open_rows)
        return {
            "rst_i": int(t == self.reset_at),
            "ctx_valid_i": int(offers), "ctx_i": self.contexts[0][0] if offers else rng.getrandbits(55),
            "row_valid_i": int(asks), "row_offsets_i": len(self.rows[0][0]) if asks else rng.getrandbits(10),
            "mismatch_valid_i": int(due), "mismatch_i": self.flying[0][1] if due else rng.getrandbits(9),
            "surf_tready_i": next(self.surface), "res_ready_i": next(self.results)}

    def _note(self, i: Inputs, out: Outputs) -> None:
        """Take the transfers of this clock."""
        if i["rst_i"]:
            self._restart()
            return
        if out["surf_tvalid_o"] and i["surf_tready_i"]:
            self.streamed.append((out["surf_tdata_o"] or 0, out["surf_tuser_o"] or 0, out["surf_tlast_o"] or 0))
        if out["res_valid_o"] and i["res_ready_i"]:
            self.packed_results.append(out["res_o"] or 0)
        if i["ctx_valid_i"] and out["ctx_ready_o"]:
            self.open_rows = self.contexts.popleft()[1]
        if i["row_valid_i"] and out["row_ready_o"]:
            self.granted.append(self.rows.popleft())
            self.open_rows -= 1
        if i["mismatch_valid_i"]:
            self.flying.popleft()

    def check(self) -> None:
        """Compare every result and every streamed score with the frame level.

        Raises:
            AssertionError: naming the first job that differs.
        """
        for k, (task, got) in enumerate(zip(self.tasks, self.packed_results, strict=True)):
            assert RESULT.unpack(got) == RESULT.unpack(task.result()), f"job {k} of {task.scores.shape}"
        assert self.streamed == [word for task in self.tasks for word in task.stream()]
