# SPDX-License-Identifier: Apache-2.0
"""The Board interface on the golden board: calls, refused calls, counters."""

from dataclasses import replace

import numpy as np
import pytest

from golden import correlate, log
from golden.compiled.calls import CHOICE, NUMPY, Kernel, Packed
from golden.correlate import Job, Status
from golden.log import Image
from golden.params import FULL, TINY
from golden.tables import jobs_table
from signum.boards.board import BoardError, Identification, run_jobs
from signum.boards.golden import REGISTER_VERSION, SEEN, GoldenBoard, job_clocks


@pytest.fixture(params=["", NUMPY])
def board(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> GoldenBoard:
    """A tiny board, compiled and in NumPy, with a frame in slot 0 and the same one shifted by (3, 2) in slot 1."""
    monkeypatch.setenv(CHOICE, request.param)
    rng = np.random.default_rng(5)
    scene = rng.integers(0, 256, (50, 60), dtype=np.uint8)
    made = GoldenBoard(TINY)
    made.configure((48, 36), 1.5)
    made.capture(0, scene[10:46, 10:58])
    made.capture(1, scene[8:44, 7:55])
    return made


JOB = Job(0, 16, 12, 12, 12, 1, 12, 8, 9, 9, tag=7)


def test_finds_the_shift_and_reads_planes(board: GoldenBoard) -> None:
    (result,) = run_jobs(board, [JOB])
    assert (result.status, result.tag) == (Status.OK, 7)
    assert (12 + result.best_x - 16, 8 + result.best_y - 12) == (3, 2)
    full, surface = board.surface(replace(JOB, surface=True))
    assert full == result and surface.shape == (9, 9) and surface.max() == result.score
    rng = np.random.default_rng(5)
    frame = rng.integers(0, 256, (50, 60), dtype=np.uint8)[10:46, 10:58]
    assert np.array_equal(board.read_plane(0), log.sign(frame, 1.5, TINY.radius))


def test_grid_is_its_jobs(board: GoldenBoard) -> None:
    first = replace(JOB, tpl_x=4, search_x=0)
    board.submit_grid(first, (3, 2), (6, 4))
    assert board.outstanding == 6
    assert board.collect(6) == run_jobs(board, correlate.grid(first, (3, 2), (6, 4)))


def test_refused_jobs_answer_with_their_status(board: GoldenBoard) -> None:
    bad = [replace(JOB, width=17), replace(JOB, offsets_x=0), replace(JOB, tpl_slot=3), replace(JOB, search_x=40)]
    assert [r.status for r in run_jobs(board, bad)] == [
        Status.BAD_WINDOW, Status.NO_OFFSETS, Status.BAD_SLOT, Status.OUTSIDE]
    assert board.counters()["refused"] == 4
    with pytest.raises(BoardError, match="refused"):
        board.surface(bad[3])


def test_counters_and_clocks(board: GoldenBoard) -> None:
    before = board.clocks
    run_jobs(board, [JOB] * 5)
    counts = board.counters()
    assert (counts["frames_0"], counts["drops_0"], counts["jobs"], counts["scores"]) == (2, 0, 5, 5 * 81)
    assert board.clocks - before == counts["busy_clocks"] == 5 * job_clocks(jobs_table([JOB]), TINY)[0]


def test_clocks_of_the_reference_search() -> None:
    job = Job(0, 288, 208, 64, 64, 1, 256, 176, 65, 65)
    assert 65 * 65 <= job_clocks(jobs_table([job]), FULL)[0] <= 65 * 65 / 0.9


def test_bad_calls(board: GoldenBoard) -> None:
    frame = np.zeros((36, 48), np.uint8)
    for call in (lambda: board.capture(6, frame), lambda: board.capture(0, frame[:-1]),
                 lambda: board.capture(0, frame, camera=2), lambda: board.capture_pair((1, 1), (frame, frame)),
                 lambda: board.configure((48, 36), 0.5), lambda: board.configure((49, 36), 1.5),
                 lambda: board.collect(1),
                 lambda: board.read_plane(5), lambda: board.submit([replace(JOB, surface=True)]),
                 lambda: GoldenBoard(TINY).capture(0, frame)):
        with pytest.raises(BoardError):
            call()


def test_another_size_empties_the_slots(board: GoldenBoard) -> None:
    board.configure((40, 36), 1.5)
    with pytest.raises(BoardError, match="another image size"):
        board.submit([JOB])
    board.capture_pair((0, 1), (np.zeros((36, 40), np.uint8), np.zeros((36, 40), np.uint8)))
    assert run_jobs(board, [JOB])[0].score == 144
    assert board.counters()["frames_1"] == 1


def test_slots_of_another_size_stay_unusable_when_the_size_comes_back(board: GoldenBoard) -> None:
    board.configure((40, 36), 1.5)
    board.configure((48, 36), 1.5)
    with pytest.raises(BoardError, match="holds no frame"):
        board.read_plane(0)
    with pytest.raises(BoardError, match="another image size"):
        board.submit([JOB])


def test_another_sigma_leaves_the_slots(board: GoldenBoard) -> None:
    plane = board.read_plane(0)
    board.configure((48, 36), 2.5)
    assert board.sigma == 2.5 and np.array_equal(board.read_plane(0), plane)


@pytest.mark.parametrize(("slot", "camera"), [(0.5, 0), ("a", 0), (0, 1.0)])
def test_slots_and_cameras_are_whole_numbers(board: GoldenBoard, slot: int, camera: int) -> None:
    with pytest.raises(BoardError, match="both must be whole numbers"):
        board.capture(slot, np.zeros((36, 48), np.uint8), camera)


@pytest.mark.parametrize(("size", "sigma", "says"), [
    ((40, 36), 0.5, "sigma 0.5"), ((49, 36), 2.0, "image size 49x36"), ((40, 36), 4.5, "sigma 4.5")])
def test_a_refused_configuration_changes_nothing(board: GoldenBoard, size: tuple[int, int], sigma: float, says: str,
                                                 ) -> None:
    plane = board.read_plane(0)
    with pytest.raises(BoardError, match=says):
        board.configure(size, sigma)
    assert (board.image_size, board.sigma, board.configurations) == ((48, 36), 1.5, 1)
    assert np.array_equal(board.read_plane(0), plane)


def test_the_size_does_not_change_under_outstanding_results(board: GoldenBoard) -> None:
    board.submit([JOB])
    board.configure((48, 36), 2.5)
    with pytest.raises(BoardError, match="outstanding"):
        board.configure((40, 36), 2.5)
    assert board.collect(1)[0].status is Status.OK


def test_identification_is_that_of_the_build(board: GoldenBoard) -> None:
    assert board.identification == Identification("golden", "tiny", REGISTER_VERSION, 2, TINY.slots, (48, 36), 16)


def test_a_slot_of_outstanding_jobs_is_not_captured_into(board: GoldenBoard) -> None:
    """A slot is free when the last result of a job that names it is collected; grids and refused jobs count."""
    frame = np.zeros((36, 48), np.uint8)
    plane = board.read_plane(1)

    def held() -> list[int]:
        """Slots the board does not capture into."""
        found = []
        for slot in range(TINY.slots):
            try:
                board.capture(slot, frame)
            except BoardError as error:
                assert str(error) == (f"slot {slot} is named by jobs whose results are not collected: "
                                      "collect them first")
                found.append(slot)
        return found

    board.submit([JOB, replace(JOB, search_slot=0)])
    board.submit_grid(replace(JOB, tpl_slot=1, tpl_x=4, search_x=0), (3, 2), (6, 4))
    board.submit([replace(JOB, tpl_slot=3, search_slot=7), replace(JOB, tpl_slot=2, search_slot=2, width=17)])
    assert board.outstanding == 10
    assert held() == [0, 1, 2, 3]
    assert np.array_equal(board.read_plane(1), plane)
    with pytest.raises(BoardError, match="slot 1 is named by jobs"):
        board.capture_pair((4, 1), (frame, frame))
    board.collect(2)
    assert held() == [1, 2, 3]
    board.collect(5)
    assert held() == [1, 2, 3]
    board.collect(1)
    assert held() == [2, 3]
    assert board.collect(1)[0].status is Status.BAD_SLOT
    assert held() == [2]
    assert board.collect(1)[0].status is Status.BAD_WINDOW
    assert held() == [] and board.outstanding == 0
    board.surface(JOB)
    assert held() == []


def test_a_frame_seen_before_is_filtered_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless sigma or a pixel differs; the planes are those of the filter, also after more frames than are kept."""
    calls: list[float] = []
    sign = Kernel.sign

    def counted(kernel: Kernel, image: Image, sigma: float, radius: int) -> Packed:
        calls.append(sigma)
        return sign(kernel, image, sigma, radius)

    monkeypatch.setattr(Kernel, "sign", counted)
    monkeypatch.setenv(CHOICE, "plain")
    rng = np.random.default_rng(4)
    frames = [rng.integers(0, 256, (36, 48), dtype=np.uint8) for _ in range(SEEN + 1)]
    with GoldenBoard(TINY) as board:
        for sigma, frame, number in ((1.5, frames[0], 1), (1.5, frames[0].copy(), 1), (2.0, frames[0], 2),
                                     (1.5, frames[0], 2), (1.5, frames[1][::-1, ::-1], 3)):
            board.configure((48, 36), sigma)
            board.capture(3, frame)
            assert len(calls) == number
            assert np.array_equal(board.read_plane(3), log.sign(frame, sigma, TINY.radius))
        for frame in frames:
            board.capture(3, frame)
        assert len(calls) == 3 + SEEN and np.array_equal(board.read_plane(3), log.sign(frames[-1], 1.5, TINY.radius))
        board.capture(3, frames[0])
        assert len(calls) == 4 + SEEN
        assert board.counters()["frames_0"] == 6 + SEEN + 1


def test_a_kernel_that_there_is_not_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CHOICE, "mmx")
    with pytest.raises(BoardError, match="SIGNUM_KERNEL is mmx: this processor has numpy"):
        GoldenBoard(TINY)
