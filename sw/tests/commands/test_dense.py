# SPDX-License-Identifier: Apache-2.0
"""`signum stereo --dense` and `signum flow --dense`: files, tables, reports, and what is refused in one line."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.common.files import write_picture
from signum.frames.frame import read_picture
from signum.measure.flow import FlowField
from signum.report.wheel import draw_wheel_flow, wheel_colours
from signum.tables.schemas import MOVING

app = application()
SCENE = cv2.GaussianBlur(np.random.default_rng(1).integers(0, 256, (110, 180), dtype=np.uint8), (0, 0), 0.8)


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _pair(folder: Path, across: int, down: int) -> tuple[Path, Path]:
    """Two pictures; what the first shows lies that much further right and down in the second."""
    for k in (0, 1):
        write_picture(folder / f"{k}.png", SCENE[8 - k * down:104 - k * down, 12 - k * across:168 - k * across].copy())
    return folder / "0.png", folder / "1.png"


def _rig(path: Path, shift: float = 0.0) -> Path:
    k = np.array([[150.0, 0, 77.5], [0, 150.0, 47.5], [0, 0, 1]])
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    other = k + np.array([[0, 0, shift], [0, 0, 0], [0, 0, 0]])
    entries: dict[str, Any] = {"image_width": 156, "image_height": 96, "K1": k, "K2": other, "D1": np.zeros(5),
                               "D2": np.zeros(5), "R": np.eye(3), "T": np.array([[-0.1], [0.0], [0.0]])}
    for name, value in entries.items():
        storage.write(name, value)
    storage.release()
    return path


def test_a_range_at_every_pixel(tmp_path: Path) -> None:
    left, right = _pair(tmp_path, -5, 0)
    result = _run("stereo", left, right, "--dense", "--calibration", _rig(tmp_path / "rig.yaml"), "--most", "20",
                  "--out", tmp_path / "out")
    assert result.exit_code == 0 and "% of the pixels valid" in result.output, result.output
    grid = tifffile.imread(tmp_path / "out" / "range.tiff")
    assert grid.shape == (96, 156) and np.nanmedian(grid) == pytest.approx(150 * 0.1 / 5, abs=0.02)
    points = int((tmp_path / "out" / "points.ply").read_text().splitlines()[2].split()[-1])
    assert points == np.isfinite(grid).sum() > 0.6 * grid.size
    rows = _rows(tmp_path / "out" / "disparity.csv")
    assert len(rows) == (-(-96 // 8)) * (-(-156 // 8)) and {float(r["x_px"]) % 8 for r in rows} == {0.0}
    page = (tmp_path / "out" / "report.html").read_text()
    assert "--dense" in page and "--step 1" in page and "every pixel" in page


def test_a_rectified_pair_has_the_geometry_of_its_calibration(tmp_path: Path) -> None:
    """The principal points lie 2 px apart, which rectification would move into one place; the focal length stays."""
    rig = _rig(tmp_path / "rig.yaml", shift=2.0)
    for more in ((), ("--rectified",)):
        result = _run("stereo", *_pair(tmp_path, -5, 0), "--dense", "--calibration", rig, *more, "--most", "20",
                      "--out", tmp_path / "out")
        assert result.exit_code == 0, result.output
        ranges = tifffile.imread(tmp_path / "out" / "range.tiff")
        assert np.nanmedian(ranges) == pytest.approx(150 * 0.1 / (5 + 2), abs=0.02), more


def test_a_mistyped_command_leaves_what_an_earlier_one_wrote(tmp_path: Path) -> None:
    left, right = _pair(tmp_path, -5, 0)
    assert _run("stereo", left, right, "--dense", "--most", "20", "--out", tmp_path / "out").exit_code == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    write_picture(tmp_path / "small.png", SCENE[:90, :100].copy())
    for wrong in ((left, right, "--least", "20", "--most", "10"), (left, right, "--most", "900"),
                  (left, tmp_path / "small.png")):
        assert _run("stereo", *wrong, "--dense", "--out", tmp_path / "out").exit_code == 1
        assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before, wrong


def test_a_field_in_colours(tmp_path: Path) -> None:
    folder = tmp_path / "frames"
    folder.mkdir()
    _pair(folder, 4, -2)
    result = _run("flow", folder, "--dense", "--step", "4", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    rows = [r for r in _rows(tmp_path / "out" / "flow.csv") if r["valid"] == "1"]
    assert len(rows) > 400
    assert np.median([float(r["dx_px"]) for r in rows]) == pytest.approx(4, abs=0.05)
    assert np.median([float(r["dy_px"]) for r in rows]) == pytest.approx(-2, abs=0.05)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "--window 32" in page and "--sigma 1.5" in page and "hue" in page
    assert (tmp_path / "out" / "flow_0.png").exists()


def test_what_moves_by_itself_is_listed_masked_and_outlined(tmp_path: Path) -> None:
    """Frames twice as large as the board takes, of a floor that moves by 4 pixels and a patch that moves by 12."""
    folder, rng = tmp_path / "frames", np.random.default_rng(4)
    folder.mkdir()
    floor, patch = (cv2.GaussianBlur(rng.integers(0, 256, size, dtype=np.uint8), (0, 0), 2.5)
                    for size in ((560, 1300), (180, 220)))
    for k in range(3):
        frame = floor[:, 10 - 4 * k:1290 - 4 * k].copy()
        frame[200:380, 300 + 12 * k:520 + 12 * k] = patch
        write_picture(folder / f"{k}.png", frame)
    result = _run("flow", folder, "--dense", "--moving", "--pictures", "1", "--reach", "8", "--out", tmp_path / "out")
    assert result.exit_code == 0 and "2 objects that move by themselves" in result.output, result.output
    rows = _rows(tmp_path / "out" / "moving.csv")
    assert tuple(rows[0]) == MOVING and [(r["frame_a"], r["frame_b"], r["object"]) for r in rows] == [
        ("0", "1", "1"), ("1", "2", "1")]
    for k, one in enumerate(rows):
        figures = {name: float(one[name]) for name in MOVING[5:]}
        assert (figures["x_px"], figures["y_px"]) == pytest.approx((409.5 + 12 * k, 289.5), abs=12)
        assert (figures["left_px"], figures["width_px"]) == pytest.approx((300 + 12 * k, 220), abs=30)
        assert figures["area_px"] == pytest.approx(180 * 220, rel=0.15)
        assert (figures["dx_px"], figures["own_dx_px"]) == pytest.approx((12, 8), abs=0.5)
        assert abs(figures["own_dy_px"]) < 0.5 and figures["confidence"] > 80
    mask = read_picture(tmp_path / "out" / "moving_1.png")
    assert mask.shape == (280, 640) and set(np.unique(mask)) == {0, 255}, "the board's picture"
    assert (mask == 255).sum() * 4 == pytest.approx(float(rows[1]["area_px"]), abs=3)
    outlined = cv2.imread(str(tmp_path / "out" / "flow_1.png"))
    assert outlined is not None and (outlined == (0, 230, 255)).all(-1).sum() > 200
    page = (tmp_path / "out" / "report.html").read_text()
    assert "What moves by itself" in page and "--moving" in page


def test_nothing_that_moves_by_itself_is_a_table_without_rows(tmp_path: Path) -> None:
    folder = tmp_path / "frames"
    folder.mkdir()
    _pair(folder, 3, 1)
    result = _run("flow", folder, "--dense", "--moving", "--out", tmp_path / "out")
    assert result.exit_code == 0 and "0 objects" in result.output, result.output
    assert _rows(tmp_path / "out" / "moving.csv") == []
    assert "objects, over all pairs of frames" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize(("command", "options", "says"), [
    ("flow", ("--moving",), "--moving: only the dense engine can tell it; add --dense"),
    ("flow", ("--dense", "--window", "64"), "--window 64: with --dense choose one of 8, 16, 32"),
    ("stereo", ("--dense", "--window", "20"), "--window 20: with --dense choose one of 8, 16, 32"),
    ("flow", ("--step", "2"), "--step 2: choose 4 or more, or --dense")])
def test_what_does_not_go_together_is_one_line(tmp_path: Path, command: str, options: tuple[str, ...], says: str
                                               ) -> None:
    left, right = _pair(tmp_path, -5, 0)
    result = _run(command, left, *([right] if command == "stereo" else []), *options, "--out", tmp_path / "out")
    assert result.exit_code == 1 and result.stderr == f"signum: {says}\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("more", [(), ("--moving",)])
def test_a_frame_that_shows_nothing_does_not_end_a_dive(tmp_path: Path, more: tuple[str, ...]) -> None:
    """Its pairs have no valid window and are drawn grey; those after it are measured."""
    frames = np.stack([SCENE[:96, 12 - k:168 - k] for k in range(5)])
    frames[2] = 12
    np.save(tmp_path / "dive.npy", frames)
    result = _run("flow", tmp_path / "dive.npy", "--dense", "--reach", "3", *more, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    rows = _rows(tmp_path / "out" / "flow.csv")
    assert [{row["valid"] for row in rows if row["frame_a"] == str(k)} == {"0"} for k in range(4)] == [
        False, True, True, False]


@pytest.mark.parametrize(("options", "says"), [
    (("--most", "512"), "--least 0, --most 512: the dense engine searches from -511 to 511; "),
    (("--least", "-600"), "--least -600, --most 39: the dense engine searches from -511 to 511; ")])
def test_disparities_that_the_engine_does_not_reach(tmp_path: Path, options: tuple[str, str], says: str) -> None:
    result = _run("stereo", *_pair(tmp_path, -5, 0), "--dense", *options, "--out", tmp_path / "out")
    assert result.exit_code == 1 and f"signum: {says}" in result.stderr
    assert "Traceback" not in result.output and "report it" not in result.output


def test_colours_of_the_wheel_and_of_a_field(tmp_path: Path) -> None:
    colours, strength = wheel_colours(np.array([1.0, 0, -1, 0, 0, 5]), np.array([0.0, 1, 0, -1, 0, 0]))
    assert colours[0].tolist() == colours[5].tolist() == [0, 0, 255], "right is red"
    assert colours[2].tolist() == [255, 255, 0], "left is cyan" and strength.tolist() == [1, 1, 1, 1, 0, 1]
    assert colours[4].tolist() == [255, 255, 255], "rest is white"
    assert wheel_colours(np.zeros(0), np.zeros(0))[0].shape == (0, 3), "nothing to colour"
    x, y = np.arange(20.0, 140, 8), np.arange(20.0, 80, 8)
    dx = np.full((y.size, x.size), 3.0)
    dx[:, :4] = np.nan
    frame = read_picture(_pair(tmp_path, 0, 0)[0])
    shown = draw_wheel_flow(frame, FlowField(x, y, dx, 0 * dx, 1 + 0 * dx))
    assert shown.shape == (96, 156, 3)
    assert (shown[40, 18:44].std(axis=-1) == 0).mean() > 0.8, "grey where nothing is valid"
    assert (shown[24:30, 60:100, 2].astype(int) - shown[24:30, 60:100, 0] > 80).mean() > 0.8
