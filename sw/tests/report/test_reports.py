# SPDX-License-Identifier: Apache-2.0
"""Commands that measure fields, their files, and reports made from those; undistortion and the simulated source."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from typer.testing import CliRunner, Result

from signum.boards.golden import GoldenBoard
from signum.commands.cli import application
from signum.common.errors import SourceError
from signum.common.files import write_picture
from signum.common.version import VERSION
from signum.geometry.calibration import CalibrationError
from signum.geometry.camera import LOOK_DOWN, Sight
from signum.measure.flow import FlowField, measure_flow
from signum.measure.measurer import Measurer
from signum.sources.files import UndistortedSource
from signum.sources.open import open_source
from signum.sources.simulated import WorldSource
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor, photograph
from signum.world.world import World

app = application()

CAMERA = Pinhole((192, 144), 200.0)


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _calibration(path: Path, entries: dict[str, Any]) -> Path:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in entries.items():
        storage.write(name, value)
    storage.release()
    return path


def _rig(path: Path, baseline: float) -> Path:
    k = np.array([[CAMERA.focal, 0, CAMERA.centre[0]], [0, CAMERA.focal, CAMERA.centre[1]], [0, 0, 1]])
    return _calibration(path, {"image_width": CAMERA.size[0], "image_height": CAMERA.size[1], "K1": k, "K2": k,
                               "D1": np.zeros(5), "D2": np.zeros(5), "R": np.eye(3),
                               "T": np.array([[-baseline], [0.0], [0.0]])})


def test_stereo_of_folders(tmp_path: Path) -> None:
    world = World(Seafloor(extent=4.0, texel=0.005))
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
    for k in range(2):
        pair = world.look_pair(CAMERA, Sight(np.array([0.2 * k, 0, -1.5]), LOOK_DOWN), 0.1)
        for side, shot in zip(("left", "right"), pair, strict=True):
            write_picture(tmp_path / side / f"{side}{k}.png", shot.frame)
    out = tmp_path / "out"
    result = _run("stereo", tmp_path / "left", tmp_path / "right", "--calibration", _rig(tmp_path / "rig.yaml", 0.1),
                  "--most", "30", "--out", out)
    assert result.exit_code == 0, result.output
    rows = [r for r in _rows(out / "disparity.csv") if r["valid"] == "1"]
    assert {r["frame"] for r in rows} == {"left0", "left1"} and len(rows) > 200
    assert np.median([float(r["range_m"]) for r in rows]) == pytest.approx(1.5, abs=0.02)
    grid = tifffile.imread(out / "range_left0.tiff")
    assert grid.dtype == np.float32 and np.nanmedian(grid) == pytest.approx(1.5, abs=0.02)
    lines = (out / "points_left1.ply").read_text().splitlines()
    assert lines[0] == "ply" and len(lines) == 7 + int(lines[2].split()[-1]) > 100
    page = (out / "report.html").read_text()
    assert page.count("data:image/png") == 3 and "http" not in page


def test_stereo_says_what_is_wrong(tmp_path: Path) -> None:
    for side, count in (("left", 2), ("right", 1)):
        (tmp_path / side).mkdir()
        for k in range(count):
            write_picture(tmp_path / side / f"{k}.png", photograph("gravel")[:144, :192])
    result = _run("stereo", tmp_path / "left", tmp_path / "right", "--out", tmp_path / "out")
    assert result.exit_code == 1 and "fewer frames than" in result.stderr
    assert {r["frame"] for r in _rows(tmp_path / "out" / "disparity.csv")} == {"0"}, "what was finished is kept"
    assert (tmp_path / "out" / "report.html").exists() and not (tmp_path / "out" / "points.ply").exists()


def test_flow_of_the_simulated_world_and_its_report_anew(tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = _run("flow", "world:frames=4,speed=0.2,relief=0", "--out", out)
    assert result.exit_code == 0, result.output
    rows = _rows(out / "flow.csv")
    assert {(r["frame_a"], r["frame_b"]) for r in rows} == {("0", "1"), ("1", "2"), ("2", "3")}
    down = [float(r["dy_px"]) for r in rows if r["valid"] == "1"]
    assert np.median(down) == pytest.approx(0.2 / 5 / 2 * 400, abs=1.5), "forward is up, so the scene moves down"
    capture = cv2.VideoCapture(str(out / "flow.mp4"))
    assert capture.get(cv2.CAP_PROP_FRAME_COUNT) == 3
    assert (out / "flow_0.png").exists() and not (out / "flow_1.png").exists()
    first = (out / "report.html").read_text()
    for says in ("clocks a frame", "host, frames/s", "--window 64", "world:frames=4", "refused", VERSION):
        assert says in first
    assert _run("report", out).exit_code == 0
    assert (out / "report.html").read_text() == first


def test_reports_of_anything_and_of_nothing(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", np.zeros((20, 30), np.uint8))
    (tmp_path / "log.csv").write_text("t,depth\n0,1.5\n1,2.5\n2,nothing\n3")
    assert _run("report", tmp_path).exit_code == 0
    page = (tmp_path / "report.html").read_text()
    assert "log.csv: 3 rows" in page and "data:image/png" in page
    (tmp_path / "empty").mkdir()
    for folder, says in (("none", "no such folder"), ("empty", "no table or picture in it")):
        result = _run("report", tmp_path / folder)
        assert result.exit_code == 1 and says in result.stderr
    (tmp_path / "empty" / "track.csv").write_text("frame,what\n")
    assert "has no column feature" in _run("report", tmp_path / "empty").stderr


def test_exchanged_pictures_are_said(tmp_path: Path) -> None:
    world = World(Seafloor(extent=4.0, texel=0.005))
    for side, shot in zip("lr", world.look_pair(CAMERA, Sight(np.array([0.0, 0, -1.5]), LOOK_DOWN), 0.1), strict=True):
        write_picture(tmp_path / f"{side}.png", shot.frame)
    rig = _rig(tmp_path / "rig.yaml", 0.1)
    for order, said in (("rl", True), ("lr", False)):
        result = _run("stereo", *(tmp_path / f"{side}.png" for side in order), "--calibration", rig, "--step", "16",
                      "--out", tmp_path / order)
        assert result.exit_code == int(said) and ("the pictures look exchanged" in result.stderr) is said, result.output


def test_drift_is_stated(tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = _run("track", "world:frames=9,water=clear,speed=0.6", "--features", "8", "--window", "48", "--out", out)
    assert result.exit_code == 0, result.output
    drift = _rows(out / "drift.csv")
    assert len(drift) == 9 and all(int(r["direct"]) <= int(r["valid"]) for r in drift)
    assert "cannot drift" in (out / "report.html").read_text()
    invalid: dict[str, int] = {}
    for r in _rows(out / "track.csv"):
        invalid[r["feature"]] = 0 if r["valid"] == "1" else invalid.get(r["feature"], 0) + 1
    assert 0 < max(invalid.values()) <= 5, "features lost for long have no rows"


def test_undistortion(tmp_path: Path) -> None:
    k, d = np.array([[200.0, 0, 95.5], [0, 200.0, 71.5], [0, 0, 1]]), np.array([-0.3, 0.1, 0, 0, 0])
    path = _calibration(tmp_path / "camera.yaml", {"image_width": 192, "image_height": 144, "camera_matrix": k,
                                                   "distortion_coefficients": d})
    true = np.asarray(cv2.GaussianBlur(photograph("gravel")[:144, :192].astype(np.float32), (0, 0), 1.5), np.uint8)
    u, v = np.meshgrid(np.arange(192.0), np.arange(144.0))
    bent = np.asarray(cv2.undistortPoints(np.stack([u, v], -1).reshape(-1, 1, 2), k, d, P=k), np.float32)
    bent = bent.reshape(144, 192, 2)
    (tmp_path / "in").mkdir()
    write_picture(tmp_path / "in" / "1.png", cv2.remap(true, bent[..., 0], bent[..., 1], cv2.INTER_CUBIC))
    source = open_source(tmp_path / "in", path)
    assert isinstance(source, UndistortedSource) and source.snapshots and source.count == 1
    (frame,) = source
    inside = np.s_[20:-20, 20:-20]
    assert np.abs(frame.picture[inside].astype(float) - true[inside]).mean() < 1.5
    write_picture(tmp_path / "in" / "1.png", true[:100])
    with pytest.raises(CalibrationError, match=r"frame 1: is for 192x144 \(aspect 1.333\), the frames are 192x100"):
        list(open_source(tmp_path / "in", path))
    with pytest.raises(CalibrationError, match=r"no such file.*\(expected: calibration\)"):
        open_source(tmp_path / "in", tmp_path / "none.yaml")


def test_the_simulated_source_is_the_same_for_a_seed() -> None:
    frames = [[f.picture for f in open_source(f"world:frames=2,seed={s}")] for s in (3, 3, 4)]
    assert all(np.array_equal(a, b) for a, b in zip(frames[0], frames[1], strict=True))
    assert not np.array_equal(frames[0][0], frames[2][0])
    for text, says in (("world:fames=3", "none of frames=100"), ("world:frames=x", "none of"),
                       ("world:water=beer", "water is one of clear"), ("world:speed=0", "expected a number from")):
        with pytest.raises(SourceError, match=says):
            WorldSource.named(text)


def test_a_lone_vector_needs_a_neighbour_that_agrees() -> None:
    photo = photograph("gravel")
    before, after = photo[:240, :320].copy(), photo[4:244, 6:326].copy()
    before[86:122, 86:122] = after[86:122, 86:122] = photo[300:336, 300:336]  # a window that stays while all else moves
    measurer = Measurer(GoldenBoard(), (320, 240), 1.5)
    views = measurer.view(before), measurer.view(after)

    def at(field: FlowField) -> bool:
        j, i = int(np.argmin(np.abs(field.y - 104))), int(np.argmin(np.abs(field.x - 104)))
        return bool(field.valid[j, i])

    free, checked = (measure_flow(measurer, *views, (32, 32), 44, support=s) for s in (0, 1))
    assert at(free) and not at(checked)
    assert checked.valid.sum() >= 0.8 * free.valid.sum()


def test_a_page_whose_run_cannot_be_read_is_made_without_it(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert _run("flow", "world:frames=2,speed=0.2,relief=0", "--out", out).exit_code == 0
    page = out / "report.html"
    page.write_text(page.read_text().replace('"frames": 2', '"frames": "two"'))
    result = _run("report", out)
    assert result.exit_code == 0 and "what it says of its run cannot be read" in result.stderr
    assert "clocks a frame" not in page.read_text()


def test_a_table_of_an_earlier_version_without_times_is_reported(tmp_path: Path) -> None:
    (tmp_path / "track.csv").write_text("frame,feature,x_px,y_px,dx_px,dy_px,score,margin,valid\n"
                                        "0,0,1,1,0,0,0.9,0.2,1\n")
    assert _run("report", tmp_path).exit_code == 0
