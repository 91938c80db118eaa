# SPDX-License-Identifier: Apache-2.0
"""`slog_capture` against its cycle model on every clock."""

import itertools
import random
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

import cocotb
import pytest

from cocotb_tests.env.check import check_cycles
from cocotb_tests.env.params import params
from golden.cycle.model import Inputs, Outputs, Stimulus
from golden.cycle.store.capture import CaptureModel
from golden.cycle.store.capture_channel import HOPS, PROGRESS
from golden.traffic.lasting import lasting
from sim.coverage.record import met
from sim.testbench.runner import simulate

CLOCKS = 3000
WRITTEN = 2
"""Clocks after a row is counted in which its last word is at the store's write port at the latest."""
QUEUED = 4
"""Words that a camera's queue holds."""


@dataclass
class _Wire:
    """One camera's front-end outputs in a clock."""

    valid: int = 0
    data: int = 0
    last: int = 0
    start: int = 0
    done: int = 0
    abort: int = 0


@dataclass
class _Counts:
    """Events of a run, and what was written by address."""

    captures: int = 0
    aborted: int = 0
    refused: int = 0
    given_up: int = 0
    both: int = 0
    rows: int = 0
    memory: dict[int, int] = field(default_factory=dict)

    def enough(self, cameras: int) -> bool:
        """Whether each event was met so often that a fault in it would be seen."""
        return (self.captures >= 4 and self.rows >= 12 and self.aborted >= 2 and self.refused >= 12
                and self.given_up >= 1 and (cameras == 1 or self.both >= 1))


def _camera(rng: random.Random, rows: int, words: int, bits: int, tight: bool) -> Iterator[_Wire]:
    """Endless frames of `rows` x 1..`words` words; four in ten aborted half-way.

    Tight: only the pauses of the narrowest image, two words together at the end of a row, then eight clocks.
    """
    while True:
        for _ in range(0 if tight else rng.randrange(60)):
            yield _Wire(data=rng.getrandbits(bits))
        yield _Wire(start=1)
        across = rng.randint(1, words)
        total = rows * across
        stop = rng.randrange(total) if rng.random() < 0.4 else None
        for _ in range(6 if tight else rng.randrange(6, 20)):
            yield _Wire(data=rng.getrandbits(bits))
        for k in range(total):
            if k == stop:
                yield _Wire(abort=1)
                break
            end = k % across == across - 1
            final = k == total - 1
            together = final and rng.random() < 0.5
            yield _Wire(1, rng.getrandbits(bits), int(end), done=int(together))
            if final and not together:
                yield _Wire(done=1)
            if k % across != across - 2:
                for _ in range(7 if tight else rng.randrange(1, 9)):
                    yield _Wire(data=rng.getrandbits(bits))


def _frames_and_commands(rng: random.Random, p: dict[str, int], tight: bool, resets: bool, seen: _Counts) -> Stimulus:
    """Frames on every camera, commands good and bad, busy slots, for as long as `seen` wants events."""
    cameras, bits = p["Cameras"], p["GroupBits"]
    rows = p["SlotWords"] // p["WordsPerRow"]
    feeds = [_camera(rng, rows, p["WordsPerRow"], bits, tight) for _ in range(cameras)]
    busy = 0
    out: Outputs = {"writing_o": 0}
    for t in lasting(CLOCKS, 8 * CLOCKS, lambda: seen.enough(cameras)):
        wires = [next(f) for f in feeds]
        if rng.random() < 0.05:
            busy = rng.getrandbits(8) & rng.getrandbits(8)
        pack = {name: sum(getattr(w, name) << c for c, w in enumerate(wires))
                for name in ("valid", "last", "start", "done", "abort")}
        out = yield {
            "rst_i": int(resets and t % 911 == 910), "cmd_valid_i": int(rng.random() < 0.04),
            "cmd_cancel_i": int(rng.random() < 0.1), "cmd_camera_i": rng.getrandbits(1),
            "cmd_slot_i": rng.getrandbits(3), "clear_i": int(rng.random() < 0.002 and not out["writing_o"]),
            "slot_busy_i": busy, "word_valid_i": pack["valid"],
            "word_data_i": sum(w.data << c * bits for c, w in enumerate(wires)), "word_last_i": pack["last"],
            "frame_start_i": pack["start"], "frame_done_i": pack["done"], "frame_abort_i": pack["abort"]}


@cocotb.test()
@cocotb.parametrize(tight=[False, True], resets=[False, True])
async def every_clock(dut, tight: bool, resets: bool) -> None:
    p = params()
    rng = random.Random(cocotb.RANDOM_SEED)
    model = CaptureModel(p["Cameras"], p["GroupBits"], p["Slots"], p["SlotWords"], p["WordsPerRow"])
    seen = _Counts()
    # Per camera: words by place in the slot.
    frames: list[dict[int, int]] = [{} for _ in range(p["Cameras"])]
    whole: list[dict[int, int]] = [{} for _ in range(p["Cameras"])]
    place = [0] * p["Cameras"]
    before = {"writing_o": 0, "armed_o": 0}
    commands = deque([0, 0], 2)
    counted = [0] * p["Cameras"]
    # Rows counted in the last clocks, the latest first: slot, their number, words of the frame.
    due: deque[list[tuple[int, int, dict[int, int]]]] = deque([[] for _ in range(WRITTEN)], WRITTEN)

    def follow(out: Outputs) -> None:
        """What is counted is in the store WRITTEN clocks later."""
        for slot, rows, words in due.pop():
            for k in (k for k in words if k < rows * p["WordsPerRow"]):
                assert seen.memory.get(slot * p["SlotWords"] + k) == words[k], f"word {k} of slot {slot}, {rows} rows"
        now = []
        for c in range(p["Cameras"]):
            told = PROGRESS.unpack(out["progress_o"] >> PROGRESS.bits * c)
            if told["writing"] and told["rows"] != counted[c]:
                assert told["rows"] > counted[c]
                now.append((told["slot"], told["rows"], frames[c]))
                seen.rows += 1
            if told["done"]:
                assert told["rows"] * p["WordsPerRow"] == p["SlotWords"]
            counted[c] = told["rows"] if told["writing"] else 0
        due.appendleft(now)

    def watch(i: Inputs, out: Outputs) -> None:
        """A slot that becomes valid must hold exactly the words of the frame its camera finished last."""
        if out["wr_valid_o"]:
            seen.memory[out["wr_addr_o"]] = out["wr_data_o"]
        follow(out)
        if i["rst_i"]:  # what is on its way is lost
            due.extend([[] for _ in range(WRITTEN)])
        for c in range(p["Cameras"]):
            if i["frame_start_i"] >> c & 1:
                frames[c], place[c] = {}, 0
            if i["word_valid_i"] >> c & 1:
                frames[c][place[c]] = i["word_data_i"] >> c * p["GroupBits"] & (1 << p["GroupBits"]) - 1
                place[c] += 1
                if i["word_last_i"] >> c & 1:
                    place[c] = -(-place[c] // p["WordsPerRow"]) * p["WordsPerRow"]
            if i["frame_done_i"] >> c & 1:
                whole[c] = frames[c]
            seen.aborted += i["frame_abort_i"] >> c & 1 and out["writing_o"] >> c & 1
        fell = before["writing_o"] & ~out["writing_o"]
        if out["done_o"]:
            ended = fell & before["armed_o"] & ~out["armed_o"]
            done = [c for c in range(p["Cameras"]) if ended >> c & 1]
            for c in done:
                slot = model.channels[c].slot
                base = slot * p["SlotWords"]
                stored = {k: seen.memory.get(base + k) for k in whole[c]}
                if not commands[0]:  # otherwise the channel may already hold another slot
                    assert stored == whole[c], f"slot {slot} does not hold camera {c}'s frame"
                    seen.captures += 1
            seen.both += out["writing_o"] != 0
        seen.given_up += bool(fell & out["armed_o"])
        seen.refused += out["refused_o"]
        before.update(writing_o=out["writing_o"], armed_o=out["armed_o"])
        commands.append(i["cmd_valid_i"])

    assert await check_cycles(dut, model, _frames_and_commands(rng, p, tight, resets, seen), watch) >= CLOCKS
    met("captures", {"frame kept": seen.captures, "row counted": seen.rows, "frame aborted": seen.aborted,
                     "request refused": seen.refused, "gave way to a job": seen.given_up,
                     "both cameras write": seen.both * (p["Cameras"] == 2)})
    assert seen.enough(p["Cameras"]), seen


@cocotb.test()
async def commands_in_consecutive_clocks(dut) -> None:
    """A command sees the effect of the command in the clock before: a slot is never given to both cameras."""
    p = params()
    rng = random.Random(cocotb.RANDOM_SEED)
    model = CaptureModel(p["Cameras"], p["GroupBits"], p["Slots"], p["SlotWords"], p["WordsPerRow"])
    taken, freed = 0, 0

    def stimulus() -> Stimulus:
        nonlocal taken, freed
        other = 0
        for _ in range(60):
            # Camera 0 moves its request from one slot to another; in the next clock camera 1 asks for one of the two.
            before, after = rng.sample(range(3), 2)
            wanted = rng.choice((before, after))
            for camera, slot, cancel in ((0, before, 0), (1, 0, 1), (0, after, 0), (1, wanted, 0)):
                yield {"cmd_valid_i": 1, "cmd_camera_i": camera ^ other, "cmd_slot_i": slot, "cmd_cancel_i": cancel}
            yield {}
            out = yield {}  # of the last command
            if p["Cameras"] == 2:
                assert out["refused_o"] == (wanted == after)
            taken += wanted == after
            freed += wanted == before
            for camera in (0, 1):
                yield {"cmd_valid_i": 1, "cmd_camera_i": camera, "cmd_cancel_i": 1}
            other ^= 1

    await check_cycles(dut, model, stimulus())
    met("captures", {"slot taken in the clock before": taken, "slot freed in the clock before": freed})
    assert taken > 10 and freed > 10


def _burst(p: dict[str, int]) -> Stimulus:
    """One frame of single words, 12 clocks apart, into slot 1 of an idle unit."""
    yield {"cmd_valid_i": 1, "cmd_slot_i": 1}
    yield {}
    yield {}
    yield {"frame_start_i": 1}
    for _ in range(8):
        yield {}
    for k in range(p["SlotWords"]):
        yield {"word_valid_i": 1, "word_data_i": k, "word_last_i": int((k + 1) % p["WordsPerRow"] == 0)}
        for _ in range(11):
            yield {}
    yield {"frame_done_i": 1}
    for _ in range(5 + HOPS):
        yield {}


@cocotb.test()
async def latency(dut) -> None:
    """Word to store write takes seven clocks; the slot is valid seven clocks after frame_done_i."""
    p = params()
    model = CaptureModel(p["Cameras"], p["GroupBits"], p["Slots"], p["SlotWords"], p["WordsPerRow"])
    words, writes, marks = [], [], {}
    clocks = itertools.count()

    def watch(i: Inputs, out: Outputs) -> None:
        t = next(clocks)
        if i["word_valid_i"]:
            words.append(t)
        if out["wr_valid_o"]:
            writes.append((t, out["wr_addr_o"], out["wr_data_o"]))
        if i["frame_done_i"]:
            marks["done"] = t
        if out["slot_valid_o"]:
            marks.setdefault("valid", t)

    await check_cycles(dut, model, _burst(p), watch)
    assert [t - w for (t, _, _), w in zip(writes, words, strict=True)] == [5 + HOPS] * p["SlotWords"]
    assert [(a, d) for _, a, d in writes] == [(p["SlotWords"] + k, k) for k in range(p["SlotWords"])]
    assert marks["valid"] - marks["done"] == 5 + HOPS


@cocotb.test()
async def second_queue_full(dut) -> None:
    """Both cameras bring as many words as a queue holds in consecutive clocks: the second's wait, none is lost."""
    p = params()
    base = p["SlotWords"], 2 * p["SlotWords"]
    both = (1 << p["Cameras"]) - 1
    writes: list[tuple[int, int]] = []

    def stimulus() -> Stimulus:
        for camera in range(p["Cameras"]):
            yield {"cmd_valid_i": 1, "cmd_camera_i": camera, "cmd_slot_i": 1 + camera}
        for _ in range(4):
            yield {}
        yield {"frame_start_i": both}
        for _ in range(8):
            yield {}
        for k in range(p["SlotWords"]):
            column = k % p["WordsPerRow"]
            data = sum(128 * c + k << c * p["GroupBits"] for c in range(p["Cameras"]))
            yield {"word_valid_i": both, "word_data_i": data,
                   "word_last_i": both * (column == p["WordsPerRow"] - 1)}
            for _ in range(12 if column >= QUEUED - 1 else 0):
                yield {}
        yield {"frame_done_i": both}
        for _ in range(10):
            out = yield {}
        assert out["slot_valid_o"] == both << 1

    def watch(_: Inputs, out: Outputs) -> None:
        if out["wr_valid_o"]:
            writes.append((out["wr_addr_o"] or 0, out["wr_data_o"] or 0))

    model = CaptureModel(p["Cameras"], p["GroupBits"], p["Slots"], p["SlotWords"], p["WordsPerRow"])
    await check_cycles(dut, model, stimulus(), watch)
    first, second = ([(base[c] + k, 128 * c + k) for k in range(p["SlotWords"])] for c in range(2))
    assert sorted(writes) == (first + second)[:p["Cameras"] * p["SlotWords"]]
    if p["Cameras"] == 2:
        assert writes[:2 * QUEUED] == first[:QUEUED] + second[:QUEUED]


@pytest.mark.parametrize("cameras", [2, 1])
def test_capture(cameras: int) -> None:
    simulate("slog_capture", __name__,
             {"Cameras": cameras, "GroupBits": 8, "Slots": 6, "SlotWords": 15, "WordsPerRow": 5,
              "Progress": 1})
