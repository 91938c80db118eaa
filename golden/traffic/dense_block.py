# SPDX-License-Identifier: Apache-2.0
"""The surroundings of `slog_dense` for its tests: a store, a host that starts passes, and a sink for their maps.

`DenseBlockTraffic.stimulus` drives the cycle model alone or, in cocotb, model and RTL together. What came of each start
is held against the frame level by `verify`.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field, replace

from golden.correlate import Plane
from golden.cycle.bits import or_zero
from golden.cycle.dense.out import map_word
from golden.cycle.dense.plan import DenseBuild
from golden.cycle.dense.structs import CANCELLED, DENSE_JOB, LOST, MAP, NO_SUM, NOTHING
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.capture_channel import PROGRESS
from golden.cycle.store.store import STORE_LATENCY
from golden.dense import DensePass, dense
from golden.dense_job import STEP_MAX, DenseJob, DenseResult, DenseStatus, check_dense, judge
from golden.params import Config
from golden.traffic.live import Arrivals, CameraRequest
from golden.traffic.stalls import ready_pattern
from golden.traffic.store import plane_words

LONGEST = 200_000
"""Clocks after which a pass hangs."""


def build_of(config: Config, out_depth: int) -> DenseBuild:
    """The block of a board's configuration."""
    return DenseBuild(config.group_bits, config.max_width, config.max_height, config.words_per_row, config.slots,
                      config.dense_offsets, config.dense_lanes, config.dense_window, config.dense_sizes, out_depth)


@dataclass(frozen=True)
class Start:
    """A start of the block.

    Attributes:
        job: fields of `dense_job_t`, start and down signed.
        planes: what the slots with a frame hold, uint8 0/1, (H, W) of the image.
        size: of the image, (width, height).
        cancel: clocks after the start in which a cancel comes; None: none comes.
        reset: clocks after the start in which a reset ends everything; None: none does.
        sink: shape of the sink's stalls.
        requests: of the cameras, of a live job: `planes` has the frames that they get, and `old` what their slots hold
            before, if anything.
        old: as `planes`.
        before: clocks for which the cameras run before the start.
        clear: clocks after the start in which the image's size changes; None: it does not.
    """

    job: Mapping[str, int]
    planes: Mapping[int, Plane]
    size: tuple[int, int]
    cancel: int | None = None
    reset: int | None = None
    sink: str = "none"
    requests: tuple[CameraRequest | None, CameraRequest | None] = (None, None)
    old: Mapping[int, Plane] = field(default_factory=dict)
    before: int = 0
    clear: int | None = None


@dataclass
class PassOutcome:
    """What came of a start: map words with their first and last flags, status, clocks, and pulses counted; of a live
    pass also the frames that it is of, by slot."""

    words: list[tuple[int, int, int]] = field(default_factory=list)
    status: int = -1
    clocks: int = 0
    rows: int = 0
    stalls: int = 0
    planes: Mapping[int, Plane] | None = None


def pack_start(job: Mapping[str, int]) -> int:
    """A job as `dense_job_t`."""
    return DENSE_JOB.pack({**job, "start": job["start"] & 0x3FF, "down": job["down"] & 0x3FF})


def map_words(result: DenseResult) -> list[list[int]]:
    """A result's rows as words of the map."""
    rows = []
    sums = {name: getattr(result, name) & NO_SUM for name in ("best", "lower", "upper", "rest")}
    for y in range(len(result.index)):
        rows.append([MAP.pack({"zero": 0, "index": max(0, int(result.index[y, x])),
                               **{name: int(getattr(result, name)[y, x]) for name in ("found", "agrees", "valid")},
                               **{name: int(values[y, x]) for name, values in sums.items()}})
                     for x in range(result.index.shape[1])])
    return rows


def expected(start: Start, config: Config) -> tuple[DenseStatus, list[list[int]]]:
    """Status of a start, and the rows of its map."""
    job = start.job
    slots, step = (job["left_slot"], job["right_slot"]), (job["step_x"], job["step_y"])
    status = check_dense(job["window"], job["offsets"], slots, step, config, start.size, start.planes)
    if status is not DenseStatus.OK:
        return status, []
    one = DenseJob(*slots, DensePass(job["window"], job["offsets"], job["start"], job["down"]), step, job["most"],
                   job["margin"], bool(job["check"]))
    return status, map_words(judge(dense(start.planes[slots[0]], start.planes[slots[1]], one.search), one))


def verify(start: Start, outcome: PassOutcome, config: Config) -> bool:
    """Whether the map of a start that was not reset ended early.

    Raises:
        AssertionError: if anything is not as the frame level has it.
    """
    if outcome.planes is not None:
        start = replace(start, planes=outcome.planes)
    status, rows = expected(start, config)
    sent = (len(rows) - 1) * start.job["step_y"] + 1 if rows else 0
    early = outcome.status in (CANCELLED, LOST) and outcome.rows < sent
    if outcome.status in (CANCELLED, LOST):
        assert status is DenseStatus.OK
        assert early or (start.job["live"] and outcome.rows == sent), start
        assert start.job["live"] if outcome.status == LOST else start.cancel is not None, start
    if early:
        rows = [*rows[:-(-outcome.rows // start.job["step_y"])], [map_word(NOTHING, 0, 0, 0)]]
    else:
        assert outcome.status in (status, CANCELLED, LOST), (start.job, outcome.status, status)
        assert outcome.rows == sent, (start.job, outcome.rows, sent)
    wanted = [word for row in rows for word in row]
    flags = [(int(n == 0), int(n == len(wanted) - 1)) for n in range(len(wanted))]
    found = [word for word, *_ in outcome.words]
    if found != wanted:
        same = [a == b for a, b in zip(found, wanted, strict=False)]
        n = same.index(False) if False in same else len(same)
        both = [MAP.unpack(words[n]) for words in (found, wanted) if n < len(words)]
        raise AssertionError(f"{start.job}, size {start.size}: {len(found)} words of {len(wanted)}; word {n}: {both}")
    assert [(first, last) for _, first, last in outcome.words] == flags, start
    return early


def any_job(rng: random.Random, config: Config, width: int) -> dict[str, int]:
    """An acceptable job's fields: every slot, window, direction, step and limit, most of them near what matters.

    Args:
        rng: for the choice.
        config: of the board.
        width: of the image, pixels.
    """
    most = config.dense_offsets
    offsets = rng.choice((1, 2, most, rng.randint(1, most)))
    window = rng.choice(config.dense_windows)
    near = rng.choice((1 - most, -most, -most - 1, -most - config.group_bits, 1 - width - most, width - 1, width))
    steps = [rng.choice((1, 1, 2, 3, rng.randint(1, width), STEP_MAX)) for _ in range(2)]
    return {"left_slot": rng.randrange(config.slots), "right_slot": rng.randrange(config.slots), "window": window,
            "offsets": offsets, "check": rng.getrandbits(1), "live": 0,
            "start": rng.choice((0, 1 - offsets, rng.randint(-12, 12), rng.randint(-width, width), near, -512, 511)),
            "down": rng.choice((0, 0, 1, -1, rng.randint(-9, 9), rng.randint(-40, 40), -512, 511)),
            "step_x": min(STEP_MAX, steps[0]), "step_y": min(STEP_MAX, steps[1]),
            "most": rng.choice((NO_SUM, 0, rng.randint(0, window * window // 2))),
            "margin": rng.choice((0, 1, rng.randint(0, window * window // 4), NO_SUM))}


def bad_job(rng: random.Random, config: Config, width: int) -> dict[str, int]:
    """A job that is refused for one reason or several."""
    wrong = {"window": rng.choice((0, 2, 2 * config.dense_window % 64, 5)),
             "offsets": rng.choice((0, config.dense_offsets + 1, 511)), "left_slot": rng.randint(config.slots, 7),
             "right_slot": rng.randint(config.slots, 7), "step_x": 0, "step_y": 0}
    chosen = rng.sample(list(wrong), rng.choice((1, 1, 2, 3)))
    return {**any_job(rng, config, width), **{name: wrong[name] for name in chosen}}


@dataclass
class DenseBlockTraffic:
    """One start after another; the ports carry anything where the block does not look at them.

    Attributes:
        starts: what is started.
        config: of the board.
        rng: for stalls, pauses and what the ports carry.
        outcomes: of the starts so far.
        pushed: starts while the block was busy, which it ignores.
    """

    starts: list[Start]
    config: Config
    rng: random.Random
    outcomes: list[PassOutcome] = field(default_factory=list)
    pushed: int = 0

    def __post_init__(self) -> None:
        self.flight: deque[int | None] = deque([None] * STORE_LATENCY)
        self.memory: list[int] = []
        self.cameras: Arrivals | None = None

    def stimulus(self) -> Stimulus:
        """Every start in turn, and a few clocks after it."""
        for start in self.starts:
            self._fill(start)
            self.outcomes.append(outcome := PassOutcome())
            valid = sum(1 << slot for slot in start.planes)
            first = {"start_i": 1, "job_i": pack_start(start.job), "image_width_i": start.size[0],
                     "image_height_i": start.size[1], "slot_valid_i": valid}
            sink, at, done = ready_pattern(start.sink, self.rng), 0, False
            for _ in range(start.before):
                yield from self._clock({**self._noise(), "start_i": 0})
            while not done:
                now: Inputs = {**self._noise(), **(first if at == 0 else {"slot_valid_i": valid} if at == 2 else {}),
                               "map_tready_i": next(sink), "cancel_i": int(at == start.cancel),
                               "rst_i": int(at == start.reset), "clear_i": int(at == start.clear)}
                if self.cameras and at == 1:
                    outcome.planes = {} if start.clear == 1 else self.cameras.searched()
                out = yield from self._clock(now)
                self.pushed += at > 0 and now["start_i"]
                self._observe(outcome, now, out)
                done = bool(or_zero(out["done_o"])) or now["rst_i"] == 1
                at += 1
                assert at < LONGEST, f"hangs: {start}"
            for _ in range(self.rng.choice((0, 0, 1, 9))):
                yield from self._clock({**self._noise(), "start_i": 0})

    def _clock(self, now: Inputs) -> Generator[Inputs, Outputs, Outputs]:
        """A clock with the store's answer; returns what the block shows."""
        word = self.flight.popleft()
        if self.cameras:
            now = {**now, "progress_i": self.cameras.progress(), "slot_valid_i": self.cameras.valid}
        out = yield {**now, "rd_data_i": self.rng.getrandbits(self.config.group_bits) if word is None else word}
        self.flight.append(self.memory[or_zero(out["rd_addr_o"])] if or_zero(out["rd_valid_o"]) else None)
        if self.cameras:
            self.cameras.step(or_zero(out["slot_busy_o"]))
        return out

    def _fill(self, start: Start) -> None:
        """Put the start's planes into the store, and anything elsewhere."""
        bits, words = self.config.group_bits, self.config.slot_words
        self.memory = [self.rng.getrandbits(bits) for _ in range(self.config.store_words)]
        asked = {one.slot for one in start.requests if one}
        held = {slot: plane for slot, plane in start.planes.items() if slot not in asked} | dict(start.old)
        for slot, plane in held.items():
            self.memory[slot * words:(slot + 1) * words] = plane_words(plane, self.config)
        self.cameras = None
        if start.job["live"]:
            others = {slot: 1 - plane for slot, plane in start.planes.items()}
            self.cameras = Arrivals(start.requests, start.planes, others, held, self._write, self.rng)

    def _write(self, slot: int, row: int, plane: Plane) -> None:
        """Write a row of a plane into a slot."""
        per, begin = self.config.words_per_row, slot * self.config.slot_words + row * self.config.words_per_row
        self.memory[begin:begin + per] = plane_words(plane, self.config)[row * per:(row + 1) * per]

    def _noise(self) -> Inputs:
        """Ports of a clock in which none of them counts."""
        return {"rst_i": 0, "cancel_i": 0, "start_i": int(self.rng.random() < 0.02),
                "job_i": self.rng.getrandbits(DENSE_JOB.bits), "image_width_i": self.rng.getrandbits(10),
                "image_height_i": self.rng.getrandbits(10), "slot_valid_i": self.rng.getrandbits(8),
                "progress_i": self.rng.getrandbits(2 * PROGRESS.bits), "clear_i": int(self.rng.random() < 0.02),
                "map_tready_i": self.rng.getrandbits(1)}

    @staticmethod
    def _observe(outcome: PassOutcome, now: Inputs, out: Outputs) -> None:
        """Count, and take a word of the map."""
        outcome.clocks += 1
        outcome.rows += or_zero(out["row_o"])
        outcome.stalls += or_zero(out["stall_o"])
        if or_zero(out["map_tvalid_o"]) and now["map_tready_i"]:
            outcome.words.append((out["map_tdata_o"], out["map_tuser_o"], out["map_tlast_o"]))
        if or_zero(out["done_o"]):
            outcome.status = out["status_o"]
