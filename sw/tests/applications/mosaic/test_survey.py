# SPDX-License-Identifier: Apache-2.0
"""Surveys end to end: back and forth untold, broken off and gone on with, wrong edges refused, real ones."""

import csv
import itertools
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from signum.applications.mosaic.accuracy import pose_errors
from signum.applications.mosaic.edges import JOIN, SEQUENCE
from signum.applications.mosaic.loop_closures import Loops
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import ResumeError
from signum.applications.mosaic.simulate import Flown, Plan, simulate_survey
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.track_reader import read_track
from signum.boards.board import Board
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from signum.commands.cli import application
from signum.common.files import write_picture
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.reproduce.reference import SHARED, read_pairs, residuals
from signum.sources.open import open_source

app = application()

PLAN = Plan(rows=3, columns=3, size=(192, 144), focal=220.0, step=(0.5, 0.5), yaw_deg=2.0)
KILLED = """
import os, signal
from signum.applications.mosaic.ledger import Ledger
note, rows = Ledger.note, []
def noted(self, edge):
    note(self, edge)
    rows.append(edge)
    if len(rows) == 9:
        self._table.write("00,0")
        self._table.flush()
        os.kill(os.getpid(), signal.SIGKILL)
    return edge
Ledger.note = noted
from signum.commands.cli import main
main()
"""
"""The command, killed as it writes the tenth row of edges.csv."""


def _registrar(size: tuple[int, int], window: int = 48, sigma: float = 2.0,
               board: Board | None = None) -> Registrar:
    on = board or GoldenBoard()
    return Registrar.on(lambda s, wide: Measurer(on, s, wide), Fit.to(size, on.config, window), window, sigma)


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def flown() -> Flown:
    return simulate_survey(PLAN, 3)


@pytest.fixture
def folder(flown: Flown, tmp_path: Path) -> Path:
    """The survey's frames as a folder, 00.png and so on in the order flown, and their truth beside it."""
    path = tmp_path / "in"
    path.mkdir()
    lines = ["frame,east_m,north_m,heading_deg"]
    for k, cell in enumerate(flown.sequence()):
        write_picture(path / f"{k:02d}.png", flown.frames[cell])
        at = flown.position(cell) * PLAN.pixel_m
        lines.append(f"{k:02d},{at.real:.5f},{-at.imag:.5f},{flown.truth[cell].rot_deg:.4f}")
    (tmp_path / "truth.csv").write_text("\n".join(lines) + "\n")
    return path


def test_back_and_forth_in_one_command(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = _run("mosaic", folder, "--window", "48", "--sigma", "2", "--truth", tmp_path / "truth.csv", "--range", "2",
                  "--focal", "220", "--out", out)
    assert result.exit_code == 0, result.output
    assert "8 of 8 edges accepted" in result.stdout
    errors = {(r["method"], r["error"]): float(r["rmse"]) for r in _rows(out / "accuracy.csv")}
    pixel = PLAN.pixel_m
    assert errors["all links", "APE after similarity"] < 1.5 * pixel
    assert errors["all links", "RPE, frame to frame"] < 2 * pixel and errors["all links", "RPE, rotation"] < 0.5
    edges = _rows(out / "edges.csv")
    across = [e for e in edges if e["kind"] == "loop" and e["accepted"] == "1"]
    assert len(across) >= 8, "columns are linked to one another"
    assert len(_rows(out / "poses.csv")) == 9 and not list(out.glob("poses-*"))
    page = (out / "report.html").read_text()
    assert "Against the truth" in page and "data:image/png" in page and "http" not in page
    assert (out / "mosaic.tif").exists() and float((out / "mosaic.pgw").read_text().split()[0]) == pytest.approx(pixel)
    picture = np.asarray(cv2.imread(str(out / "mosaic.png"), cv2.IMREAD_UNCHANGED))
    assert picture.shape[0] > 1.8 * 144 and picture.shape[1] > 1.8 * 192 and (picture > 0).mean() > 0.75


def test_the_same_on_the_verilated_board(flown: Flown, tmp_path: Path) -> None:
    written = []
    for board in (GoldenBoard(), VerilatedBoard()):
        with board, Survey(_registrar(PLAN.size, board=board), tmp_path / board.name) as survey:
            for k, cell in enumerate(flown.sequence()[1:5]):
                survey.add(Frame(str(k), flown.frames[cell]))
        written.append([(tmp_path / board.name / name).read_text() for name in ("edges.csv", "poses.csv")])
    assert written[0] == written[1] and written[0][0].count("\n") >= 5


def test_single_column_is_the_chain_alone(folder: Path, tmp_path: Path) -> None:
    result = _run("mosaic", folder, "--window", "48", "--sigma", "2", "--columns", "single", "--out", tmp_path / "out")
    assert result.exit_code == 0 and {e["kind"] for e in _rows(tmp_path / "out" / "edges.csv")} == {SEQUENCE}


def test_killed_and_gone_on_with(folder: Path, tmp_path: Path) -> None:
    """kill -9 in the middle; what is then called again takes up where it was and ends as an unbroken run does."""
    arguments = ["mosaic", str(folder), "--window", "48", "--sigma", "2"]
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    assert _run(*arguments, "--out", whole).exit_code == 0
    table = broken / "edges.csv"
    killed = subprocess.run([sys.executable, "-c", KILLED, *arguments, "--out", str(broken)], check=False,
                            capture_output=True)
    assert killed.returncode == -signal.SIGKILL and table.read_text().endswith("00,0")
    before = [r for r in _rows(table)[:-1] if r["kind"] == SEQUENCE and r["accepted"] == "1"]
    assert 3 <= len(before) < 8, "it was to be broken off half-way"
    result = _run(*arguments, "--out", broken)
    assert result.exit_code == 0 and "going on with the survey interrupted" in result.stderr
    after = [r for r in _rows(table) if r["kind"] == SEQUENCE and r["accepted"] == "1"]
    assert after[: len(before)] == before and len(after) == 8, "nothing measured before is measured again"
    names = sorted(str(p.relative_to(whole)) for p in whole.rglob("*") if p.is_file() and p.name != "report.html")
    for name in names:
        assert (broken / name).read_bytes() == (whole / name).read_bytes(), name
    refused = _run(*arguments[:3], "32", "--resume", "--out", broken)
    assert refused.exit_code == 1 and "made with --window 48 instead of 32" in refused.stderr
    bent = _run(*arguments, "--columns", "turned", "--resume", "--out", broken)
    assert bent.exit_code == 1 and "made with --columns auto instead of turned" in bent.stderr
    with pytest.raises(ResumeError, match="no survey there"):
        Survey(_registrar(PLAN.size), tmp_path / "nothing", resume=True)


def test_it_grows_while_frames_arrive(flown: Flown, tmp_path: Path) -> None:
    survey = Survey(_registrar(PLAN.size), tmp_path, every=0.0)
    areas = []
    for k, cell in enumerate(flown.sequence()[:5]):
        survey.add(Frame(str(k), flown.frames[cell]))
        survey._update_took = 0.0
        areas.append(int((np.asarray(cv2.imread(str(tmp_path / "mosaic.png"))) > 0).sum()))
        assert len(_rows(tmp_path / "poses.csv")) == k + 1
    survey.close()
    assert all(b > a for a, b in itertools.pairwise(areas))


def test_wrong_predictions_never_make_a_edge(flown: Flown, tmp_path: Path) -> None:
    """Pairs that do not overlap, and pairs that do but elsewhere than predicted: refused, or right all the same."""
    survey = Survey(_registrar(PLAN.size), tmp_path)
    cells = flown.sequence()
    for k, cell in enumerate(cells):
        survey.ledger.shelf.save(str(k), flown.frames[cell])
    rng = np.random.default_rng(0)
    wrong = accepted = 0
    for _ in range(40):
        a, b = rng.choice(9, 2, replace=False)
        predicted = Similarity.of(rng.uniform(-6, 6), 1.0, (rng.uniform(-110, 110), rng.uniform(-80, 80)))
        edge = Loops(survey.ledger).measure(str(a), str(b), "loop", predicted, float(rng.uniform(1, 12)))
        if edge.accepted:
            accepted += 1
            true = flown.truth[cells[b]].inverse @ flown.truth[cells[a]]
            wrong += bool(np.hypot(*(edge.similarity(np.array(edge.middle)) - true(np.array(edge.middle)))) > 5)
    survey.close()
    assert wrong == 0 and accepted < 10


def test_pieces_are_joined_where_columns_meet(flown: Flown, tmp_path: Path) -> None:
    """Frames between two columns are lost: two components, until a frame of the second finds the first."""
    blind = np.random.default_rng(5).integers(0, 256, PLAN.size[::-1], dtype=np.uint8)
    cells = flown.sequence()
    pictures: list[tuple[str, np.ndarray]] = [(str(k), flown.frames[c]) for k, c in enumerate(cells[:3])]
    pictures += [("lost", blind)]
    pictures += [(str(k), flown.frames[c]) for k, c in enumerate(cells[3:], 3)]
    with Survey(_registrar(PLAN.size), tmp_path, settings=SurveySettings(back=1)) as survey:
        for name, picture in pictures:
            survey.add(Frame(name, picture))
        for _ in survey.finish():
            pass
    assert sorted(len(p.frames) for p in survey.pieces) == [1, 9]
    assert sum(edge.kind == JOIN and edge.accepted for edge in survey.edges) >= 2
    piece = survey.ranked()[0]
    truth = {str(k): flown.position(c) for k, c in enumerate(cells)}
    first = flown.truth[cells[0]]
    for pose in survey.poses(piece):
        there = first.inverse(np.array([truth[pose.frame].real, truth[pose.frame].imag]) * PLAN.pixel_m)
        assert np.hypot(pose.x_px - there[0], pose.y_px - there[1]) < 6
    assert [r["frame"] for r in _rows(tmp_path / "poses-2.csv")] == ["lost"]


def test_a_stream_of_columns(tmp_path: Path) -> None:
    """A video flown up one column and down the next: every frame is placed, the columns are linked."""
    plan = Plan(rows=8, columns=2, size=(192, 144), focal=220.0, step=(0.125, 0.5), yaw_deg=0.5, zoom=0.003,
                tilt_deg=0.1, place_m=0.005)
    flown = simulate_survey(plan, 1)
    cells = flown.sequence()
    # Between the columns the camera moves aside in steps.
    with Survey(_registrar(plan.size), tmp_path, stream=True) as survey:
        for k, cell in enumerate(cells):
            survey.add(Frame(str(k), flown.frames[cell]))
        survey.settle()
        for _ in survey.finish():
            pass
    placed = {p.frame: complex(p.x_px, p.y_px) for p in survey.poses(survey.ranked()[0])}
    assert len(placed) >= 15
    names = list(placed)
    z = np.array([placed[n] for n in names])
    w = np.array([flown.position(cells[int(n)]) for n in names])
    a, b = z - z.mean(), w - w.mean()
    factor = np.vdot(a, b) / np.vdot(a, a)
    assert np.sqrt(np.mean(np.abs(factor * a - b) ** 2)) < 2.5


def _real(run: str) -> Path:
    if not (SHARED / run).exists():
        pytest.skip(f"no {SHARED / run} on this machine")
    return SHARED / run


@pytest.fixture
def real(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Survey, Path]]:
    path = _real(request.param)
    frames = list(open_source(path))
    with Survey(_registrar(frames[0].size, 64, 2.5), tmp_path, source=str(path)) as survey:
        for frame in frames:
            survey.add(frame)
        for _ in survey.finish():
            pass
    assert len(survey.ranked()[0].stored) == len(frames)
    yield survey, path


@pytest.mark.parametrize("real", ["skerki"], indirect=True)
def test_skerki_both_columns(real: tuple[Survey, Path]) -> None:
    survey, path = real
    pairs = read_pairs(path / "sift_pairs.csv")
    off = residuals(survey.ranked()[0].places, pairs, survey.ledger.size)
    print(f"skerki: {len(survey.ledger.accepted)} edges, residual mean {off.mean():.2f} px, "
          f"median {np.median(off):.2f} px")
    assert off.mean() <= 6 and np.median(off) <= 4.5
    for edge in survey.ledger.accepted:
        if edge.kind == SEQUENCE:
            x, y = pairs[edge.frame_a, edge.frame_b].similarity(np.array(edge.centre)) - np.array(edge.centre)
            miss = np.hypot(edge.shift[0] - x, edge.shift[1] - y)
            assert miss <= 8 + 0.05 * np.hypot(x, y), (edge.frame_a, edge.frame_b)
    assert [edge for edge in survey.ledger.accepted if (edge.frame_a, edge.frame_b) == ("07", "08")]


@pytest.mark.parametrize("real", ["imos/test1", "imos/test5"], indirect=True)
def test_imos_frame_centres(real: tuple[Survey, Path]) -> None:
    survey, path = real
    error = pose_errors(survey.poses(survey.ranked()[0]), read_track(SHARED / "imos" / "georef.csv", str(path)))
    rms = float(np.sqrt(np.mean(error.ape**2)))
    print(f"{path.name}: frame centres within {100 * rms:.1f} cm RMS of georef.csv")
    assert len(error.frames) == 8 and rms <= 0.06
