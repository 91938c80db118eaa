# SPDX-License-Identifier: Apache-2.0
"""Calibrations that bags hold: CameraInfo of ROS 1 and 2, foxglove.CameraCalibration; and frames of other sizes than
their calibration's, as the commands meet them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from typer.testing import CliRunner

from signum.commands.cli import application
from signum.commands.ground import GroundOptions
from signum.geometry.calibration import CalibrationError
from signum.sources.open import open_lens, open_rig, open_source
from tests.fuzz.corpus import SIZE, calibration, frames

KINDS = "ros1", "sqlite3", "mcap"
K = np.array([300.0, 0, 160, 0, 300, 120, 0, 0, 1])
EYE = np.eye(3).ravel()
WIDE = 0.3, -0.05, 0.02, -0.01


def _info(store: Any, ros1: bool, shift: float = 0.0, model: str = "plumb_bob",
          d: tuple[float, ...] = (-0.2, 0.05, 0, 0, 0), binning: tuple[int, int] = (0, 0),
          roi: tuple[int, int, int, int] = (0, 0, 0, 0)) -> Any:
    time = store.types["builtin_interfaces/msg/Time"](3, 0)
    header = store.types["std_msgs/msg/Header"](**({"seq": 0} if ros1 else {}), stamp=time, frame_id="camera")
    x, y, width, height = roi
    part = store.types["sensor_msgs/msg/RegionOfInterest"](x, y, height, width, False)
    p = np.array([300.0, 0, 160, -300.0 * shift, 0, 300, 120, 0, 0, 0, 1, 0])
    return store.types["sensor_msgs/msg/CameraInfo"](header, 240, 320, model, np.array(d, np.float64), K, EYE, p,
                                                     *binning, part)


def _bag(folder: Path, kind: str, topics: dict[str, dict[str, Any]]) -> Path:
    """A bag with a CameraInfo on each topic."""
    ros1 = kind == "ros1"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    path = folder / ("dive.bag" if ros1 else f"dive_{kind}")
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    writer: Any = Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=plugin)
    name = "sensor_msgs/msg/CameraInfo"
    with writer:
        for topic, how in topics.items():
            connection = writer.add_connection(topic, name, typestore=store)
            message = _info(store, ros1, **how)
            writer.write(connection, 1000, (store.serialize_ros1 if ros1 else store.serialize_cdr)(message, name))
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_a_camera_and_a_pair_in_a_bag(tmp_path: Path, kind: str) -> None:
    path = _bag(tmp_path, kind, {"/left/camera_info": {}, "/right/camera_info": {"shift": 0.12},
                                 "/wide/camera_info": {"model": "equidistant", "d": WIDE}})
    lens = open_lens(f"{path}#/wide/camera_info")
    assert lens.fisheye and lens.size == (320, 240) and lens.distortion.tolist() == list(WIDE)
    plain = open_lens(f"{path}#/left/camera_info")
    assert not plain.fisheye and plain.matrix.ravel().tolist() == K.tolist() and plain.distortion[0] == -0.2
    rig = open_rig(f"{path}#/left/camera_info,/right/camera_info")
    assert rig.rectifier().geometry.baseline == pytest.approx(0.12)
    for name, says in ((path, r"name one, e\.g\. '.*#/left/camera_info'"),
                       (f"{path}#/none", "no CameraInfo on /none; it has /left")):
        with pytest.raises(CalibrationError, match=says):
            open_lens(name)
    with pytest.raises(CalibrationError, match="the left and the right one"):
        open_rig(f"{path}#/wide/camera_info")


def test_the_only_ones_in_a_bag_need_no_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert open_lens(_bag(tmp_path, "mcap", {"/info": {}}) / "dive_mcap.mcap").focal == 300
    path = _bag(tmp_path, "sqlite3", {"/right/info": {"shift": 0.12}, "/left/info": {}})
    assert open_rig(path).rectifier().geometry.baseline == pytest.approx(0.12)
    assert not capsys.readouterr().err, "left is first by its name"
    assert open_rig(f"{path}#/right/info,/left/info").rectifier().geometry.baseline == pytest.approx(0.12)
    assert "to the right of the second" in capsys.readouterr().err


def test_a_driver_s_region_and_binning_are_followed(tmp_path: Path) -> None:
    path = _bag(tmp_path, "sqlite3", {"/binned": {"binning": (2, 2)}, "/part": {"roi": (40, 20, 160, 120)},
                                      "/both": {"binning": (2, 2), "roi": (40, 20, 160, 120)}})
    binned, part, both = (open_lens(f"{path}#/{name}") for name in ("binned", "part", "both"))
    assert (binned.size, part.size, both.size) == ((160, 120), (160, 120), (80, 60))
    assert binned.matrix[:2].tolist() == [[150, 0, 79.75], [0, 150, 59.75]]
    assert part.matrix[:2].tolist() == [[300, 0, 120], [0, 300, 100]]
    assert both.matrix[:2].tolist() == [[150, 0, 59.75], [0, 150, 49.75]]


def test_foxglove_s_calibration(tmp_path: Path) -> None:
    path = tmp_path / "dive.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        schema = writer.register_schema("foxglove.CameraCalibration", "jsonschema", b"{}")
        channel = writer.register_channel("/camera", "json", schema)
        message = {"timestamp": {"sec": 1, "nsec": 0}, "frame_id": "c", "width": 320, "height": 240,
                   "distortion_model": "rational_polynomial", "D": [0.1] * 8, "K": K.tolist(), "R": EYE.tolist(),
                   "P": []}
        writer.add_message(channel, 0, json.dumps(message).encode(), 0)
        writer.finish()  # type: ignore[no-untyped-call]
    lens = open_lens(path)
    assert lens.size == (320, 240) and lens.distortion.tolist() == [0.1] * 8


def test_a_bag_without_a_calibration(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    path = _bag(tmp_path / "in", "sqlite3", {"/info": {}})
    with pytest.raises(CalibrationError, match="name the left and the right one"):
        open_rig(path)
    from tests.fuzz.corpus import _bag as pictures

    pictures(tmp_path / "dive.bag", frames())
    with pytest.raises(CalibrationError, match=r"no CameraInfo in this bag \(it has /camera\)"):
        open_lens(tmp_path / "dive.bag")


def test_a_rectified_topic_is_not_rectified_again(tmp_path: Path) -> None:
    path, lens = tmp_path / "dive.mcap", calibration(tmp_path / "c.yaml")
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        schema = writer.register_schema("foxglove.RawImage", "jsonschema", b"{}")
        for topic in ("/left/image_rect", "/left/image_rect_color/compressed", "/left/image_raw", "/image_rectangle"):
            writer.add_message(writer.register_channel(topic, "json", schema), 0, b"{}", 0)
        writer.finish()  # type: ignore[no-untyped-call]
    for topic, refused in (("/left/image_rect", True), ("/left/image_rect_color/compressed", True),
                           ("/left/image_raw", False), ("/image_rectangle", False)):
        if refused:
            with pytest.raises(CalibrationError, match="without distortion already"):
                open_source(f"{path}#{topic}", lens)
        else:
            open_source(f"{path}#{topic}", lens)


def test_frames_are_undistorted_by_a_bag_s_own_calibration(tmp_path: Path) -> None:
    path = _bag(tmp_path, "mcap", {"/info": {"d": (-0.4, 0.0, 0.0, 0.0, 0.0)}})
    u, v = np.meshgrid(np.arange(320.0), np.arange(240.0))
    np.save(tmp_path / "ramp.npy", np.rint(np.stack([u * 0.7, v * 0.7])).astype(np.uint8))  # brightness is the place
    across, down = (f.picture for f in open_source(tmp_path / "ramp.npy", path / "dive_mcap.mcap"))
    r2 = ((u - 160)**2 + (v - 120)**2) / 300**2
    inside = np.s_[10:-10, 10:-10]
    for picture, place, centre in ((across, u, 160), (down, v, 120)):
        expected = 0.7 * (centre + (place - centre) * (1 - 0.4 * r2))
        assert np.abs(picture[inside] - expected[inside]).max() < 1.2, "a grey level is 1.4 pixels"


def test_the_focal_length_is_that_of_the_frames(tmp_path: Path) -> None:
    """A calibration at twice the frames' size: metres would otherwise be half as large."""
    np.save(tmp_path / "dive.npy", np.stack(frames()))
    k = np.array([[320.0, 0, 159.5], [0, 320.0, 119.5], [0, 0, 1]])
    path = calibration(tmp_path / "c.yaml", camera_matrix=k, image_width=2 * SIZE[0], image_height=2 * SIZE[1])
    result = CliRunner().invoke(application(), [
        "hold", "--source", str(tmp_path / "dive.npy"), "--calibration", str(path), "--range", "2", "--window", "32",
        "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert "is for 320x240, scaled to the frames' 160x120" in result.stderr
    assert re.search(r"focal length 160 px", (tmp_path / "out" / "report.html").read_text())
    ground = GroundOptions(range_m=2.0).known(open_source(tmp_path / "dive.npy"), path, lambda: SIZE)
    assert ground.pixel_m == pytest.approx(2.0 / 160)


def test_another_aspect_is_refused_with_the_reason(tmp_path: Path) -> None:
    np.save(tmp_path / "dive.npy", np.stack(frames())[:, :90])
    path = calibration(tmp_path / "c.yaml")
    result = CliRunner().invoke(application(), ["flow", str(tmp_path / "dive.npy"), "--calibration", str(path),
                                                "--window", "32", "--out", str(tmp_path / "out")])
    assert result.exit_code == 1 and "aspect" in result.stderr and "160x90" in result.stderr
