# SPDX-License-Identifier: Apache-2.0
"""Golden and Verilated board: the same bits for the same calls, from planes to tracks.

Frames and jobs of the lockstep tests depend on the run's seed; those of the bars (figure 8, tracks) do not.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice

import cv2
import numpy as np
import pytest
import skimage.data

from golden import correlate, log
from golden.correlate import Job, Result, Status
from golden.params import FULL, TINY, Config
from signum.boards.board import Board, BoardError, run_jobs
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.measure.measurer import Measurer
from signum.measure.track import Tracker, TrackPoint, TrackSettings
from signum.reproduce import figure8
from signum.reproduce.reference import SHARED
from signum.sources.open import open_source
from sim.board.device import Device, DeviceError, DeviceTimeout
from sim.seeds import session_rng, session_seed

Pair = tuple[GoldenBoard, VerilatedBoard]


@pytest.fixture(params=[TINY, FULL], ids=lambda c: c.name)
def boards(request: pytest.FixtureRequest) -> Iterator[Pair]:
    """Both boards of a configuration."""
    config: Config = request.param
    with GoldenBoard(config) as golden, VerilatedBoard(config) as verilated:
        yield golden, verilated


def _frames(size: tuple[int, int], count: int, seed: int = 0) -> list[Image]:
    """Crops of a photograph wandering over it, with noise."""
    rng = np.random.default_rng(seed)
    gravel: Image = skimage.data.gravel()
    photo = cv2.resize(gravel, (max(size[0] + 120, 512), max(size[1] + 120, 512)))
    frames = []
    for n in range(count):
        x, y = 20 + 5 * n, 30 + 3 * n
        crop = photo[y:y + size[1], x:x + size[0]].astype(np.float64) + rng.normal(0, 8, size[::-1])
        frames.append(np.clip(crop, 0, 255).astype(np.uint8))
    return frames


def _jobs(config: Config, size: tuple[int, int], count: int, seed: int) -> list[Job]:
    """Random jobs over slots 0 to 2, mostly acceptable ones."""
    rng = np.random.default_rng(seed)
    jobs = []
    for n in range(count):
        w, h = (int(v) for v in rng.integers(config.min_window, config.max_window + 1, 2))
        nx, ny = (int(min(v, limit)) for v, limit in zip(rng.integers(1, 40, 2), (size[0] - w + 1, size[1] - h + 1),
                                                         strict=True))
        job = Job(int(rng.integers(3)), int(rng.integers(size[0] - w + 1)), int(rng.integers(size[1] - h + 1)), w, h,
                  int(rng.integers(3)), int(rng.integers(size[0] - w - nx + 2)),
                  int(rng.integers(size[1] - h - ny + 2)), nx, ny, n)
        if n % 10 == 9:
            job = (replace(job, width=config.max_window + 1), replace(job, offsets_y=0), replace(job, search_slot=5),
                   replace(job, search_x=size[0] - w + 1))[n // 10 % 4]
        jobs.append(job)
    return jobs


def _prepare(board: Board, size: tuple[int, int], sigma: float, frames: list[Image]) -> None:
    board.configure(size, sigma)
    board.capture(0, frames[0])
    board.capture_pair((1, 2), (frames[1], frames[2]))


def test_identification(boards: Pair) -> None:
    """The registers hold the values of the configuration."""
    golden, verilated = (board.identification for board in boards)
    assert golden.board == "golden" and verilated == replace(golden, board="verilated")


def test_planes_results_and_surfaces(boards: Pair) -> None:
    config = boards[0].config
    size = (47, 33) if config is TINY else (300, 201)
    frames = _frames(size, 3, seed=session_seed())
    count = 60 if config is TINY else 40
    for sigma in (1.0, 2.3):
        for board in boards:
            _prepare(board, size, sigma, frames)
        for slot in range(3):
            assert np.array_equal(boards[0].read_plane(slot), boards[1].read_plane(slot))
        jobs = _jobs(config, size, count, seed=session_seed() + int(10 * sigma))
        results = [run_jobs(board, jobs) for board in boards]
        assert results[0] == results[1] and len(results[0]) == count
        assert len({r.status for r in results[0]}) == 5, "every way to refuse a job must have been met"
        good = [job for job, r in zip(jobs, results[0], strict=True) if r.status is correlate.Status.OK][:4]
        for job in good:
            (golden, surface), (verilated, streamed) = (board.surface(job) for board in boards)
            assert golden == verilated and np.array_equal(surface, streamed)
    counts = [board.counters() for board in boards]
    for key in ("frames_0", "frames_1", "drops_0", "drops_1", "jobs", "refused", "scores"):
        assert counts[0][key] == counts[1][key], key


def test_grids(boards: Pair) -> None:
    config = boards[0].config
    size = (48, 36) if config is TINY else (320, 200)
    w = config.group_bits
    job = Job(0, 6, 5, w, w, 1, 4, 3, 7, 6, 65530)
    step = (w, w // 2)  # the last column runs off the picture
    for board in boards:
        _prepare(board, size, 1.5, _frames(size, 3, seed=session_seed()))
        board.submit_grid(job, (6, 5), step)
    results = [board.collect(30) for board in boards]
    assert results[0] == results[1]
    assert {r.status for r in results[0]} == {correlate.Status.OK, correlate.Status.OUTSIDE}


def test_errors_are_the_same(boards: Pair) -> None:
    size = (40, 36) if boards[0].config is TINY else (200, 150)
    frames = _frames(size, 3)
    messages = []
    for board in boards:
        _prepare(board, size, 1.5, frames)
        with pytest.raises(BoardError) as refused:
            board.surface(Job(0, size[0] - 4, 0, 8, 8, 1, 0, 0, 3, 3))
        with pytest.raises(BoardError) as missing:
            board.read_plane(4)
        board.configure((size[0] - 2, size[1]), 1.5)
        with pytest.raises(BoardError) as stale:
            run_jobs(board, [Job(0, 0, 0, 8, 8, 1, 0, 0, 3, 3)])
        messages.append([str(e.value) for e in (refused, missing, stale)])
    assert messages[0] == messages[1]


@pytest.mark.parametrize("others", [0, 20, 120])
def test_captures_between_jobs(others: int) -> None:
    """A capture into a slot of outstanding jobs is refused with the same words, however many jobs are before them; the
    results and the slot stay as they were, and other slots are captured meanwhile."""
    frames = _frames((48, 36), 5, seed=session_seed())
    seen = []
    with GoldenBoard(TINY) as golden, VerilatedBoard(TINY) as verilated:
        for board in (golden, verilated):
            _prepare(board, (48, 36), 1.5, frames)
            board.submit([Job(0, 4, 4, 16, 16, 2, 0, 0, 33, 21, n) for n in range(others)]
                         + [Job(0, 4, 4, 16, 16, 1, 0, 0, 20, 15, 1000 + n) for n in range(5)])
            messages = []
            for call in (partial(board.capture, 1, frames[3]),
                         partial(board.capture_pair, (3, 1), (frames[3], frames[4]))):
                with pytest.raises(BoardError) as refused:
                    call()
                messages.append(str(refused.value))
            board.capture_pair((3, 4), (frames[3], frames[4]))
            results = board.collect(others + 5)
            planes = [board.read_plane(slot).tobytes() for slot in range(5)]
            board.capture(1, frames[3])
            results += run_jobs(board, [Job(0, 4, 4, 16, 16, 1, 0, 0, 20, 15)])
            seen.append((messages, results, planes))
    assert seen[0] == seen[1]


def test_a_failed_capture_leaves_no_request() -> None:
    """A capture that times out, as its slot stays in use, is withdrawn: the next frame does not go to that slot."""
    frames = _frames((48, 36), 3)
    job = Job(0, 4, 4, 16, 16, 1, 0, 0, 33, 21)
    with Device(TINY) as device:
        device.set_filter(*log.kernels(1.5, TINY.radius), (48, 36))
        device.capture({0: 0}, {0: frames[0]})
        device.capture({0: 1}, {0: frames[1]})
        plane = device.plane(1)
        device.submit([job] * 400)  # the driver alone does not refuse this
        with pytest.raises(DeviceError):
            device.capture({0: 1}, {0: frames[2]})
        assert not device.read("slot_status.armed")
        device.play(frames[2])
        device.finish_playing()
        device.collect(device.outstanding)
        device.tick(1000)
        assert not device.read("slot_status.writing") and np.array_equal(device.plane(1), plane)
        device.capture({0: 1}, {0: frames[2]})
        assert np.array_equal(device.plane(1), log.sign(frames[2], 1.5, TINY.radius))


def test_captures_race_searches() -> None:
    """Jobs on a slot into which a frame is just captured, at every moment: each result is of the frame before, of the
    new one, or refused, never of a mixture."""
    rng = session_rng("captures race searches")
    source = np.random.default_rng(rng.getrandbits(32))
    size = (48, 36)
    seen: Counter[str] = Counter()
    with Device(TINY) as device:
        device.set_filter(*log.kernels(1.5, TINY.radius), size)
        frame: Image = source.integers(0, 256, size[::-1], dtype=np.uint8)
        device.capture({0: 0, 1: 1}, {0: frame, 1: frame})
        planes = dict.fromkeys((0, 1), log.sign(frame, 1.5, TINY.radius))
        for _ in range(300):
            frame = source.integers(0, 256, size[::-1], dtype=np.uint8)
            new = {**planes, 1: log.sign(frame, 1.5, TINY.radius)}
            slots = rng.choice(((0, 1), (1, 0), (1, 1)))
            job = Job(slots[0], rng.randint(0, 30), rng.randint(0, 18), *rng.choice(((2, 2), (16, 16), (7, 16))),
                      slots[1], 0, 0, rng.choice((1, 20, 32)), rng.choice((1, 15, 20)))
            device.arm(1)
            device.play(frame)
            # The frame's first row leaves the filter about 470 clocks after its first pixel.
            device.tick(rng.choice((rng.randint(380, 560), rng.randint(0, 2600))))
            device.submit([job] * rng.randint(1, 3))
            whole = [correlate.run(job, p, TINY, size) for p in (planes, new)]
            for result in device.collect(device.outstanding):
                kind = ("old" if result == whole[0] else "new" if result == whole[1] else
                        "refused" if result == Result(0, Status.BAD_SLOT) else "mixed")
                seen[kind] += 1
            device.finish_playing()
            if 1 & device.read("slot_status.armed"):
                try:
                    device.wait_captured(0)
                except DeviceTimeout:  # the capture gave way to a job: its request waits for another frame
                    seen["gave way"] += 1
                    device.play(frame)
                    device.finish_playing()
                    device.wait_captured(0)
            assert np.array_equal(device.plane(1), new[1])
            planes = new
    assert not seen["mixed"] and min(seen[kind] for kind in ("old", "new", "refused", "gave way")) >= 20, seen


def test_figure8() -> None:
    """The paper's bar through the RTL, and the same bits."""
    with GoldenBoard() as golden, VerilatedBoard() as verilated:
        for name in ("gravel", "grass"):
            picture = np.asarray(cv2.resize(getattr(skimage.data, name)(), figure8.SIZE), np.uint8)
            rows = [figure8.measure(board, name, picture, [1.5])[0] for board in (golden, verilated)]
            assert rows[0] == rows[1]
            assert rows[1].whole > 0.90 and rows[1].inner > 0.95
            for slot in (0, 1):
                assert np.array_equal(golden.read_plane(slot), verilated.read_plane(slot))


def _tracks(frames: list[Image], fit: Fit, features: int) -> list[list[TrackPoint]]:
    """Tracks by the golden board, which those by the Verilated board equal to the last bit of the sub-pixel fits."""
    points = []
    for kind in (GoldenBoard, VerilatedBoard):
        with kind(FULL) as board:
            tracker = Tracker(Measurer(board, fit.board, 2.5), TrackSettings(features=features))
            points.append([tracker.step(fit.show(frame)) for frame in frames])
    assert points[0] == points[1]
    return points[0]


def test_tracks() -> None:
    size = (320, 240)
    points = _tracks(_frames(size, 5, seed=2), Fit.to(size, FULL, 64), 8)
    assert sum(p.valid and p.dx < -1 for frame in points for p in frame) >= 16


@pytest.mark.parametrize("name", ["sparus", "aqualoc"])
def test_tracks_of_real_seabed(name: str) -> None:
    file = SHARED / name / f"{name}_snippet.mp4"
    if not file.exists():
        pytest.skip("real frames are not at hand: no ../shared/data")
    frames = [f.grey for f in islice(open_source(file), 4)]
    points = _tracks(frames, Fit.to(frames[0].shape[::-1], FULL, 64), 10)
    assert sum(p.valid for frame in points[1:] for p in frame) >= 15
