# SPDX-License-Identifier: Apache-2.0
"""`signum hold`, `follow` and `simulate` on the command line; the closed loops are identical on both boards."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from golden.params import FULL
from signum.applications.follow.pilot import Where
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.boards.board import Board
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from signum.commands import session
from signum.commands.cli import application
from signum.frames.frame import Frame
from signum.geometry.camera import LOOK_DOWN, Sight
from signum.measure.measurer import Measurer
from signum.sources.files import ArraySource
from signum.tables.schemas import FOLLOW, HOLD
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.world import World

from ..report.heads import check_head

app = application()

SMALL = Pinhole((192, 144), 200.0)
LARGER = Pinhole((256, 192), 266.7)
"""Fish over terrain are found by motion from this size on."""


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _one_line(result: Result, status: int = 1) -> str:
    assert result.exit_code == status, result.output
    lines = [line for line in result.stderr.splitlines() if line.startswith("signum: ")]
    assert len(lines) == 1 and "Traceback" not in result.output
    return lines[0]


@pytest.fixture(scope="module")
def film() -> list[np.ndarray]:
    """A camera over a flat floor 2 m below that goes 1 cm ahead a frame."""
    world = World(Seafloor(extent=3.0, texel=0.005))
    return [world.look(SMALL, Sight(np.array([0.01 * k, 0.0, -2.0]), LOOK_DOWN)).frame for k in range(8)]


@pytest.mark.parametrize("command", ["hold", "follow", "simulate"])
def test_help_gives_an_example(command: str) -> None:
    result = _run(command, "--help")
    text = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    assert result.exit_code == 0 and f"Example: signum {command}" in text.replace("`", "") and "--seed" in text


def test_hold_measures_recorded_frames_and_tells_the_autopilot(tmp_path: Path, film: list[np.ndarray]) -> None:
    from pymavlink import mavutil

    np.save(tmp_path / "film.npy", np.stack(film))
    receiver = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    address = f"udpout:127.0.0.1:{receiver.port.getsockname()[1]}"
    result = _run("hold", "--source", tmp_path / "film.npy", "--range", "2", "--focal", "200", "--mavlink", address,
                  "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    rows = _rows(tmp_path / "out" / "hold.csv")
    assert tuple(rows[0]) == HOLD and [r["time_s"] for r in rows[:2]] == ["0.000", "0.100"]
    assert [float(r["x_m"]) for r in rows] == pytest.approx([0.01 * k for k in range(8)], abs=0.002)
    assert [float(r["y_m"]) for r in rows] == pytest.approx([0.0] * 8, abs=0.002)
    assert all(int(r["confidence"]) > 50 for r in rows)
    got = [receiver.recv_match(type="VISION_POSITION_DELTA", blocking=True, timeout=5) for _ in range(7)]
    receiver.close()
    assert sum(g.position_delta[0] for g in got) == pytest.approx(0.07, abs=0.003)
    assert all(g.confidence > 50 for g in got)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "data:image/png;base64," in page and "http" not in page


def test_hold_simulated_has_the_truth_beside(tmp_path: Path) -> None:
    result = _run("hold", "--seconds", "1.5", "--current", "0.1", "--seed", "3", "--out", tmp_path)
    assert result.exit_code == 0 and "seed 3" in result.stdout, result.output
    rows = _rows(tmp_path / "hold.csv")
    assert len(rows) == 15
    assert all(abs(float(r["x_m"]) - float(r["true_x_m"])) < 0.02 for r in rows)
    assert float(rows[0]["range_m"]) == pytest.approx(float(rows[0]["true_range_m"]), rel=0.01)
    assert (tmp_path / "report.html").stat().st_size > 50000


@pytest.mark.parametrize("options", [(), ("--window", "24"), ("--dense",)])
def test_follow_on_recorded_frames(tmp_path: Path, film: list[np.ndarray], options: tuple[str, ...]) -> None:
    """A patch that moves over the passing floor."""
    skin = cv2.GaussianBlur(np.random.default_rng(0).normal(128, 160, (56, 72)), (0, 0), 1.5)
    frames = []
    for k, frame in enumerate(film):
        shown = frame.copy()
        shown[40:96, 30 + 6 * k:102 + 6 * k] = np.clip(skin, 0, 255)
        frames.append(shown)
    np.save(tmp_path / "film.npy", np.stack(frames))
    result = _run("follow", "--source", tmp_path / "film.npy", "--film", "--out", tmp_path / "out", *options)
    assert result.exit_code == 0, result.output
    rows = _rows(tmp_path / "out" / "follow.csv")
    assert tuple(rows[0]) == FOLLOW and [r["state"] for r in rows] == ["lost"] * 3 + ["seen"] * 5
    for k, r in enumerate(rows[3:], 3):
        assert np.hypot(float(r["x_px"]) - (66 + 6 * k), float(r["y_px"]) - 68) < 16
    check_head(tmp_path / "out" / "report.html", "follow", str(tmp_path / "film.npy"))
    capture = cv2.VideoCapture(str(tmp_path / "out" / "follow.mp4"))
    assert capture.get(cv2.CAP_PROP_FRAME_COUNT) == 8


def test_stopped_by_the_user(tmp_path: Path, film: list[np.ndarray], monkeypatch: pytest.MonkeyPatch) -> None:
    class Stopped(ArraySource):
        def _frames(self) -> Iterator[Frame]:
            for frame in super()._frames():
                if frame.name == "4":
                    raise KeyboardInterrupt
                yield frame

    monkeypatch.setattr(session, "open_source", lambda *_: Stopped(film))
    for command in ("hold", "follow"):
        result = _run(command, "--source", "any", "--out", tmp_path / command)
        assert "stopped" in _one_line(result, 130) and f"{command}.csv: 4 frames" in result.stdout
        assert len(_rows(tmp_path / command / f"{command}.csv")) == 4
        assert "</html>" in (tmp_path / command / "report.html").read_text()


@pytest.mark.parametrize(("arguments", "says"), [
    (("hold", "--mavlink", "udpout:nowhere"), "write it as udpout:HOST:PORT"),
    (("hold", "--mavlink", "tcp:127.0.0.1:9"), "Connection refused"),
    (("hold", "--mavlink", "udpout:127.0.0.1:9"), "connection refused"),
    (("hold", "--focal", "300"), "belong to a --source"),
    (("hold", "--source", "{}/nothing.mp4"), "no such file"),
    (("hold", "--source", "{}/grey.npy"), "begin where the picture shows texture"),
    (("follow", "--right", "x.mp4"), "belong to a --source"),
    (("follow", "--source", "{}/grey.npy", "--right", "{}/grey.npy"), "needs both --right and --calibration"),
    (("follow", "--dense"), "choose --where terrain, or a --source"),
    (("follow", "--source", "{}/grey.npy", "--dense", "--right", "x", "--calibration", "y"), "without --right"),
    (("follow", "--source", "{}/grey.npy", "--dense", "--window", "20"), "with --dense choose one of 8, 16, 32"),
    (("simulate", "hold", "--stereo"), "leave --stereo out"),
])
def test_bad_input_is_one_line(tmp_path: Path, arguments: tuple[str, ...], says: str) -> None:
    np.save(tmp_path / "grey.npy", np.full((2, 144, 192), 90, np.uint8))
    result = _run(*(a.format(tmp_path) for a in arguments), "--out", tmp_path / "out")
    assert says in _one_line(result)


def test_simulate_is_decided_by_its_seed(tmp_path: Path) -> None:
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        result = _run("simulate", "survey", "--seconds", "0.4", "--rate", "5", "--pictures", "--stereo", "--seed",
                      str(seed), "--out", tmp_path / name)
        assert result.exit_code == 0 and f"seed {seed}" in result.stdout, result.output
    a, b, c = ([(tmp_path / n / side / "00001.png").read_bytes() for side in ("left", "right")] for n in "abc")
    assert a == b and a != c and a[0] != a[1]
    truth = _rows(tmp_path / "a" / "truth.csv")
    assert [r["frame"] for r in truth] == ["00000", "00001"]
    assert float(truth[1]["north_m"]) - float(truth[0]["north_m"]) == pytest.approx(0.06, abs=1e-4)
    from signum.geometry.calibration import read_mono, read_stereo

    assert read_mono(tmp_path / "a" / "calibration.yaml")[0][0, 0] == 400
    assert read_stereo(tmp_path / "a" / "calibration.yaml").geometry.baseline == pytest.approx(0.12)


@pytest.mark.parametrize("kind", ["drift", "hold", "midwater", "terrain"])
def test_simulate_every_kind_as_video(kind: str, tmp_path: Path) -> None:
    result = _run("simulate", kind, "--seconds", "0.3", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    capture = cv2.VideoCapture(str(tmp_path / "left.mp4"))
    good, frame = capture.read()
    assert good and frame.shape[:2] == (288, 384) and len(_rows(tmp_path / "truth.csv")) == 3


@pytest.mark.parametrize("what", ["hold", *Where])
def test_closed_loops_are_alike_on_both_boards(what: str) -> None:
    """The same seed gives the same path to the last bit, as every measurement is the same."""
    flown = []
    for kind in (GoldenBoard, VerilatedBoard):
        with kind(FULL) as board:
            flown.append(_fly(board, what))
    assert flown[0] == flown[1]


def _fly(board: Board, what: str) -> list[object]:
    def measurer(size: tuple[int, int]) -> Measurer:
        return Measurer(board, size, 2.0)

    if what == "hold":
        moments = list(simulate_hold(measurer, Scenario(1.5, occluded=(0.75, 0.95)), SMALL))
        assert {m.reading.valid for m in moments} == {True, False}
        return [(m.reading, m.truth) for m in moments]
    terrain = Where(what) is Where.TERRAIN
    glimpses = list(simulate_chase(measurer, Chase(Where(what), 1.0 if terrain else 0.5), LARGER if terrain else SMALL))
    assert any(g.target.blob is not None for g in glimpses)
    return [(g.target.state, g.target.x, g.target.y, g.truth, g.head, g.position) for g in glimpses]
