# SPDX-License-Identifier: Apache-2.0
"""The Board interface to the dense engine on the golden board: winners of captured slots, refused calls."""

from dataclasses import replace

import numpy as np
import pytest

from golden.compiled.calls import CHOICE, NUMPY
from golden.correlate import Job
from golden.dense import DensePass
from golden.dense_job import DenseJob, run_dense
from golden.params import DENSE, TINY, TINY_DENSE
from golden.tables import jobs_table
from signum.boards.board import BoardError, run_table
from signum.boards.golden import GoldenBoard, dense_clocks

JOB = DenseJob(0, 1, DensePass(8, 12, -4, 2), step=(2, 3), most=30, margin=2, check=True)


@pytest.fixture(params=["", NUMPY])
def board(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> GoldenBoard:
    """A tiny board with the engine, compiled and in NumPy: slot 1 holds the frame of slot 0 moved by (3, 2) px."""
    monkeypatch.setenv(CHOICE, request.param)
    scene = np.random.default_rng(5).integers(0, 256, (50, 60), dtype=np.uint8)
    made = GoldenBoard(TINY_DENSE)
    made.configure((48, 36), 1.5)
    made.capture_pair((0, 1), (scene[8:44, 7:55], scene[10:46, 10:58]))
    return made


def test_every_pixel_finds_the_shift(board: GoldenBoard) -> None:
    result = board.dense(JOB)
    assert result.valid.sum() > 0.5 * result.valid.size and (result.index[result.valid] - 4 == 3).all()
    expected = run_dense(JOB, {slot: board.read_plane(slot) for slot in (0, 1)}, TINY_DENSE, (48, 36))[1]
    assert expected is not None
    for name, values in vars(expected).items():
        assert np.array_equal(values, getattr(result, name)), name
        assert values.dtype == getattr(result, name).dtype


def test_a_pair_is_captured_and_searched_in_one_call(board: GoldenBoard) -> None:
    """The result of two calls, in fewer clocks than they take, and the slots hold the frames."""
    before = board.clocks
    wanted, (left, right) = board.dense(JOB), (board.read_plane(0), board.read_plane(1))
    scene = np.random.default_rng(5).integers(0, 256, (50, 60), dtype=np.uint8)
    frames = scene[8:44, 7:55], scene[10:46, 10:58]
    passed, busy = board.clocks - before, board.counters()["busy_clocks"]
    found = board.capture_dense(replace(JOB, left=2, right=0), frames)
    for name, values in vars(wanted).items():
        assert np.array_equal(values, getattr(found, name)), name
    assert np.array_equal(board.read_plane(2), left) and np.array_equal(board.read_plane(0), right)
    taken = board.clocks - before - passed
    assert passed < taken == board.counters()["busy_clocks"] - busy
    board.capture_pair((2, 0), frames)
    assert taken < board.clocks - before - taken
    with pytest.raises(BoardError, match="two different slots"):
        board.capture_dense(replace(JOB, right=0), frames)
    with pytest.raises(BoardError, match="no dense engine"):
        GoldenBoard(TINY).capture_dense(JOB, frames)
    with pytest.raises(BoardError, match="expected uint8"):
        board.capture_dense(JOB, (frames[0], frames[1][1:]))
    with pytest.raises(BoardError, match="dense job refused: BAD_STEP"):
        board.capture_dense(replace(JOB, step=(0, 1)), frames)
    board.read_plane(1)


def test_clocks_of_a_pass() -> None:
    """One pixel a clock but for the gap between rows: 95 % of the clocks and more yield a pixel."""
    clocks = dense_clocks(DenseJob(0, 1, DensePass(32, 128)), DENSE, (640, 480))
    assert 640 * 480 <= clocks <= 640 * 480 / 0.95
    assert dense_clocks(DenseJob(0, 1, DensePass(32, 128), step=(1, 4)), DENSE, (640, 480)) < clocks


def test_a_pass_is_counted_and_a_refused_one_is_not(board: GoldenBoard) -> None:
    before = board.clocks, board.counters()["busy_clocks"]
    board.dense(JOB)
    taken = dense_clocks(JOB, TINY_DENSE, (48, 36))
    assert (board.clocks, board.counters()["busy_clocks"]) == (before[0] + taken, before[1] + taken)
    with pytest.raises(BoardError, match="BAD_SLOT"):
        board.dense(replace(JOB, right=2))
    assert board.clocks == before[0] + taken


@pytest.mark.parametrize(("change", "message"), [
    ({"search": DensePass(16, 4)}, "BAD_WINDOW"), ({"search": DensePass(8, 17)}, "BAD_OFFSETS"),
    ({"right": 2}, "BAD_SLOT"), ({"left": 7}, "BAD_SLOT"), ({"step": (0, 1)}, "BAD_STEP")])
def test_refused_jobs(board: GoldenBoard, change: dict[str, object], message: str) -> None:
    with pytest.raises(BoardError, match=f"dense job refused: {message}"):
        board.dense(replace(JOB, **change))  # type: ignore[arg-type]


def test_a_board_that_was_not_configured_says_so() -> None:
    with pytest.raises(BoardError, match="choose image size and filter with configure"):
        GoldenBoard(TINY_DENSE).dense(JOB)


def test_slots_of_another_size_are_refused(board: GoldenBoard) -> None:
    board.configure((40, 30), 1.5)
    with pytest.raises(BoardError, match="slot 0 was captured at another image size"):
        board.dense(JOB)


def test_what_the_build_has_not_is_refused_in_one_line(board: GoldenBoard) -> None:
    with pytest.raises(BoardError, match=r"^this board has no dense engine: use the configuration dense$"):
        GoldenBoard(TINY).dense(JOB)
    job = Job(0, 16, 12, 12, 12, 1, 12, 8, 9, 9)
    for call in (lambda: board.submit([job]), lambda: board.submit_grid(job, (1, 1), (1, 1)),
                 lambda: board.surface(job), lambda: run_table(board, jobs_table([job]))):
        with pytest.raises(BoardError, match=r"^this board has no array for single windows"):
            call()
