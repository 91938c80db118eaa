# SPDX-License-Identifier: Apache-2.0
"""The command line: what is written and printed, and what remains after an error or an interrupt."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from golden import log
from signum.commands import session
from signum.commands.cli import application
from signum.common.files import write_picture
from signum.frames.frame import Frame
from signum.sources.files import ArraySource
from signum.tables.schemas import TRACK
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor, photograph
from signum.world.vehicle import DOWN, Vehicle
from signum.world.water import Water
from signum.world.world import World

app = application()

SIZE = 192, 144


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _frames(count: int, step: float, size: tuple[int, int] = SIZE) -> list[np.ndarray]:
    """Frames of a straight flight, `step` pixels down the image from one to the next."""
    world, camera = World(Seafloor(extent=5.12, texel=0.005, quilted=False), Water(noise=2.0)), Pinhole(size, 400.0)
    vehicles = [Vehicle(position=np.array([k * step * 2.0 / 400.0 - 1.0, 0.0, -2.0])) for k in range(count)]
    return [world.look(camera, DOWN.sight(vehicle)).frame for vehicle in vehicles]


def _folder(path: Path, frames: list[np.ndarray]) -> Path:
    path.mkdir()
    for k, frame in enumerate(frames, 1):
        write_picture(path / f"{k}.png", frame)
    return path


def _one_line(result: Result, status: int = 1) -> str:
    assert result.exit_code == status, result.output
    lines = [line for line in result.stderr.splitlines() if line.startswith("signum: ")]
    assert len(lines) == 1 and "Traceback" not in result.output
    return lines[0]


@pytest.mark.parametrize("command", ["filter", "track", "mosaic", "info", "demo", "stereo", "flow", "navigate"])
def test_every_command_takes_the_common_options_and_gives_an_example(command: str) -> None:
    result = _run(command, "--help")
    text = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    assert result.exit_code == 0 and f"Example: signum {command}" in text.replace("`", "")
    assert all(option in text for option in ("--board", "--sigma", "--window"))


def test_filter_writes_the_boards_signs(tmp_path: Path) -> None:
    picture = _frames(1, 0)[0]
    write_picture(tmp_path / "in.png", picture)
    result = _run("filter", tmp_path / "in.png", "--sigma", "1.5", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    sign = np.asarray(cv2.imread(str(tmp_path / "out" / "sign.png"), cv2.IMREAD_UNCHANGED))
    assert np.array_equal(sign, log.sign(picture, 1.5) * 255)
    panel = np.asarray(cv2.imread(str(tmp_path / "out" / "stages.png")))
    assert panel.shape[0] > 2 * 144 and panel.shape[1] > 2 * 192


def test_large_picture_is_scaled_with_a_note(tmp_path: Path) -> None:
    write_picture(tmp_path / "in.png", np.asarray(cv2.resize(photograph("gravel"), (1280, 960))))
    result = _run("filter", tmp_path / "in.png", "--out", tmp_path)
    assert result.exit_code == 0 and "1280x960 are scaled to 640x480" in result.stderr
    assert np.asarray(cv2.imread(str(tmp_path / "sign.png"))).shape[:2] == (480, 640)


def test_track_in_original_pixels(tmp_path: Path) -> None:
    frames = [np.asarray(cv2.resize(f, (960, 720), interpolation=cv2.INTER_CUBIC)) for f in _frames(4, 6)]
    source = _folder(tmp_path / "in", frames)
    result = _run("track", source, "--window", "48", "--features", "12", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    rows = _rows(tmp_path / "out" / "track.csv")
    assert tuple(rows[0]) == TRACK and {r["frame"] for r in rows} == {"1", "2", "3", "4"}
    first = {r["feature"] for r in rows if r["frame"] == "1"}
    last = [r for r in rows if r["frame"] == "4" and r["valid"] == "1" and r["feature"] in first]
    assert len(last) >= 4
    for r in last:
        assert (float(r["dx_px"]), float(r["dy_px"])) == pytest.approx((0, 3 * 6 * 5), abs=2.5)
        assert float(r["y_px"]) < 720 and float(r["score"]) > 0.6
    assert (tmp_path / "out" / "track.png").exists()


def test_mosaic_from_the_command_line(tmp_path: Path) -> None:
    source = _folder(tmp_path / "in", _frames(4, 48))
    result = _run("mosaic", source, "--window", "48", "--out", tmp_path / "out")
    assert result.exit_code == 0 and "3 of 3 edges accepted" in result.stdout
    links = _rows(tmp_path / "out" / "edges.csv")
    edges = [e for e in links if e["kind"] == "sequence"]
    assert [(e["frame_a"], e["frame_b"]) for e in edges] == [("1", "2"), ("2", "3"), ("3", "4")]
    across = {(e["frame_a"], e["frame_b"]): float(e["dy_px"]) for e in links if e["kind"] == "loop"}
    assert across == {("1", "3"): pytest.approx(96, abs=1), ("2", "4"): pytest.approx(96, abs=1)}
    assert [float(e["dy_px"]) for e in edges] == pytest.approx([48] * 3, abs=1)
    poses = _rows(tmp_path / "out" / "poses.csv")
    assert [float(p["y_px"]) for p in poses] == pytest.approx([71.5, 23.5, -24.5, -72.5], abs=2)


def test_what_was_finished_stays_when_a_later_frame_is_bad(tmp_path: Path) -> None:
    source = _folder(tmp_path / "in", _frames(4, 40))
    write_picture(source / "4.png", np.zeros((50, 60), np.uint8))
    for command in ("mosaic", "track"):
        result = _run(command, source, "--window", "48", "--out", tmp_path / command)
        assert "frame 4 is 60x50, frame 1 is 192x144" in _one_line(result)
    chained = [e for e in _rows(tmp_path / "mosaic" / "edges.csv") if e["kind"] == "sequence"]
    assert len(chained) == 2 and len(_rows(tmp_path / "mosaic" / "poses.csv")) == 3
    assert np.asarray(cv2.imread(str(tmp_path / "mosaic" / "mosaic.png"))).shape[0] >= 144 + 70
    assert {r["frame"] for r in _rows(tmp_path / "track" / "track.csv")} == {"1", "2", "3"}


def test_stopped_by_the_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Stopped(ArraySource):
        snapshots = True

        def _frames(self) -> Iterator[Frame]:
            for frame in super()._frames():
                if frame.name == "3":
                    raise KeyboardInterrupt
                yield frame

    monkeypatch.setattr(session, "open_source", lambda *_: Stopped(_frames(6, 40)))
    for command in ("mosaic", "track"):
        result = _run(command, "any", "--window", "48", "--out", tmp_path / command)
        assert "stopped" in _one_line(result, 130)
        assert f"{command}.csv: 3 frames" in result.stdout or "mosaic.png: 3 frames" in result.stdout
    assert len(_rows(tmp_path / "mosaic" / "poses.csv")) == 3
    assert np.asarray(cv2.imread(str(tmp_path / "mosaic" / "mosaic.png"))) is not None
    assert {r["frame"] for r in _rows(tmp_path / "track" / "track.csv")} == {"0", "1", "2"}


@pytest.mark.parametrize(("arguments", "says"), [
    (("mosaic", "{}/nothing"), "no such file or folder"),
    (("filter", "{}/nothing.png"), "no such file"),
    (("track", "{}"), "no pictures in this folder"),
    (("track", "{}/small.png"), "smaller than the 64x64 window: choose a smaller one"),
    (("mosaic", "{}/empty.mp4"), "the file is empty"),
    (("filter", "{}/small.png", "--out", "{}/small.png"), "is a file: choose another folder with --out"),
])
def test_bad_input_is_one_line(tmp_path: Path, arguments: tuple[str, ...], says: str) -> None:
    pictures = tmp_path / "p" if arguments[1] != "{}" else tmp_path / "none"
    pictures.mkdir()
    if arguments[1] != "{}":
        write_picture(pictures / "small.png", np.full((40, 50), 30, np.uint8))
        (pictures / "empty.mp4").touch()
    result = _run(*(a.format(pictures) for a in arguments))
    assert says in _one_line(result)


def test_info_tells_what_the_board_is() -> None:
    result = _run("info")
    assert result.exit_code == 0
    for word in ("golden", "full", "max_width", "640", "busy_clocks", "slots"):
        assert word in result.stdout
