# SPDX-License-Identifier: Apache-2.0
"""Passes of the dense engine: golden and Verilated board give the same bits for the same calls, refused ones too."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseResult, DenseStatus
from golden.params import TINY_DENSE
from signum.boards.board import Board, BoardError
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from sim.board.dense import CANCELLED, LOST, DenseEngine, map_shape, unpack_map
from sim.board.device import Device, DeviceError, frame_beats
from sim.seeds import session_rng
from tests.boards.dense_scenes import random_pair, random_search

FIELDS = tuple(DenseResult.__dataclass_fields__)
PIXELS = 1_000_000
"""Pixels of which every field is compared."""
SIZE = TINY_DENSE.max_width, TINY_DENSE.max_height

Pair = tuple[GoldenBoard, VerilatedBoard]


@pytest.fixture
def boards() -> Iterator[Pair]:
    """Both boards of the small configuration with an engine."""
    with GoldenBoard(TINY_DENSE) as golden, VerilatedBoard(TINY_DENSE) as verilated:
        yield golden, verilated


def _same(results: list[DenseResult], job: DenseJob) -> int:
    """Compare every field of two results; the number of their pixels."""
    for name in FIELDS:
        ours, theirs = (getattr(result, name) for result in results)
        assert ours.dtype == theirs.dtype and np.array_equal(ours, theirs), f"{name} of {job}"
    return results[0].index.size


def test_a_million_pixels(boards: Pair) -> None:
    """Random frames and passes of every kind, some images smaller than the largest; both ends of the map's stream."""
    rng = session_rng("dense passes")
    compared = passes = 0
    met = dict.fromkeys(("found", "agrees", "valid"), 0)
    while compared < PIXELS:
        size = SIZE if rng.random() < 0.9 else (rng.randint(18, SIZE[0]), rng.randint(18, SIZE[1]))
        frames = random_pair(rng, size)
        boards[1]._device.pause_stream(rng.choice((0.0, 0.0, 0.4)), rng.getrandbits(30))
        for board in boards:
            board.configure(size, 1.5)
            board.capture_pair((0, 1), frames)
        for _ in range(12):
            job = DenseJob(*rng.choice(((0, 1), (1, 0), (0, 0))), random_search(rng, TINY_DENSE),
                           *rng.choice((((1, 1),), ((1, 1), 30, 2, True), ((3, 2), 12, 0, True))))
            results = [board.dense(job) for board in boards]
            compared += _same(results, job)
            passes += 1
            for name in met:
                met[name] += int(getattr(results[0], name).sum())
    assert passes > 500 and compared > met["found"] > met["agrees"] > 100_000 and met["valid"] > 100_000, met
    assert boards[1]._device.read("dense.irq_status.lost") == 0


@pytest.mark.parametrize("change", [
    {"search": DensePass(32, 4)}, {"search": DensePass(8, 17)}, {"left": 2}, {"right": 5}, {"step": (0, 1)},
    {"step": (1, 0)}])
def test_refusals_are_the_same(boards: Pair, change: dict[str, object]) -> None:
    job: DenseJob = replace(DenseJob(0, 1, DensePass(8, 16)), **change)  # type: ignore[arg-type]
    messages = []
    for board in boards:
        _prepare(board)
        with pytest.raises(BoardError, match="refused") as refused:
            board.dense(job)
        messages.append(str(refused.value))
        board.dense(DenseJob(0, 1, DensePass(4, 3)))  # and goes on
    assert messages[0] == messages[1]


def _prepare(board: Board) -> None:
    board.configure(SIZE, 1.5)
    board.capture_pair((0, 1), random_pair(session_rng("dense"), SIZE))


def test_counters_of_passes() -> None:
    """Rows and waiting clocks are counted, and a pass with a ready receiver waits for nothing and gives a pixel in
    nearly every clock of a row."""
    with VerilatedBoard(TINY_DENSE) as board:
        _prepare(board)
        job = DenseJob(0, 1, DensePass(8, 16))
        before = board.counters()["busy_clocks"]
        board.dense(job)
        device = board._device
        clocks = board.counters()["busy_clocks"] - before
        pitch = SIZE[0] + 2 * TINY_DENSE.dense_lanes + 1
        assert device.read("dense.rows.value") == SIZE[1] and device.read("dense.stalls.value") == 0
        assert SIZE[1] * pitch <= clocks < (SIZE[1] + 6) * pitch
        device.pause_stream(0.7, 3)
        board.dense(job)
        assert device.read("dense.rows.value") == 2 * SIZE[1] and device.read("dense.stalls.value") > SIZE[0]


def test_a_cancelled_pass_ends_and_the_next_is_whole() -> None:
    job = DenseJob(0, 1, DensePass(8, 16, -4))
    with VerilatedBoard(TINY_DENSE) as board:
        _prepare(board)
        device: Device = board._device
        engine = DenseEngine(device)
        engine.load(job)
        engine.go()
        while device.stream_waiting < 3 * SIZE[0]:
            device.tick(20)
        engine.cancel()
        words = device.map_words(SIZE[0] * SIZE[1])
        assert len(words) % SIZE[0] == 1 and 3 * SIZE[0] < len(words) < SIZE[0] * SIZE[1] // 2
        assert not engine.busy and engine.status == CANCELLED
        whole = board.dense(job)
        rows = len(words) // SIZE[0]
        early = unpack_map(words[:-1], (rows, SIZE[0]))
        for name in FIELDS:
            assert np.array_equal(getattr(early, name), getattr(whole, name)[:rows]), name


def test_live_passes_are_the_same(boards: Pair) -> None:
    """A pair captured and searched in one call, on both boards, as captured first and searched then; the frames stay
    for later passes. A refused job leaves the frames, too."""
    rng = session_rng("live passes")
    for board in boards:
        board.configure(SIZE, 1.5)
    for _ in range(25):
        frames, slots = random_pair(rng, SIZE), rng.choice(((0, 1), (1, 0), (2, 0), (1, 2)))
        job = DenseJob(*slots, random_search(rng, TINY_DENSE), *rng.choice((((1, 1),), ((3, 2), 12, 0, True))))
        boards[1]._device.pause_stream(rng.choice((0.0, 0.0, 0.4)), rng.getrandbits(30))
        _same([board.capture_dense(job, frames) for board in boards], job)
        later = [board.dense(replace(job, live=rng.random() < 0.5)) for board in boards]
        _same([later[0], boards[1].capture_dense(job, frames)], job)
        _same(later, job)
    messages = []
    for board in boards:
        with pytest.raises(BoardError, match="refused") as refused:
            board.capture_dense(replace(job, search=DensePass(8, 17)), frames)
        messages.append(str(refused.value))
    assert messages[0] == messages[1]
    _same([board.dense(job) for board in boards], job)
    assert boards[1]._device.read("dense.irq_status.lost") == 0


def test_slow_cameras_and_lost_frames() -> None:
    """The map waits for cameras that pause; one whose frame breaks off ends the pass, and the board goes on."""
    rng = session_rng("lost frames")
    job = DenseJob(0, 1, DensePass(8, 16, -4), live=True)
    with VerilatedBoard(TINY_DENSE) as board:
        board.configure(SIZE, 1.5)
        frames = random_pair(rng, SIZE)
        device: Device = board._device
        engine = DenseEngine(device)
        status, slow = engine.run_live(job, frames, pause=0.7, seed=rng.getrandbits(30))
        assert status is DenseStatus.OK and slow is not None
        board.capture_pair((0, 1), frames)
        _same([board.dense(replace(job, live=False)), slow], job)
        broken = frame_beats(frames[1])[:-SIZE[0] - 5]  # the next frame's first pixel ends it
        for slot in (0, 1):
            device.arm(slot, slot)
        engine.load(job)
        engine.go()
        device.play(frames[0], 0)
        device.play_beats(np.concatenate([broken, frame_beats(frames[1])]), 1)
        with pytest.raises(DeviceError, match="lost"):
            engine.collect(job)
        assert engine.status == LOST and not engine.busy
        device.finish_playing()
        device.disarm(1)
        _same([board.capture_dense(job, frames), slow], job)


def test_a_dropped_frame_ends_a_live_pass() -> None:
    """A frame of short lines never has a whole first row. The pass does not wait for another frame for ever, and leaves
    neither requests nor a pass that waits."""
    rng = session_rng("dropped frames")
    job = DenseJob(0, 1, DensePass(8, 16, -4), live=True)
    with VerilatedBoard(TINY_DENSE) as board:
        board.configure(SIZE, 1.5)
        frames = random_pair(rng, SIZE)
        engine = DenseEngine(board._device)
        with pytest.raises(DeviceError, match="dropped the frame of camera 1"):
            engine.run_live(job, (frames[0], frames[1][:, :-1]))
        assert not engine.busy
        live = board.capture_dense(job, frames)
        _same([board.dense(replace(job, live=False)), live], job)


def test_coarse_steps_and_maps_that_were_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """Words of a coarse step come many rows apart. After a pass that took too long the next one gets a map of its own,
    and no pass begins while one is under way."""
    rng = session_rng("coarse steps")
    coarse, other = (DenseJob(0, 1, DensePass(8, 16, start), (1, 35)) for start in (-4, 3))
    with VerilatedBoard(TINY_DENSE) as board, GoldenBoard(TINY_DENSE) as golden:
        frames = random_pair(rng, SIZE)
        for each in (board, golden):
            each.configure(SIZE, 1.5)
            each.capture_pair((0, 1), frames)
        device: Device = board._device
        _same([golden.dense(coarse), board.dense(coarse)], coarse)
        with monkeypatch.context() as short:
            short.setattr(device, "_frame_clocks", lambda: 200)
            with pytest.raises(BoardError, match="no progress"):
                board.dense(coarse)
        _same([golden.dense(other), board.dense(other)], other)
        engine = DenseEngine(device)
        engine.load(coarse)
        engine.go()
        with pytest.raises(BoardError, match="under way"):
            board.dense(other)
        engine.collect(coarse)
        _same([golden.dense(other), board.dense(other)], other)


def test_a_pair_is_two_frames(boards: Pair) -> None:
    """One frame or three are refused before anything is sent, by both boards with the same line."""
    rng = session_rng("pairs")
    frames = random_pair(rng, SIZE)
    job = DenseJob(0, 1, DensePass(8, 16))
    for wrong in (frames[:1], (*frames, frames[0])):
        for board in boards:
            board.configure(SIZE, 1.5)
            with pytest.raises(BoardError, match=f"two slots and two frames: 2 and {len(wrong)} given"):
                board.capture_dense(job, wrong)  # type: ignore[arg-type]
            with pytest.raises(BoardError, match=f"two slots and two frames: 2 and {len(wrong)} given"):
                board.capture_pair((0, 1), wrong)  # type: ignore[arg-type]
    for board in boards:
        with pytest.raises(BoardError, match="two slots and two frames: 1 and 2 given"):
            board.capture_pair((0,), frames)  # type: ignore[arg-type]


def test_map_words_are_checked() -> None:
    assert map_shape((48, 36), (5, 7)) == (6, 10)
    with pytest.raises(ValueError, match="bits that are not used"):
        unpack_map(np.full(4, 1 << 55, np.uint64), (2, 2))
    with pytest.raises(ValueError, match="reshape"):
        unpack_map(np.zeros(5, np.uint64), (2, 2))
