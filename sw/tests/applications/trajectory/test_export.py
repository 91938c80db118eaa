# SPDX-License-Identifier: Apache-2.0
"""Trajectories that are exported, read back by rosbags and as `evo` reads TUM's text."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.common.arrays import Floats
from signum.tables.schemas import GROUND, HOLD, NAVIGATE, POSES
from signum.tables.table import csv_line

BEGAN = 1_650_000_000.5
HELD = [[0, "0.000", 0, 0, 0, 1, 2, 100, 9, 9, "0.001", 0],
        [1, "0.100", "0.5", "0.2", 30, "0.8", "2.5", 90, 9, 9, "0.002", 0],
        [2, "0.200", "", "", "", "", "", 0, 0, 9, "", ""],
        [3, "0.300", "-0.1", "-0.3", -170, "1.25", "1.6", 80, 9, 9, "0.002", 0]]
"""Rows of `hold.csv`: half a metre ahead and to the right, turned to the right and higher; lost; behind and lower."""
POSED = [["a", "7.0", 100, 50, 0, 1], ["b", "7.5", 300, 50, 90, "1.1"]]
CAMERA = """%YAML:1.0
---
image_width: 320
image_height: 240
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 300., 0., 160., 0., 301., 120., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2, 0.05, 0.001, 0.002, 0.01 ]
"""


def _table(path: Path, columns: tuple[str, ...], rows: list[list[Any]]) -> None:
    path.write_text("".join(map(csv_line, [columns, *rows])))


@pytest.fixture
def held(tmp_path: Path) -> Path:
    """The folder of a hold."""
    _table(tmp_path / "hold.csv", HOLD, HELD)
    (tmp_path / "run-hold.jsonl").write_text(json.dumps({"source": "x", "live": False, "began_s": BEGAN}) + "\n")
    return tmp_path


def _export(*arguments: str | Path) -> Result:
    return CliRunner().invoke(application("export"), ["export", *map(str, arguments)])


def _tum(path: Path) -> tuple[Floats, Floats, Floats]:
    """Stamps, positions (n, 3) and quaternions (n, 4) x, y, z, w, as evo's `read_tum_trajectory_file` takes them: eight
    numbers a line, separated by spaces, ascending stamps and quaternions of length 1."""
    rows = np.array([line.split(" ") for line in path.read_text().splitlines() if not line.startswith("#")], float)
    assert rows.shape[1] == 8 and (np.diff(rows[:, 0]) > 0).all()
    assert np.linalg.norm(rows[:, 4:], axis=1) == pytest.approx(1.0, abs=1e-8)
    return rows[:, 0], rows[:, 1:4], rows[:, 4:]


def _yaw(q: Floats) -> Floats:
    return np.asarray(np.degrees(2 * np.arctan2(q[..., 2], q[..., 3])))


def _turned(q: Any, vector: tuple[float, float, float]) -> Floats:
    """A vector in the axes of the parent, by a quaternion message."""
    axis, v = np.array([q.x, q.y, q.z]), np.array(vector)
    twice = 2 * np.cross(axis, v)
    return np.asarray(v + q.w * twice + np.cross(axis, twice))


def test_a_hold_as_text(held: Path) -> None:
    """Ahead is x, right is minus y, farther from the floor is plus z, clockwise is minus yaw; nothing while blind."""
    result = _export(held)
    assert result.exit_code == 0 and "3 poses in `odom`" in result.output and "1 without" in result.output
    stamps, places, turns = _tum(held / "hold.tum")
    assert stamps == pytest.approx(BEGAN + np.array([0.0, 0.1, 0.3]), abs=1e-6)
    assert places == pytest.approx(np.array([[0, 0, 0], [0.5, -0.2, 0.5], [-0.1, 0.3, -0.4]]), abs=1e-6)
    assert _yaw(turns) == pytest.approx([0, -30, 170], abs=1e-5)


def test_a_hold_as_a_bag(held: Path) -> None:
    """By another's reader: what the text has, with its frames, the camera, and velocities that lead from pose to
    pose."""
    (held / "c.yaml").write_text(CAMERA)
    for _ in range(2):  # an earlier export is replaced
        result = _export(held, "--bag", "--calibration", held / "c.yaml")
        assert result.exit_code == 0, result.output
    stamps, places, turns = _tum(held / "hold.tum")
    with AnyReader([held / "hold_bag"]) as reader:
        kinds = {c.topic: c.msgtype for c in reader.connections}
        assert kinds == {"/odom": "nav_msgs/msg/Odometry", "/tf": "tf2_msgs/msg/TFMessage",
                         "/tf_static": "tf2_msgs/msg/TFMessage", "/camera_info": "sensor_msgs/msg/CameraInfo"}
        got: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in kinds}
        for connection, stamp, data in reader.messages():
            got[connection.topic].append((stamp, reader.deserialize(data, connection.msgtype)))
    assert [len(got[t]) for t in ("/odom", "/tf", "/tf_static", "/camera_info")] == [3, 3, 1, 3]
    for k, (logged, odom) in enumerate(got["/odom"]):
        stamp = odom.header.stamp.sec + 1e-9 * odom.header.stamp.nanosec
        assert stamp == pytest.approx(stamps[k], abs=1e-6) and logged == pytest.approx(1e9 * stamp, abs=1000)
        assert (odom.header.frame_id, odom.child_frame_id) == ("odom", "base_link")
        at, q = odom.pose.pose.position, odom.pose.pose.orientation
        assert [at.x, at.y, at.z] == pytest.approx(places[k], abs=1e-6)
        assert [q.x, q.y, q.z, q.w] == pytest.approx(turns[k], abs=1e-8)
        (moved,) = got["/tf"][k][1].transforms
        assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
        assert [moved.transform.translation.x, moved.transform.rotation.z] == pytest.approx([at.x, q.z])
        if k:
            speed, step = odom.twist.twist.linear, stamps[k] - stamps[k - 1]
            assert places[k - 1] + step * _turned(q, (speed.x, speed.y, speed.z)) == pytest.approx(places[k], abs=1e-5)
            spun = np.degrees(odom.twist.twist.angular.z) * step
            assert abs((_yaw(turns[k]) - _yaw(turns[k - 1]) - spun + 180) % 360 - 180) < 1e-4
    (fixed,) = got["/tf_static"][0][1].transforms
    assert (fixed.header.frame_id, fixed.child_frame_id) == ("base_link", "camera_optical_frame")
    assert _turned(fixed.transform.rotation, (0, 0, 1)) == pytest.approx(np.array([0, 0, -1]), abs=1e-9), "looks down"
    assert _turned(fixed.transform.rotation, (1, 0, 0)) == pytest.approx(np.array([0, -1, 0]), abs=1e-9), "x is right"
    info = got["/camera_info"][0][1]
    assert (info.width, info.height, info.distortion_model) == (320, 240, "plumb_bob")
    assert info.k[[0, 2, 4, 5]].tolist() == [300, 160, 301, 120] and info.d.tolist() == [-0.2, 0.05, 0.001, 0.002, 0.01]
    assert "transient_local" in (held / "hold_bag/metadata.yaml").read_text()


def test_a_mosaic_s_poses_lie_on_the_ground(tmp_path: Path) -> None:
    """The plane is turned by a quarter: its x axis points south."""
    _table(tmp_path / "poses.csv", POSES, POSED)
    _table(tmp_path / "poses-2.csv", POSES, POSED)
    _table(tmp_path / "ground.csv", GROUND, [[1, "0.002", 90, 5000, 8000, 32755], [2, "0.004", 0, 1, 2, 0]])
    result = _export(tmp_path, "--bag", "--range", "2")
    assert result.exit_code == 0, result.output
    stamps, places, turns = _tum(tmp_path / "poses.tum")
    assert stamps.tolist() == [7.0, 7.5]
    assert places == pytest.approx(np.array([[5000 - 0.1, 8000 - 0.2, 0], [5000 - 0.1, 8000 - 0.6, 0.2]]), abs=1e-6)
    assert _yaw(turns) == pytest.approx([0, -90], abs=1e-5), "east, then south"
    assert _tum(tmp_path / "poses-2.tum")[1][0] == pytest.approx([1.4, 1.8, 0], abs=1e-6)
    with AnyReader([tmp_path / "poses_bag"]) as reader:
        poses: list[Any] = [reader.deserialize(data, c.msgtype) for c, _, data in reader.messages(
            [c for c in reader.connections if c.topic == "/mosaic/pose"])]
    assert [p.header.frame_id for p in poses] == ["map"] * 2
    assert poses[1].pose.position.y == pytest.approx(places[1, 1])


def test_a_navigated_mosaic_gives_metres(tmp_path: Path) -> None:
    _table(tmp_path / "navigate.csv", NAVIGATE, [["a", "", 10, 20, 0, 1, "0.9", 90], ["b", "", "", "", "", "", 0, 0],
                                                 ["c", "", 30, 20, 90, 1, "0.9", 90]])
    (tmp_path / "m").mkdir()
    (tmp_path / "m/mosaic.pgw").write_text("0.5\n0.0\n0.0\n-0.5\n100.0\n200.0\n")
    result = _export(tmp_path, "--mosaic", tmp_path / "m", "--rate", "10")
    assert result.exit_code == 0, result.output
    stamps, places, turns = _tum(tmp_path / "navigate.tum")
    assert stamps == pytest.approx([0.0, 0.2])
    assert places == pytest.approx(np.array([[105, 190, 0], [115, 190, 0]])) and _yaw(turns) == pytest.approx([90, 0])


@pytest.mark.parametrize(("table", "options", "says"), [
    (None, (), "no hold.csv, poses.csv or navigate.csv"), ("poses", (), "--pixel METRES"),
    ("navigate", (), "--mosaic"), ("navigate", ("--pixel", "0.01"), "give their --rate"),
    ("navigate", ("--mosaic", "nowhere"), "no such file"), ("poses", ("--no-tum",), "nothing to write"),
    ("poses", ("--calibration", "c.yaml"), "which --bag writes"),
    ("late", ("--pixel", "0.01", "--bag", "--no-tum"), "no stamps of ROS")])
def test_what_is_missing_is_one_line(tmp_path: Path, table: str | None, options: tuple[str, ...], says: str) -> None:
    if table in ("poses", "late"):
        _table(tmp_path / "poses.csv", POSES, POSED if table == "poses" else [["a", "1e10", 1, 1, 0, 1]])
    elif table:
        _table(tmp_path / "navigate.csv", NAVIGATE, [["a", "", 10, 20, 0, 1, "0.9", 90]])
    result = _export(tmp_path, *options)
    line = result.output.strip()
    assert result.exit_code == 1 and says in line and line.startswith("signum: ") and "\n" not in line, line
    assert not list(tmp_path.glob("*.tum"))
