# SPDX-License-Identifier: Apache-2.0
"""What vehicles really send, command by command: each kind of input gives the motion that is in it, on both boards.

The files are made here as recorders make them: a pan of (6, 2) px a frame over a photograph. The readers' own tests
hold every pixel and format; these hold what a user gets.
"""

from __future__ import annotations

import csv
import struct
import time
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from typer.testing import CliRunner, Result

from signum.commands.cli import application
from signum.commands.session import Session
from signum.common.arrays import Image
from signum.common.files import write_picture
from signum.world.seafloor import photograph

from ..applications.mavlink.ends import receiver

FRAMES, SIZE, STEP = 4, (160, 120), (6, 2)
FLOOR = photograph("gravel")
STORE = get_typestore(Stores.ROS2_HUMBLE)
SECOND = 10**9
BOARDS = pytest.mark.parametrize("board", ["golden", "verilated"])


@pytest.fixture(scope="module", autouse=True)
def no_page() -> Iterator[None]:
    """Plots would take most of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Session, "report_folder", lambda run: None)
        yield


def _view(k: int) -> Image:
    """Frame `k` of the pan, colour."""
    x, y = 60 + STEP[0] * k, 60 + STEP[1] * k
    return np.repeat(FLOOR[y:y + SIZE[1], x:x + SIZE[0], None], 3, 2)


def _grey(k: int) -> Image:
    return np.ascontiguousarray(_view(k)[:, :, 0])


def _run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(application(), [str(a) for a in arguments])


Pair = tuple[float, float, float, float]


def _flow(source: str | Path, out: Path, *options: str | Path) -> list[Pair]:
    """Time, time since the frame before, and median displacement, by `signum flow` for each pair of frames."""
    result = _run("flow", source, "--window", "32", "--step", "32", *options, "--out", out)
    assert result.exit_code == 0, result.output
    pairs: dict[str, list[tuple[float, ...]]] = {}
    with (out / "flow.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            if row["valid"] == "1":
                found = (float(row[name] or "nan") for name in ("time_s", "step_s", "dx_px", "dy_px"))
                pairs.setdefault(row["frame_b"], []).append(tuple(found))
    return [tuple(np.median(rows, axis=0).tolist()) for rows in pairs.values()]


def _is_the_pan(found: Sequence[Pair], times: Sequence[float], within: float = 0.15, fast: int = 1) -> None:
    """The floor goes the other way than the camera, and frames have these times."""
    assert np.array([f[:2] for f in found]) == pytest.approx(
        np.array([(b, b - a) for a, b in pairwise(times)]), abs=1e-6, nan_ok=True)
    motion = [-fast * x for x in STEP]
    assert np.array([f[2:] for f in found]) == pytest.approx(np.array([motion] * len(found)), abs=within)


def _image(k: int, encoding: str, pixels: np.ndarray[Any, Any], stamp: int) -> Any:
    types = STORE.types
    header = types["std_msgs/msg/Header"](
        types["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND), "camera")
    data = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
    if encoding.startswith("compressed:"):
        return types["sensor_msgs/msg/CompressedImage"](header, encoding.removeprefix("compressed:"), data)
    step = pixels.nbytes // len(pixels)
    height = SIZE[1]
    return types["sensor_msgs/msg/Image"](header, height, SIZE[0], encoding, 0, step, data)


def _bag(path: Path, make: Callable[[int], tuple[str, np.ndarray[Any, Any]]], stamps: Sequence[float],
         logged: Sequence[float] | None = None, order: Sequence[int] = range(FRAMES), **how: Any) -> Path:
    """A ROS 2 bag of the frames in an order; frame `k` is stamped `stamps[k]`, the n-th recorded at `logged[n]`."""
    plugin = StoragePlugin.SQLITE3 if how.get("plugin") == "sqlite3" else StoragePlugin.MCAP
    writer = Writer(path, version=9, storage_plugin=plugin)
    if "mode" in how:
        writer.set_compression(how["mode"], CompressionFormat.ZSTD)
    with writer:
        connection = None
        for n, k in enumerate(order):
            encoding, pixels = make(k)
            message = _image(k, encoding, pixels, round(stamps[k] * SECOND))
            kind = message.__msgtype__
            connection = connection or writer.add_connection("/camera", kind, typestore=STORE)
            when = round((logged[n] if logged else stamps[k]) * SECOND)
            writer.write(connection, when, STORE.serialize_cdr(message, kind))
    return path


TENTHS = [0.1 * k for k in range(FRAMES)]


def _bgr(k: int) -> tuple[str, np.ndarray[Any, Any]]:
    return "bgr8", _view(k)


@BOARDS
def test_vfr(tmp_path: Path, board: str) -> None:
    """A video whose frames are not equally far apart."""
    moments = [0, 200, 300, 1300]
    with av.open(str(tmp_path / "vfr.mp4"), "w") as file:
        stream = file.add_stream("mpeg4", rate=30)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        stream.codec_context.time_base, stream.bit_rate = Fraction(1, 1000), 8_000_000
        for k, moment in enumerate(moments):
            frame = av.VideoFrame.from_ndarray(_view(k), format="bgr24")
            frame.pts, frame.time_base = moment, Fraction(1, 1000)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    _is_the_pan(_flow(tmp_path / "vfr.mp4", tmp_path / "out", "--board", board), [m / 1000 for m in moments])


@pytest.mark.parametrize(("kind", "board"), [("shuffled", "golden"), ("shuffled", "verilated"), ("late", "golden"),
                                             ("fourhz", "golden"), ("same", "golden")])
def test_bag_times(tmp_path: Path, kind: str, board: str) -> None:
    """Frames recorded out of order, recorded late, at four a second, and all with one stamp."""
    order = [0, 2, 1, 3] if kind in ("shuffled", "late") else range(FRAMES)
    stamps = {"fourhz": [0.25 * k for k in range(FRAMES)], "same": [1.0] * FRAMES}.get(kind, TENTHS)
    logged = TENTHS if kind == "late" else None
    path = _bag(tmp_path / "bag", _bgr, [1.0 + s for s in stamps], [1.0 + t for t in logged] if logged else None, order)
    times = [2.0 + 0.1 * k for k in range(FRAMES)] if kind == "same" else [1.0 + s for s in stamps]
    _is_the_pan(_flow(path, tmp_path / "out", "--board", board), times)


ENCODINGS: dict[str, Callable[[int], np.ndarray[Any, Any]]] = {
    "mono16": lambda k: _grey(k).astype(np.uint16) * 16,
    "bayer_rggb8": _grey,  # of a grey scene every pattern is the picture itself
    "yuv422": lambda k: cv2.cvtColor(_view(k), cv2.COLOR_BGR2YUV_UYVY),
    "nv12": lambda k: np.vstack([_grey(k), np.full((SIZE[1] // 2, SIZE[0]), 128, np.uint8)]),
    "32FC1": lambda k: _grey(k).astype(np.float32) / 100,
    "compressed:rgb8; jpeg compressed bgr8": lambda k: _coded(_view(k), ".jpg"),
    "compressed:16UC1; compressedDepth": lambda k: np.frombuffer(
        struct.pack("<iff", 0, 0, 0) + _coded(_grey(k).astype(np.uint16) * 16, ".png").tobytes(), np.uint8)}


def _coded(picture: np.ndarray[Any, Any], ending: str) -> np.ndarray[Any, Any]:
    return np.asarray(cv2.imencode(ending, picture)[1], np.uint8).ravel()


@pytest.mark.parametrize(("encoding", "board"), [*((e, "golden") for e in ENCODINGS), ("mono16", "verilated")])
def test_bag_encodings_and_compressed(tmp_path: Path, encoding: str, board: str) -> None:
    path = _bag(tmp_path / "bag", lambda k: (encoding, ENCODINGS[encoding](k)), TENTHS)
    _is_the_pan(_flow(path, tmp_path / "out", "--board", board), TENTHS)


MESSAGE = """std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""


def _mcap(path: Path, **how: Any) -> Path:
    """An MCAP file by the library of its inventors, which a `ros2 bag` may have written or any other recorder."""
    writer = McapWriter(str(path), **how)
    schema = writer.register_msgdef("sensor_msgs/msg/Image", MESSAGE)
    for k in range(FRAMES):
        stamp = {"sec": 0, "nanosec": k * SECOND // 10}
        message = {"header": {"stamp": stamp, "frame_id": "c"}, "height": SIZE[1], "width": SIZE[0], "encoding": "bgr8",
                   "is_bigendian": 0, "step": 3 * SIZE[0], "data": _view(k).tobytes()}
        writer.write_message("/c", schema, message, log_time=k * SECOND // 10, publish_time=k * SECOND // 10)
    writer.finish()  # type: ignore[no-untyped-call]
    return path


@pytest.mark.parametrize(("kind", "board"), [*((k, "golden") for k in (
    "sqlite3", "message", "lz4", "cut", "dir #1")), ("dir #1", "verilated")])
def test_bag_storage(tmp_path: Path, kind: str, board: str) -> None:
    """Every way to store and compress messages, a file that was cut short, and a folder with a # in its name."""
    times = TENTHS
    if kind in ("sqlite3", "message"):
        how: dict[str, Any] = {"plugin": "sqlite3"} if kind == "sqlite3" else {"mode": CompressionMode[kind.upper()]}
        path = _bag(tmp_path / "bag", _bgr, TENTHS, **how)
    else:
        (tmp_path / kind).mkdir()
        compression = CompressionType.LZ4 if kind == "lz4" else CompressionType.ZSTD
        path = _mcap(tmp_path / kind / "dive.mcap", compression=compression, chunk_size=60_000)
        if kind == "cut":
            path.write_bytes(path.read_bytes()[:path.stat().st_size * 2 // 3])
    found = _flow(path, tmp_path / "out", "--board", board)
    if kind == "cut":
        assert 1 <= len(found) < FRAMES - 1
        times = times[:len(found) + 1]
    _is_the_pan(found, times)


@pytest.mark.parametrize("ending", ["png", "tif"])
def test_png16(tmp_path: Path, ending: str) -> None:
    (tmp_path / "in").mkdir()
    for k in range(FRAMES):
        write_picture(tmp_path / f"in/{k}.{ending}", _grey(k).astype(np.uint16) * 16)
    _is_the_pan(_flow(tmp_path / "in", tmp_path / "out"), [float("nan")] * FRAMES)


FOCAL, BENT = 110.0, (-0.25, 0.05, 0.0, 0.0, 0.0)
WIDE = 0.3, -0.05, 0.02, -0.01
FAST = 2
"""Times the pan's step."""


def _ros(model: str, numbers: Sequence[float], scale: int = 1) -> str:
    width, height = scale * SIZE[0], scale * SIZE[1]
    k = [scale * FOCAL, 0.0, width / 2, 0.0, scale * FOCAL, height / 2, 0.0, 0.0, 1.0]
    return (f"image_width: {width}\nimage_height: {height}\ncamera_name: narrow\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
            f"  data: {k}\ndistortion_model: {model}\ndistortion_coefficients:\n  rows: 1\n  cols: {len(numbers)}\n"
            f"  data: {list(numbers)}\n")


@pytest.mark.parametrize(("kind", "board"), [("ros", "golden"), ("ros", "verilated"), ("fisheye", "golden"),
                                             ("twice", "golden"), ("aspect", "golden")])
def test_calib(tmp_path: Path, kind: str, board: str) -> None:
    """Frames of a lens with distortion, in which the floor moves otherwise at the border than in the middle: with the
    calibration it moves alike everywhere; one for another aspect is refused."""
    points = np.stack(np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1])), -1).reshape(-1, 1, 2).astype(np.float64)
    k = np.array([[FOCAL, 0, SIZE[0] / 2], [0, FOCAL, SIZE[1] / 2], [0, 0, 1]])
    straight = (cv2.fisheye.undistortPoints(points, k, np.array(WIDE), P=k) if kind == "fisheye" else
                cv2.undistortPoints(points, k, np.array(BENT), P=k)).reshape(SIZE[1], SIZE[0], 2).astype(np.float32)
    (tmp_path / "in").mkdir()
    for n in range(FRAMES):
        at = straight + np.float32(120) + n * FAST * np.array(STEP, np.float32)
        write_picture(tmp_path / f"in/{n}.png", cv2.remap(FLOOR, at[..., 0], at[..., 1], cv2.INTER_CUBIC))
    text = _ros("equidistant", WIDE) if kind == "fisheye" else _ros("plumb_bob", BENT, 4 if kind == "twice" else 1)
    if kind == "aspect":
        text = text.replace("image_height: 120", "image_height: 90")
    (tmp_path / "c.yaml").write_text(text)
    options = "--calibration", tmp_path / "c.yaml", "--board", board
    if kind == "aspect":
        result = _run("flow", tmp_path / "in", *options, "--out", tmp_path / "out")
        assert result.exit_code == 1 and "aspect" in result.output, result.output
        return
    _is_the_pan(_flow(tmp_path / "in", tmp_path / "out", *options), [float("nan")] * FRAMES, 0.2, FAST)
    with (tmp_path / "out/flow.csv").open(newline="") as file:
        across = [float(row["dx_px"]) for row in csv.DictReader(file) if row["valid"] == "1"]
    assert len(across) >= 8 and np.ptp(across) < 0.6, "distortion is left"


@BOARDS
def test_jump(tmp_path: Path, board: str) -> None:
    """The view jumps by 24 px and stays: what the autopilot is told adds up to the last row, and nothing of the gap."""
    noise = np.random.default_rng(6).normal(128, 120, (144, 240))
    floor = np.clip(cv2.GaussianBlur(noise, (0, 0), 2.5), 0, 255).astype(np.uint8)
    np.save(tmp_path / "film.npy", np.stack([floor[:, (0 if k < 3 else 24):][:, :192] for k in range(8)]))
    with receiver() as other:
        result = _run("hold", "--source", tmp_path / "film.npy", "--range", "1", "--focal", "200", "--window", "32",
                      "--mavlink", other.address, "--out", tmp_path / "out", "--board", board)
        assert result.exit_code == 0, result.output
        with (tmp_path / "out" / "hold.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        got = []
        while message := other.link.recv_match(type="VISION_POSITION_DELTA", blocking=True, timeout=0.2):
            got.append(message)
    assert float(rows[-1]["y_m"]) == pytest.approx(24 / 200, abs=0.002)
    assert sum(m.position_delta[1] for m in got) == pytest.approx(float(rows[-1]["y_m"]), abs=1e-4)
    assert min(m.confidence for m in got) > 0


class Clockwork:
    """In place of OpenCV's reader: a camera that shows a view every so many seconds, 2 px further each."""

    rate = 30.0
    count = 30

    def __init__(self, index: int) -> None:
        self._done, self._start = 0, time.monotonic()

    def isOpened(self) -> bool:
        return True

    def release(self) -> None:
        pass

    def read(self) -> tuple[bool, Image | None]:
        if self._done >= self.count:
            return False, None
        time.sleep(max(0.0, self._start + self._done / self.rate - time.monotonic()))
        self._done += 1
        return True, np.ascontiguousarray(FLOOR[60:60 + SIZE[1], 40 + 2 * self._done:][:, :SIZE[0]])


@pytest.mark.parametrize(("rate", "board"), [(30.0, "golden"), (5.0, "golden"), (5.0, "verilated")])
def test_live_camera(tmp_path: Path, rate: float, board: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The speed that an autopilot is told is that of the view, whatever the camera's rate."""
    monkeypatch.setattr(Clockwork, "rate", rate)
    monkeypatch.setattr(Clockwork, "count", round(1.5 * rate))
    monkeypatch.setattr(cv2, "VideoCapture", Clockwork)
    with receiver() as other:
        result = _run("hold", "--source", "0", "--range", "1", "--focal", "200", "--window", "32", "--no-sense",
                      "--mavlink", other.address, "--out", tmp_path / "out", "--board", board)
        assert result.exit_code == 0, result.output
        got = []
        while message := other.link.recv_match(type="VISION_POSITION_DELTA", blocking=True, timeout=0.2):
            got.append(message)
    speed = sum(m.position_delta[1] for m in got) / sum(1e-6 * m.time_delta_usec for m in got)
    assert speed == pytest.approx(2 * rate / 200, rel=0.1), [m.time_delta_usec for m in got]


def test_an_exported_trajectory_has_the_frames_own_times(tmp_path: Path) -> None:
    """A hold's table counts from its first frame; what other programs get has the stamps of the bag."""
    stamps = [1_700_000_000.25 + t for t in TENTHS]
    path = _bag(tmp_path / "bag", _bgr, stamps)
    result = _run("hold", "--source", path, "--range", "1", "--focal", "200", "--window", "32", "--out", tmp_path / "o")
    assert result.exit_code == 0, result.output
    result = _run("export", tmp_path / "o")
    assert result.exit_code == 0 and "4 poses in `odom`" in result.output, result.output
    tum = np.loadtxt(tmp_path / "o/hold.tum")
    assert tum[:, 0] == pytest.approx(np.array(stamps), abs=1e-6)
    # Pictures go right and down over the floor, the vehicle right and back: y is to the left, x ahead.
    assert tum[:, 1:3] == pytest.approx(np.array([[-STEP[1] * k / 200, -STEP[0] * k / 200] for k in range(FRAMES)]),
                                        abs=1e-3)
