"""What surrounds the peak unit, for its tests: a sequencer and an array that send jobs, a host that takes answers.

`PeakTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL alike.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import repeat

import numpy as np

from golden.correlate import Status, Surface, peak
from golden.params import NO_SCORE
from golden.structs import CONTEXT, RESULT


@dataclass(frozen=True)
class PeakTask:
    """A job as the peak unit sees it: its scores (offsets_y, offsets_x), or why there are none."""

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
        """Packed `result_t` that the board must answer, from the frame-level search."""
        refused = (0, 0, NO_SCORE, (NO_SCORE,) * 8, NO_SCORE)
        x, y, score, around, runner_up = peak(self.scores) if self.status is Status.OK else refused
        return RESULT.pack({"tag": self.tag, "status": self.status, "best_x": x, "best_y": y, "score": score,
                            "runner_up": runner_up, **{f"neighbour{k}": v for k, v in enumerate(around)}})

    def stream(self) -> list[tuple[int, int, int]]:
        """(tdata, tuser, tlast) of the surface stream."""
        if not self.surface or self.status is not Status.OK:
            return []
        flat = [int(s) for s in self.scores.flat]
        return [(s, int(k == 0), int(k == len(flat) - 1)) for k, s in enumerate(flat)]


def random_task(rng: random.Random, cols: int, rows: int, area: int, top: int | None = None) -> PeakTask:
    """Scores 0..`top` at random (a small `top` makes ties), in one of several slopes that move the best about."""
    top = area if top is None else min(top, area)
    scores = np.random.default_rng(rng.getrandbits(32)).integers(0, top + 1, (rows, cols))
    slope = rng.choice(("none", "none", "rising", "falling", "across"))
    y, x = np.indices(scores.shape)
    ramp = {"none": 0 * x, "rising": y, "falling": -y, "across": x}[slope]
    return PeakTask(np.clip(scores + ramp, 0, area).astype(np.int32), area, tag=rng.getrandbits(16),
                    surface=rng.random() < 0.3)


def refused_task(rng: random.Random) -> PeakTask:
    """A refused job, with whatever numbers its context holds."""
    size = rng.randint(0, 3), rng.randint(0, 3)
    return PeakTask(np.zeros(size, dtype=np.int32), rng.getrandbits(15), Status(rng.randint(1, 4)),
                    bool(rng.getrandbits(1)), rng.getrandbits(16))


@dataclass
class PeakTraffic:
    """Jobs into a peak unit and answers out of it.

    As the real sequencer does, it asks for the next row while the present one is being stepped; a row's first score
    follows its first step by `latency` clocks, and a row takes `period` clocks or one per offset, whichever is more.
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

    answers: list[int] = field(default_factory=list)
    streamed: list[tuple[int, int, int]] = field(default_factory=list)
    waits: int = 0
    """Clocks in which the sequencer could have started a row and had no grant."""
    clocks: int = 0

    def stimulus(self) -> Generator[dict[str, int], Mapping[str, int | None], None]:
        """Yields inputs, receives outputs; ends when every job is answered and every score streamed.

        Raises:
            AssertionError: if that takes more than `limit` clocks.
        """
        self.restart()
        streams = sum(len(t.stream()) for t in self.tasks)
        while len(self.answers) < len(self.tasks) or len(self.streamed) < streams:
            assert self.clocks < self.limit, "the peak unit is stuck"
            inputs = self.inputs()
            self.note(inputs, (yield inputs))
            self.clocks += 1

    def restart(self) -> None:
        """Everything from the first job on."""
        self.contexts = deque((t.context(), int(t.status is Status.OK) * t.scores.shape[0]) for t in self.tasks)
        self.rows = deque((t.scores[y], t.area) for t in self.tasks if t.status is Status.OK
                          for y in range(t.scores.shape[0]))
        self.open_rows = 0
        self.granted: deque[tuple[Surface, int]] = deque()
        self.flying: deque[tuple[int, int]] = deque()
        self.next_start = 0
        self.answers.clear()
        self.streamed.clear()

    def inputs(self) -> dict[str, int]:
        """Inputs of this clock; data are garbage where nothing is offered."""
        rng, t = self.rng, self.clocks
        if self.granted and t >= self.next_start:
            row, area = self.granted.popleft()
            self.flying.extend((t + self.latency + x, area - int(s)) for x, s in enumerate(row))
            self.next_start = t + max(len(row), self.period)
        elif self.rows and t >= self.next_start:
            self.waits += 1
        asks = bool(self.open_rows and not self.granted)
        due = bool(self.flying and self.flying[0][0] <= t and next(self.scores))
        # The next context comes when the last row of the one before is granted.
        offers = bool(self.contexts and not self.open_rows)
        return {
            "rst_i": int(t == self.reset_at),
            "ctx_valid_i": int(offers), "ctx_i": self.contexts[0][0] if offers else rng.getrandbits(55),
            "row_valid_i": int(asks), "row_offsets_i": len(self.rows[0][0]) if asks else rng.getrandbits(10),
            "mismatch_valid_i": int(due), "mismatch_i": self.flying[0][1] if due else rng.getrandbits(9),
            "surf_tready_i": next(self.surface), "res_ready_i": next(self.results)}

    def note(self, i: dict[str, int], out: Mapping[str, int | None]) -> None:
        """What happened in this clock."""
        if i["rst_i"]:
            self.restart()
            return
        if out["surf_tvalid_o"] and i["surf_tready_i"]:
            self.streamed.append((out["surf_tdata_o"] or 0, out["surf_tuser_o"] or 0, out["surf_tlast_o"] or 0))
        if out["res_valid_o"] and i["res_ready_i"]:
            self.answers.append(out["res_o"] or 0)
        if i["ctx_valid_i"] and out["ctx_ready_o"]:
            self.open_rows = self.contexts.popleft()[1]
        if i["row_valid_i"] and out["row_ready_o"]:
            self.granted.append(self.rows.popleft())
            self.open_rows -= 1
        if i["mismatch_valid_i"]:
            self.flying.popleft()

    def check(self) -> None:
        """Every answer and every streamed score is the frame-level model's.

        Raises:
            AssertionError: naming the first job that differs.
        """
        for k, (task, got) in enumerate(zip(self.tasks, self.answers, strict=True)):
            assert RESULT.unpack(got) == RESULT.unpack(task.result()), f"job {k} of {task.scores.shape}"
        assert self.streamed == [word for task in self.tasks for word in task.stream()]
