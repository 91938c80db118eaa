# SPDX-License-Identifier: Apache-2.0
"""Calibrations as OpenCV, ROS and Kalibr write them: each takes the distortion out as the model's own equation says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from signum.geometry.calibration import CalibrationError, read_lens, read_mono, read_rig, read_stereo
from signum.sources.open import open_lens, open_rig

SIZE = 320, 240
FOCAL, CENTRE = 300.0, (160.0, 120.0)
STRAIGHT = -0.2, 0.05, 0.001, -0.002, 0.0
RATIONAL = 0.4, -0.1, 0.001, -0.002, 0.02, 0.6, -0.05, 0.01
WIDE = 0.3, -0.05, 0.02, -0.01
TOLERANCE_PX = 1e-3


def _expected(model: str, u: NDArray[Any], v: NDArray[Any], scale: float = 1.0) -> NDArray[Any]:
    """Where pixels of the picture without distortion are in the camera's, by the equations of OpenCV's documentation.

    Args:
        model: plumb_bob, rational_polynomial or equidistant.
        u: pixels across.
        v: pixels down.
        scale: of the pictures, against the calibration's.
    """
    def pixel(x: NDArray[Any], axis: int) -> NDArray[Any]:
        return np.asarray((x * FOCAL + CENTRE[axis] + 0.5) * scale - 0.5)

    x, y = (((w + 0.5) / scale - 0.5 - c) / FOCAL for w, c in zip((u, v), CENTRE, strict=True))
    r = np.hypot(x, y)
    if model == "equidistant":
        angle = np.arctan(r)
        bent = angle * (1 + sum(k * angle ** (2 * n + 2) for n, k in enumerate(WIDE)))
        factor = np.where(r > 0, bent / np.where(r > 0, r, 1), 1)
        return np.stack([pixel(x * factor, 0), pixel(y * factor, 1)])
    k1, k2, p1, p2, k3, k4, k5, k6 = RATIONAL if model == "rational_polynomial" else (*STRAIGHT, 0, 0, 0)
    factor = (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / (1 + k4 * r**2 + k5 * r**4 + k6 * r**6)
    return np.stack([pixel(x * factor + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2), 0),
                     pixel(y * factor + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y, 1)])


def _ros(model: str, numbers: tuple[float, ...]) -> str:
    k = [FOCAL, 0.0, CENTRE[0], 0.0, FOCAL, CENTRE[1], 0.0, 0.0, 1.0]
    return (f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\ncamera_name: narrow\n"
            f"camera_matrix:\n  rows: 3\n  cols: 3\n  data: {k}\ndistortion_model: {model}\n"
            f"distortion_coefficients:\n  rows: 1\n  cols: {len(numbers)}\n  data: [{', '.join(map(str, numbers))}]\n"
            "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
            f"projection_matrix:\n  rows: 3\n  cols: 4\n  data: [{FOCAL}, 0, 160, 0, 0, {FOCAL}, 120, 0, 0, 0, 1, 0]\n")


def _echo(model: str, numbers: tuple[float, ...]) -> str:
    """What `ros2 topic echo` prints of a CameraInfo message."""
    rows = "\n".join(f"- {n}" for n in numbers)
    k = "\n".join(f"- {n}" for n in (FOCAL, 0.0, CENTRE[0], 0.0, FOCAL, CENTRE[1], 0.0, 0.0, 1.0))
    return (f"header:\n  frame_id: camera\nheight: {SIZE[1]}\nwidth: {SIZE[0]}\ndistortion_model: {model}\nd:\n{rows}\n"
            f"k:\n{k}\nbinning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n---\n")


def _kalibr_camera(model: str, numbers: tuple[float, ...], name: str = "cam0") -> str:
    return (f"{name}:\n  camera_model: pinhole\n  distortion_coeffs: [{', '.join(map(str, numbers))}]\n"
            f"  distortion_model: {model}\n  intrinsics: [{FOCAL}, {FOCAL}, {CENTRE[0]}, {CENTRE[1]}]\n"
            f"  resolution: [{SIZE[0]}, {SIZE[1]}]\n  rostopic: /{name}/image_raw\n")


def _opencv(numbers: tuple[float, ...], extra: str = "") -> str:
    k = FOCAL, 0.0, CENTRE[0], 0.0, FOCAL, CENTRE[1], 0.0, 0.0, 1.0
    return (f"%YAML:1.0\n---\nimage_width: {SIZE[0]}\nimage_height: {SIZE[1]}\n{extra}"
            f"camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {', '.join(map(str, k))} ]\n"
            f"distortion_coefficients: !!opencv-matrix\n   rows: {len(numbers)}\n   cols: 1\n   dt: d\n"
            f"   data: [ {', '.join(map(str, numbers))} ]\n")


FILES = {
    "ros": ("plumb_bob", _ros("plumb_bob", STRAIGHT)),
    "ros, short numbers": ("plumb_bob", _ros("plumb_bob", STRAIGHT).replace("0.001", "1e-3")),
    "ros, rational": ("rational_polynomial", _ros("rational_polynomial", RATIONAL)),
    "ros, fisheye": ("equidistant", _ros("equidistant", WIDE)),
    "ros, fisheye with a fifth": ("equidistant", _ros("equidistant", (*WIDE, 0.0))),
    "ros, printed message": ("equidistant", _echo("equidistant", WIDE)),
    "kalibr": ("plumb_bob", _kalibr_camera("radtan", STRAIGHT[:4])),
    "kalibr, fisheye": ("equidistant", _kalibr_camera("equidistant", WIDE)),
    "opencv": ("plumb_bob", _opencv(STRAIGHT)),
    "opencv without its head": ("plumb_bob", _opencv(STRAIGHT).removeprefix("%YAML:1.0\n---\n")),
    "opencv, fisheye": ("equidistant", _opencv(WIDE, "fisheye_model: 1\n")),
    "opencv, no fisheye": ("plumb_bob", _opencv(STRAIGHT[:4], "fisheye_model: 0\n")),
}
"""Model and text of files with the same camera."""


@pytest.mark.parametrize("name", FILES)
def test_every_format_takes_the_distortion_out(tmp_path: Path, name: str) -> None:
    model, text = FILES[name]
    (tmp_path / "c.yaml").write_text(text)
    lens = read_lens(tmp_path / "c.yaml")
    assert lens.size == SIZE and lens.fisheye == (model == "equidistant") and lens.focal == FOCAL
    u, v = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    assert np.abs(np.stack(lens.maps()) - _expected(model, u, v)).max() < TOLERANCE_PX
    if lens.fisheye:
        with pytest.raises(CalibrationError, match="fisheye lens"):
            read_mono(tmp_path / "c.yaml")


@pytest.mark.parametrize("fisheye", [False, True])
def test_rays_and_pixels_are_each_other_s_inverse(tmp_path: Path, fisheye: bool) -> None:
    (tmp_path / "c.yaml").write_text(FILES["ros, fisheye" if fisheye else "ros"][1])
    lens = read_lens(tmp_path / "c.yaml")
    pixels = np.random.default_rng(0).uniform((0, 0), SIZE, (200, 2))
    rays = lens.rays(pixels)
    there = lens.project(np.c_[rays, np.ones(200)])
    assert np.abs(there - pixels).max() < TOLERANCE_PX
    expected = _expected("equidistant" if fisheye else "plumb_bob", *(rays * FOCAL + CENTRE).T)
    assert np.abs(expected.T - pixels).max() < TOLERANCE_PX


@pytest.mark.parametrize("size", [(640, 480), (160, 120)])
@pytest.mark.parametrize("name", ["opencv", "ros, fisheye"])
def test_a_calibration_of_another_resolution_is_scaled(tmp_path: Path, name: str, size: tuple[int, int]) -> None:
    model, text = FILES[name]
    (tmp_path / "c.yaml").write_text(text)
    lens = read_lens(tmp_path / "c.yaml").scaled(size)
    scale = size[0] / SIZE[0]
    u, v = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    assert lens.size == size and lens.focal == FOCAL * scale
    assert np.abs(np.stack(lens.maps()) - _expected(model, u, v, scale)).max() < TOLERANCE_PX


def test_only_another_resolution_is_scaled(tmp_path: Path) -> None:
    (tmp_path / "c.yaml").write_text(_opencv(STRAIGHT))
    lens = read_lens(tmp_path / "c.yaml")
    for size in ((320, 180), (240, 320), (320, 200), (640, 478)):
        with pytest.raises(CalibrationError, match="aspect"):
            lens.scaled(size)
    for size in ((213, 160), (107, 80)):  # thirds: the height is not whole
        assert lens.scaled(size).size == size


@pytest.mark.parametrize(("text", "says"), [
    (_ros("equidistant", (*WIDE, 0.1)), "has 5 coefficients; expected 4"),
    (_ros("plumb_bob", STRAIGHT[:3]), "distortion_coefficients has shape 1x3"),
    (_ros("thin_prism", STRAIGHT), "distortion_model is 'thin_prism'; expected one of"),
    (_kalibr_camera("equidistant", WIDE).replace("pinhole", "omni"), "camera_model is omni; expected pinhole"),
    (_kalibr_camera("fov", WIDE[:1]), "distortion_model is 'fov'; expected"),
    (_kalibr_camera("radtan", STRAIGHT[:4]) + _kalibr_camera("radtan", STRAIGHT[:4], "cam1"), "#cam0"),
    (_kalibr_camera("radtan", STRAIGHT[:4]).replace("[320, 240]", "[320]"), "resolution has shape 1; expected 2"),
    (_kalibr_camera("radtan", STRAIGHT[:4]).replace("intrinsics", "intrinsic"), "has no intrinsics"),
    (_ros("plumb_bob", STRAIGHT).replace(f"data: [{FOCAL}, 0.0, 160.0, 0.0, {FOCAL}, 120.0, 0.0, 0.0, 1.0]",
                                         f"data: {[0.0] * 9}"), "was not calibrated"),
    (_opencv(STRAIGHT).replace("300.0, 0.0", "300.0, 4.0", 1), "a skew of 4"),
    (_ros("plumb_bob", STRAIGHT).replace("rows: 3", "rows: yes", 1), "rows or cols is no whole number"),
    ("a: &a [1, 2]\nb: [*a, *a]\n", "not an OpenCV YAML file"), ("- 1\n- 2\n", "it has no entries"),
    ("- " * 400 + "1", "32 deep"), ("a: [1, 2\nb: 3\n", r"not an OpenCV YAML file.*\(line"),
])
def test_what_cannot_be_used_is_said(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "c.yaml").write_text(text)
    with pytest.raises(CalibrationError, match=says) as error:
        read_lens(tmp_path / "c.yaml")
    assert str(error.value).startswith(f"{tmp_path / 'c.yaml'}") and "\n" not in str(error.value)


TURN = np.asarray(cv2.Rodrigues(np.array([0.01, -0.02, 0.015]))[0], np.float64)
MOVE = -TURN @ np.array([0.12, 0.002, -0.001])
"""The second camera sits 12 cm to the right of the first."""


def _kalibr_pair(model: str = "radtan", numbers: tuple[float, ...] = STRAIGHT[:4]) -> str:
    pose = np.vstack([np.c_[TURN, MOVE], [0, 0, 0, 1]])
    rows = "".join(f"  - [{', '.join(f'{v:.12g}' for v in line)}]\n" for line in pose)
    return (_kalibr_camera(model, numbers) + _kalibr_camera(model, numbers, "cam1") + f"  T_cn_cnm1:\n{rows}")


def _opencv_pair(path: Path, turn: NDArray[Any] = TURN, move: NDArray[Any] = MOVE, **more: Any) -> Path:
    k = np.array([[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]])
    k2 = k + np.diag([4.0, 4.0, 0.0])
    values: dict[str, Any] = {"image_width": SIZE[0], "image_height": SIZE[1], "K1": k, "D1": np.array([STRAIGHT]),
                              "K2": k2, "D2": np.array([STRAIGHT]), "R": turn, "T": move.reshape(3, 1)}
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in (values | more).items():
        storage.write(name, value)
    storage.release()
    return path


def _ros_pair(folder: Path) -> str:
    """Two files as ROS' cameracalibrator writes them, with the rectification of OpenCV."""
    k = np.array([[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]])
    d = np.array(STRAIGHT)
    r1, r2, p1, p2, *_ = cv2.stereoRectify(k, d, k, d, SIZE, TURN, MOVE.reshape(3, 1), alpha=0)
    for name, r, p in (("left", r1, p1), ("right", r2, p2)):
        head, _, _ = _ros("plumb_bob", STRAIGHT).partition("rectification_matrix")
        (folder / f"{name}.yaml").write_text(
            f"{head}rectification_matrix:\n  rows: 3\n  cols: 3\n  data: {np.asarray(r).ravel().tolist()}\n"
            f"projection_matrix:\n  rows: 3\n  cols: 4\n  data: {np.asarray(p).ravel().tolist()}\n")
    return f"{folder}/left.yaml,{folder}/right.yaml"


def _meeting(name: str | Path) -> tuple[float, float]:
    """How well the rays meet of rectified pixels that a disparity makes a pair: how many pixels of the cameras' own
    pictures they miss the point between them, and the error of its range as a share, at most."""
    rig = open_rig(name).in_metres().ordered()
    rectify = rig.rectifier()
    rng = np.random.default_rng(1)
    u, v, d = rng.integers(40, SIZE[0], 300), rng.integers(0, SIZE[1], 300), rng.integers(8, 40, 300)
    places = (v, u), (v, u - d)
    pixels = [np.stack([m[at] for m in maps], -1).astype(np.float64)
              for maps, at in zip(rectify.maps, places, strict=True)]
    poses = np.eye(3, 4), np.c_[rig.turn, rig.move]
    rays = [lens.rays(p) for lens, p in zip((rig.first, rig.second), pixels, strict=True)]
    found = np.asarray(cv2.triangulatePoints(poses[0], poses[1], rays[0].T, rays[1].T), np.float64)
    points = (found[:3] / found[3]).T
    again = rig.first.project(points), rig.second.project(points, rig.turn, rig.move)
    missed = max(float(np.abs(a - p).max()) for a, p in zip(again, pixels, strict=True))
    ranges = np.linalg.norm(rectify.geometry.points(u.astype(float), v.astype(float), d.astype(float)), axis=1)
    return missed, float(np.abs(ranges / np.linalg.norm(points, axis=1) - 1).max())


def test_pairs_of_every_format_are_rectified(tmp_path: Path) -> None:
    (tmp_path / "k.yaml").write_text(_kalibr_pair())
    (tmp_path / "f.yaml").write_text(_kalibr_pair("equidistant", WIDE))
    pair = _opencv_pair(tmp_path / "o.yaml")
    wide = _opencv_pair(tmp_path / "w.yaml", D1=np.array([WIDE]), D2=np.array([WIDE]), fisheye_model=1)
    for name in (tmp_path / "k.yaml", tmp_path / "f.yaml", pair, wide, _ros_pair(tmp_path)):
        missed, off = _meeting(name)
        assert missed < TOLERANCE_PX and off < 1e-4, name
        rig = open_rig(name)
        assert np.allclose(rig.turn, TURN, atol=1e-9) and np.allclose(rig.move, MOVE, atol=1e-9), name
        assert open_rig(name).rectifier().geometry.baseline == pytest.approx(0.12, rel=1e-3)
    assert open_lens(f"{tmp_path / 'k.yaml'}#cam1").size == SIZE


def test_millimetres_and_exchanged_cameras_are_recognised_and_said(tmp_path: Path,
                                                                  capsys: pytest.CaptureFixture[str]) -> None:
    good = read_stereo(_opencv_pair(tmp_path / "good.yaml"))
    assert not capsys.readouterr().err
    thousand = read_stereo(_opencv_pair(tmp_path / "mm.yaml", move=1000 * MOVE))
    assert "mm.yaml: T is 120.0 long, which can only be millimetres: taken as 0.1200 m" in capsys.readouterr().err
    k = np.array([[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]])
    swapped = read_stereo(_opencv_pair(tmp_path / "swap.yaml", TURN.T, -TURN.T @ MOVE, K1=k + np.diag([4.0, 4.0, 0.0]),
                                       K2=k))
    said = capsys.readouterr().err
    assert "the first camera sits 0.120 m to the right of the second" in said and "can only be" not in said
    for other in (thousand, swapped):
        assert other.geometry.baseline == pytest.approx(good.geometry.baseline, rel=1e-9)
        for one, two in zip(good.maps, other.maps, strict=True):
            assert np.abs(np.stack(one) - np.stack(two)).max() < TOLERANCE_PX


def test_a_pair_is_scaled_or_refused_as_one_camera_is(tmp_path: Path) -> None:
    path = _opencv_pair(tmp_path / "c.yaml")
    small, large = read_stereo(path), read_stereo(path, (640, 480))
    assert large.size == (640, 480) and large.geometry.focal == pytest.approx(2 * small.geometry.focal, rel=0.01)
    assert large.geometry.baseline == pytest.approx(small.geometry.baseline)
    with pytest.raises(CalibrationError, match="aspect"):
        read_stereo(path, (640, 360))


def test_pairs_that_are_none(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text(_kalibr_camera("radtan", STRAIGHT[:4]))
    with pytest.raises(CalibrationError, match="has one camera"):
        read_rig(tmp_path / "one.yaml")
    for name in ("left", "right"):
        (tmp_path / f"{name}.yaml").write_text(_ros("plumb_bob", STRAIGHT))
    with pytest.raises(CalibrationError, match="no baseline"):
        open_rig(f"{tmp_path}/left.yaml,{tmp_path}/right.yaml")
    text = _kalibr_pair()
    for old, new, says in (("resolution: [320, 240]", "resolution: [640, 480]", "pictures of one size"),
                           ("radtan", "equidistant", "both with the same")):
        (tmp_path / "k.yaml").write_text(text.replace(old, new, 1))
        with pytest.raises(CalibrationError, match=says):
            read_stereo(tmp_path / "k.yaml")
    with pytest.raises(CalibrationError, match="only a pair"):
        read_lens(_opencv_pair(tmp_path / "p.yaml"))
