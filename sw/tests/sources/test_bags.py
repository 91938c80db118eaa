# SPDX-License-Identifier: Apache-2.0
"""ROS 1 and 2 bags and MCAP written by rosbags' own writers, and every error a bag can make."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from signum.common.errors import SourceError
from signum.sources import logs
from signum.sources.bags import BagSource
from signum.sources.open import open_source

KINDS = "ros1", "sqlite3", "mcap"
COLOUR = np.random.default_rng(0).integers(0, 256, (12, 16, 3), dtype=np.uint8)
"""Blue, green, red."""
Message = Callable[[Any, Any], Any]


def _write(folder: Path, kind: str, topics: dict[str, list[Message]], msgtype: str = "sensor_msgs/msg/Image") -> Path:
    """A bag of messages by topic; each message is made from (typestore, header)."""
    store = get_typestore(Stores.ROS1_NOETIC if kind == "ros1" else Stores.ROS2_HUMBLE)
    time = store.types["builtin_interfaces/msg/Time"](0, 0)
    header = store.types["std_msgs/msg/Header"](**({"seq": 0} if kind == "ros1" else {}), stamp=time, frame_id="camera")
    path = folder / ("dive.bag" if kind == "ros1" else "dive")
    writer: Any = Writer1(path) if kind == "ros1" else Writer2(
        path, version=9, storage_plugin=StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3)
    serialize = store.serialize_ros1 if kind == "ros1" else store.serialize_cdr
    with writer:
        for topic, messages in topics.items():
            name = "std_msgs/msg/Header" if messages == [_header] else msgtype
            connection = writer.add_connection(topic, name, typestore=store)
            for k, make in enumerate(messages):
                writer.write(connection, 1000 * k, serialize(make(store, header), name))
    return path


def _header(_: Any, header: Any) -> Any:
    return header


def _image(encoding: str, picture: np.ndarray[Any, Any], padding: int = 0) -> Message:
    """An image message, with so many bytes of padding at the end of a row."""
    rows = picture.reshape(picture.shape[0], -1)
    data = np.hstack([rows, np.zeros((len(rows), padding), np.uint8)])

    def make(store: Any, header: Any) -> Any:
        return store.types["sensor_msgs/msg/Image"](header, picture.shape[0], picture.shape[1], encoding, 0,
                                                    data.shape[1], data.ravel())
    return make


def _jpeg(picture: np.ndarray[Any, Any]) -> Message:
    data = np.asarray(cv2.imencode(".png", picture)[1], np.uint8).ravel()
    return lambda store, header: store.types["sensor_msgs/msg/CompressedImage"](header, "png", data)


@pytest.mark.parametrize("kind", KINDS)
def test_the_only_topic_is_read_in_order(tmp_path: Path, kind: str) -> None:
    pictures = [np.full((40, 50), 10 * k, np.uint8) for k in range(4)]
    path = _write(tmp_path, kind, {"/camera/image_raw": [_image("mono8", p, 6) for p in pictures], "/tick": [_header]})
    source = open_source(path)
    assert isinstance(source, BagSource) and source.count == 4 and not source.snapshots
    frames = list(source)
    assert [f.name for f in frames] == ["0", "1", "2", "3"]
    assert all(np.array_equal(f.picture, p) for f, p in zip(frames, pictures, strict=True))
    assert len(list(source)) == 4, "a source can be read again"
    if kind == "mcap":
        assert len(list(open_source(path / "dive.mcap"))) == 4, "the file inside the folder alone"


@pytest.mark.parametrize(("encoding", "picture", "wanted"), [
    ("mono8", COLOUR[..., 1], COLOUR[..., 1]), ("bgr8", COLOUR, COLOUR), ("rgb8", COLOUR[..., ::-1], COLOUR),
    ("bgra8", np.dstack([COLOUR, COLOUR[..., 0]]), COLOUR),
    ("rgba8", np.dstack([COLOUR[..., ::-1], COLOUR[..., 0]]), COLOUR)])
def test_encodings(tmp_path: Path, encoding: str, picture: np.ndarray[Any, Any], wanted: np.ndarray[Any, Any]) -> None:
    (frame,) = open_source(_write(tmp_path, "ros1", {"/image": [_image(encoding, picture)]}))
    assert np.array_equal(frame.picture, wanted)


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_bayer_patterns(tmp_path: Path, pattern: str) -> None:
    blue_green_red = (40, 120, 200)
    tile = np.array(["bgr".index(c) for c in pattern]).reshape(2, 2)
    raw = np.tile(np.array(blue_green_red, np.uint8)[tile], (6, 8))
    (frame,) = open_source(_write(tmp_path, "mcap", {"/image": [_image(f"bayer_{pattern}8", raw)]}))
    assert frame.picture.shape == (12, 16, 3) and (frame.picture == blue_green_red).all()


@pytest.mark.parametrize("kind", KINDS)
def test_compressed(tmp_path: Path, kind: str) -> None:
    path = _write(tmp_path, kind, {"/c": [_jpeg(COLOUR), _jpeg(COLOUR)]}, "sensor_msgs/msg/CompressedImage")
    assert all(np.array_equal(f.picture, COLOUR) for f in open_source(path))
    (tmp_path / "grey").mkdir()
    grey = _write(tmp_path / "grey", kind, {"/c": [_jpeg(COLOUR[..., 0])]}, "sensor_msgs/msg/CompressedImage")
    assert next(iter(open_source(grey))).picture.ndim == 2


def test_one_of_several_topics(tmp_path: Path) -> None:
    path = _write(tmp_path, "sqlite3", {"/left": [_image("mono8", COLOUR[..., 0])] * 2,
                                        "/right": [_image("mono8", COLOUR[..., 1])] * 3})
    assert len(list(open_source(f"{path}#/right"))) == 3
    with pytest.raises(SourceError, match=r"several image topics: /left \(2 frames\), /right \(3 frames\); choose one"):
        open_source(path)
    with pytest.raises(SourceError, match=r"no image topic /up; it has /left"):
        open_source(f"{path}#/up")


@pytest.mark.parametrize(("messages", "says"), [
    ([_header], "no image topic in this bag"), ([_image("yuv411", COLOUR[..., 0])], "encoding 'yuv411'; signum reads"),
    ([lambda s, h: s.types["sensor_msgs/msg/Image"](h, 480, 640, "mono8", 0, 640, np.zeros(9, np.uint8))],
     "9 bytes for 640x480")])
def test_what_cannot_be_read_is_said(tmp_path: Path, messages: list[Message], says: str) -> None:
    path = _write(tmp_path, "ros1", {"/image": messages})
    with pytest.raises(SourceError, match=says) as error:
        list(open_source(path))
    assert str(path) in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["junk.bag", "junk.mcap", "junk.db3", "empty.bag"])
def test_no_bag_at_all(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"" if name.startswith("empty") else bytes(range(256)) * 8)
    says = "the file is empty" if name.startswith("empty") else "not a ROS bag or MCAP file that can be read"
    with pytest.raises(SourceError, match=says):
        list(open_source(tmp_path / name))


def test_cut_short_gives_what_it_has_or_says_so(tmp_path: Path) -> None:
    pictures = [_image("mono8", np.full((100, 120), k, np.uint8)) for k in range(40)]
    path = _write(tmp_path, "ros1", {"/image": pictures})
    path.write_bytes(path.read_bytes()[:-3000])
    with pytest.raises(SourceError, match="rosbag reindex"):
        list(open_source(path))


def _stamped(picture: np.ndarray[Any, Any], seconds: float) -> Message:
    def make(store: Any, header: Any) -> Any:
        stamp = type(header.stamp)(int(seconds), round(seconds % 1 * 1e9))
        return _image("mono8", picture)(store, type(header)(stamp=stamp, frame_id="camera"))
    return make


def test_frames_are_in_order_of_their_stamps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    order = [0, 1, 3, 2, 4, 5, 7, 6]
    path = _write(tmp_path, "mcap", {"/c": [_stamped(np.full((20, 20), 9 * k, np.uint8), k / 10) for k in order]})
    frames = list(open_source(path))
    assert [f.time_s for f in frames] == pytest.approx([k / 10 for k in range(8)])
    assert [int(f.picture[0, 0]) for f in frames] == [9 * k for k in range(8)]
    assert capsys.readouterr().err.count("2 frames were recorded out of the order of their stamps") == 1


def test_without_stamps_the_time_of_recording_counts(tmp_path: Path) -> None:
    path = _write(tmp_path, "mcap", {"/c": [_image("mono8", COLOUR[..., k]) for k in range(3)]})
    assert [f.time_s for f in open_source(path)] == pytest.approx([0, 1e-6, 2e-6])


@pytest.mark.parametrize(("encoding", "code"), [("yuv422_yuy2", cv2.COLOR_YUV2BGR_YUY2),
                                                ("yuv422", cv2.COLOR_YUV2BGR_UYVY), ("nv12", cv2.COLOR_YUV2BGR_NV12)])
def test_yuv(tmp_path: Path, encoding: str, code: int) -> None:
    cells = COLOUR[..., 0] if encoding == "nv12" else COLOUR[..., :2]
    message = _image(encoding, cells)

    def make(store: Any, header: Any) -> Any:
        whole = message(store, header)
        whole.height = whole.height * 2 // 3 if encoding == "nv12" else whole.height
        return whole

    (frame,) = open_source(_write(tmp_path, "ros1", {"/image": [make]}))
    assert np.array_equal(frame.picture, cv2.cvtColor(np.ascontiguousarray(cells), code))


@pytest.mark.parametrize("endian", [0, 1])
def test_sixteen_bits_of_either_byte_order(tmp_path: Path, endian: int) -> None:
    deep = (COLOUR[..., 0].astype(np.uint16) * 16).astype(">u2" if endian else "<u2")

    def make(store: Any, header: Any) -> Any:
        return store.types["sensor_msgs/msg/Image"](header, 12, 16, "mono16", endian, 32, deep.view(np.uint8).ravel())

    (frame,) = open_source(_write(tmp_path, "ros1", {"/image": [make]}))
    assert np.array_equal(frame.picture, COLOUR[..., 0])


def test_compressed_depth(tmp_path: Path) -> None:
    data = bytes(12) + cv2.imencode(".png", COLOUR[..., 0].astype(np.uint16) * 16)[1].tobytes()
    path = _write(tmp_path, "mcap", {"/d": [lambda s, h: s.types["sensor_msgs/msg/CompressedImage"](
        h, "16UC1; compressedDepth", np.frombuffer(data, np.uint8))]}, "sensor_msgs/msg/CompressedImage")
    (frame,) = open_source(path)
    assert np.array_equal(frame.picture, COLOUR[..., 0])


def _foxglove(path: Path, frames: int = 12) -> list[np.ndarray[Any, Any]]:
    """An MCAP file without a profile: H.264 in protobuf messages and a JSON channel; returns the pictures in it."""
    pictures = [np.full((48, 64, 3), 20 * k, np.uint8) for k in range(frames)]
    codec: Any = av.CodecContext.create("libx264", "w")
    codec.width, codec.height, codec.pix_fmt, codec.time_base = 64, 48, "yuv420p", Fraction(1, 10)
    codec.options = {"tune": "zerolatency", "preset": "ultrafast"}
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=600)
        writer.start(profile="")
        schema = writer.register_schema("foxglove.CompressedVideo", "protobuf", b"")
        video = writer.register_channel("/camera", "protobuf", schema)
        other = writer.register_channel("/state", "json", 0)
        for k, picture in enumerate(pictures):
            writer.add_message(other, k, b"{}", k)
            (packet,) = codec.encode(av.VideoFrame.from_ndarray(picture, format="bgr24"))
            body = bytes(packet)
            size = bytes([len(body) & 127 | 128, len(body) >> 7 & 127 | 128, len(body) >> 14])
            stamp = bytes([0x0A, 2, 8, k + 1])
            writer.add_message(video, 5 * k, stamp + b"\x1a" + size + body + b"\x22\x04h264", 5 * k)
        writer.finish()  # type: ignore[no-untyped-call]
    return pictures


def test_video_in_an_mcap_file_without_a_profile(tmp_path: Path) -> None:
    pictures = _foxglove(tmp_path / "fox.mcap")
    frames = list(open_source(tmp_path / "fox.mcap"))
    assert [f.time_s for f in frames] == [k + 1 for k in range(12)]
    assert all(np.abs(f.picture.astype(int) - p).max() <= 6 for f, p in zip(frames, pictures, strict=True))


def test_a_cut_mcap_file_is_read_up_to_the_cut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _foxglove(tmp_path / "fox.mcap")
    data = (tmp_path / "fox.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[:len(data) // 2])
    frames = list(open_source(tmp_path / "cut.mcap"))
    assert 1 <= len(frames) < 12 and "the file is cut short" in capsys.readouterr().err


def test_a_folder_may_have_a_hash_in_its_name(tmp_path: Path) -> None:
    (tmp_path / "dir #1").mkdir()
    _foxglove(tmp_path / "dir #1/dive.mcap")
    assert len(list(open_source(tmp_path / "dir #1/dive.mcap"))) == 12
    assert len(list(open_source(f"{tmp_path}/dir #1/dive.mcap#/camera"))) == 12


def test_a_chunk_too_large_to_decompress_is_refused_from_the_index_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch
                                                                      ) -> None:
    path = _write(tmp_path, "mcap", {"/image": [_image("mono8", COLOUR[..., 0])]})
    monkeypatch.setattr(logs, "LARGEST_CHUNK", 100)
    with pytest.raises(SourceError, match=r"a chunk of \d+ bytes"):
        list(open_source(next(path.glob("*.mcap"))))


def test_a_count_of_frames_that_is_no_number(tmp_path: Path) -> None:
    path = _write(tmp_path, "sqlite3", {"/image": [_image("mono8", COLOUR[..., k]) for k in range(3)]})
    about = path / "metadata.yaml"
    text = about.read_text()
    assert "message_count: 3" in text
    about.write_text(text.replace("message_count: 3", "message_count: many"))
    with contextlib.suppress(SourceError):
        assert len(list(open_source(path))) == 3
