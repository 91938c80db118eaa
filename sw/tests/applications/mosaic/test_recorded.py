# SPDX-License-Identifier: Apache-2.0
"""Surveys whose frames are all there: the same edges and poses whoever measures, killed workers, interrupts."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from typer.testing import CliRunner

from signum.applications.mosaic.crew import Bench, Cluster, Crew, Processes, answer_all, shared_out
from signum.applications.mosaic.edges import JOIN
from signum.applications.mosaic.journal import MATCH, Key
from signum.applications.mosaic.recorded import RecordedSurvey
from signum.boards.golden import GoldenBoard
from signum.commands.cli import application
from signum.common.errors import SignumError
from signum.common.files import write_picture
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from tests.applications.mosaic.imagined import CENTRE, TruthRegistrar, imagined, lanes
from tests.endurance import SIGMA, SIZE, WINDOW, columns

COUNT = 24
FILES = "edges.csv", "poses.csv"


def _bench(out: Path) -> Bench:
    return Bench(str(out / "frames"), "golden", SIZE, WINDOW, SIGMA)


def _registrar(board: GoldenBoard) -> Registrar:
    return Registrar.on(lambda size, wide: Measurer(board, size, wide), Fit.to(SIZE, board.config, WINDOW), WINDOW,
                        SIGMA)


def _measure(out: Path, crew: Crew | None = None, resume: bool = False, stop: int = 10**9, kill: int | None = None
             ) -> tuple[list[bytes], int]:
    """A batch of the survey, broken off after `stop` phrases, with a process killed after the first answers; its
    tables, and the clocks of this process's board."""
    with GoldenBoard() as board:
        survey = RecordedSurvey(_registrar(board), out, crew=crew, resume=resume)
        for frame in columns(COUNT):
            survey.add(frame)
        for number, said in enumerate(survey.finish()):
            if kill is not None and said.startswith("neighbours: ") and not said.startswith("neighbours: 0 "):
                os.kill(kill, signal.SIGKILL)
                kill = None
            if number == stop:
                survey.leave()
                return [], board.clocks
        survey.close()
        assert kill is None or stop < 10**9
        return [(out / name).read_bytes() for name in FILES], board.clocks


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """The tables as this process alone makes them."""
    tables, clocks = _measure(tmp_path_factory.mktemp("alone"))
    assert clocks > 0 and tables[0].count(b"\n") > 50 and tables[1].count(b"\n") == COUNT + 1
    return tables


def test_two_processes_one_killed(alone: list[bytes], tmp_path: Path) -> None:
    """What is lost is measured again; this process measures nothing."""
    with Processes(_bench(tmp_path), 2) as crew:
        list(crew.answers([]))
        crew._submit([]).result()
        tables, clocks = _measure(tmp_path, crew, kill=crew.pids[0])
    assert tables == alone and clocks == 0


def _dask(*words: str, folder: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-m", *words, "--scheduler-file", str(folder / "scheduler.json")],
                            cwd=folder, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler on this machine, and its two workers."""
    pytest.importorskip("distributed")
    started = [_dask("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                     "--dashboard-address", ":0", folder=tmp_path)]
    started += [_dask("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--no-dashboard", folder=tmp_path)
                for _ in range(2)]
    try:
        while not (tmp_path / "scheduler.json").exists():
            assert started[0].poll() is None
            time.sleep(0.1)
        yield json.loads((tmp_path / "scheduler.json").read_text())["address"], started[1:]
    finally:
        for process in started:
            with suppress(OSError):
                process.kill()
            process.wait()


def test_two_workers_of_a_cluster_one_killed(alone: list[bytes], tmp_path: Path,
                                              cluster: tuple[str, list[subprocess.Popen[bytes]]]) -> None:
    address, workers = cluster
    with Cluster(_bench(tmp_path / "out"), address, 180) as crew:
        crew._client.wait_for_workers(2, timeout=180)
        tables, clocks = _measure(tmp_path / "out", crew, kill=workers[0].pid)
    assert workers[0].wait() == -signal.SIGKILL and workers[1].poll() is None
    assert tables == alone and clocks == 0


def test_an_interrupted_batch_is_continued(alone: list[bytes], tmp_path: Path) -> None:
    """What was measured is in the journal, and not measured again."""
    _, first = _measure(tmp_path, stop=30)
    tables, rest = _measure(tmp_path, resume=True)
    _, nothing = _measure(tmp_path, resume=True)
    assert tables == alone and first > 0 and rest > 0 and nothing == 0
    assert (tmp_path / "frames" / "journal.txt").read_text().count(f'["{MATCH}"') == alone[0].count(b"\n") - 1


def test_frames_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "frames").mkdir()
    for frame in columns(6):
        write_picture(tmp_path / "frames" / f"{int(frame.name):06d}.png", frame.picture)
    read: list[str] = []

    def reading(path: Path) -> bytes:
        read.append(path.name)
        return path.read_bytes()

    monkeypatch.setattr("signum.applications.mosaic.crew.own_bytes", reading)
    keys: list[Key] = [(k, k + 1, None, None) for k in range(5)]
    keys += [(k, k + 2, (1.0, 0.0, 0.0, 120.0), 18) for k in range(4)]
    shares = shared_out(keys, 1)
    assert {key for share in shares for key in share} == set(keys)
    found = [one for share in shares for one in answer_all(_bench(tmp_path), share)]
    assert len(found) == 9 and sum(one.accepted for one in found) >= 5
    assert len(read) == 6 == len(set(read))
    with pytest.raises(SignumError, match="all workers see by the same path"):
        answer_all(_bench(tmp_path), [(0, 99, None, None)])


def test_columns_broken_apart_are_joined(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frame 31 shows nothing that others show: two components, which the columns beside each other join."""
    monkeypatch.setattr("os.fsync", lambda handle: None)
    truth = lanes(60, 8)
    truth[31] = Similarity(shift=1e6)
    survey = RecordedSurvey(cast(Registrar, TruthRegistrar(truth)), tmp_path)
    survey.settings.__dict__["back"] = 1
    for k in range(60):
        survey.add(imagined(k))
    for _ in survey.finish():
        pass
    assert [len(piece.stored) for piece in survey.ranked()] == [59, 1]
    assert sum(edge.kind == JOIN and edge.accepted for edge in survey.edges) >= 2
    piece = survey.ranked()[0]
    z = np.array([complex(*piece.places[name](CENTRE)) for name in piece.stored])
    w = np.array([complex(*truth[int(name)](CENTRE)) for name in piece.stored])
    a, b = z - z.mean(), w - w.mean()
    factor = np.vdot(a, b) / np.vdot(a, a)
    assert np.sqrt(np.mean(np.abs(factor * a - b) ** 2)) < 3
    survey.leave()


def test_in_one_command(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for frame in columns(6):
        write_picture(tmp_path / "in" / f"{frame.name}.png", frame.picture)

    def run(*words: str) -> tuple[int, str]:
        done = CliRunner().invoke(application(), ["mosaic", *words, "--window", "32", "--sigma", "2", "--out",
                                                  str(tmp_path / "out")])
        return done.exit_code, done.output

    status, said = run(str(tmp_path / "in"), "--batch", "--jobs", "1")
    assert status == 0 and "5 of 5 edges accepted" in said
    status, said = run(str(tmp_path / "in"))
    assert status == 1 and "holds a survey made with order batch instead of none" in said
    status, said = run("world:kind=survey", "--batch")
    assert status == 1 and said.count("\n") == 1
    np.save(tmp_path / "film.npy", np.stack([frame.picture for frame in columns(4)]))
    status, said = run(str(tmp_path / "film.npy"), "--batch")
    assert status == 1 and "--batch is for snapshots" in said


def test_what_is_missing_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    for address in ("", "tcp://", "127.0.0.1:8786", "tcp://a:b", "http://127.0.0.1:8786", "tcp://x:1\n"):
        with pytest.raises(SignumError, match="expected tcp://HOST:PORT"):
            Cluster(_bench(tmp_path), address)
    with pytest.raises(SignumError, match="no Dask scheduler with workers answers there"):
        Cluster(_bench(tmp_path), "tcp://127.0.0.1:9", 0.5)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SignumError, match=r"extra `cluster`: pip install 'signum\[cluster\]'"):
        Cluster(_bench(tmp_path), "tcp://127.0.0.1:9")


def test_frames_of_a_batch_are_stored(tmp_path: Path) -> None:
    with GoldenBoard() as board:
        survey = RecordedSurvey(_registrar(board), tmp_path)
        assert survey.add(Frame("a", np.zeros(SIZE[::-1], np.uint8))) == "a: stored"
        survey.leave()
    assert (tmp_path / "frames" / "000000.png").exists()
