# SPDX-License-Identifier: Apache-2.0
"""Sources: order and names of frames, and every error a user can make."""

import struct
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from signum.common.errors import SourceError
from signum.common.files import write_picture
from signum.sources.files import ArraySource, FolderSource
from signum.sources.live import CameraSource
from signum.sources.open import open_source
from signum.sources.video import VideoSource


def _picture(width: int = 64, height: int = 48, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (height, width), dtype=np.uint8)


def _video(path: Path, frames: int, size: tuple[int, int] = (96, 64)) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10, size)
    for i in range(frames):
        writer.write(cv2.cvtColor(_picture(*size, seed=i), cv2.COLOR_GRAY2BGR))
    writer.release()
    return path


def test_folder_in_natural_order_named_by_stem(tmp_path: Path) -> None:
    for name in ("10.png", "9.tif", "1.jpg", "notes.csv", ".hidden.png"):
        file = tmp_path / name
        file.write_text("x") if name.endswith("csv") else write_picture(file, _picture())
    source = open_source(tmp_path)
    assert isinstance(source, FolderSource) and source.snapshots and source.count == 3
    assert [f.name for f in source] == ["1", "9", "10"]


def test_video_frames_are_numbered_from_zero(tmp_path: Path) -> None:
    source = open_source(_video(tmp_path / "v.avi", 12))
    assert isinstance(source, VideoSource) and not source.snapshots and source.count == 12
    assert [f.name for f in source] == [str(i) for i in range(12)]
    assert [f.name for f in source] == [str(i) for i in range(12)], "a source can be read again"


def test_a_decoders_threads_never_wait_for_the_interpreter() -> None:
    """With a level set, a message of a decoder's thread would wait for ever while the video is being closed."""
    assert av.logging.get_level() is None


def test_a_video_of_unknown_codec_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.avi"
    path.write_bytes(_video(path, 3).read_bytes().replace(b"MJPG", b"zz99"))
    with pytest.raises(SourceError, match="a kind that cannot be decoded; try `ffmpeg"):
        open_source(path)


@pytest.mark.parametrize("turn", [(0, 1, -1, 0), (-1, 0, 0, -1), (0, -1, 1, 0)])
def test_a_turned_video_is_shown_upright(tmp_path: Path, turn: tuple[int, int, int, int]) -> None:
    """The display matrix of a phone's or action camera's file is obeyed, as OpenCV obeys it."""
    path = tmp_path / "turned.mp4"
    picture = np.zeros((64, 96, 3), np.uint8)
    picture[:32, :48], picture[:32, 48:], picture[32:, :48] = (255, 0, 0), (0, 255, 0), (0, 0, 255)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        for packet in [*stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")), *stream.encode(None)]:
            container.mux(packet)
    data = bytearray(path.read_bytes())
    a, b, c, d = (k << 16 for k in turn)
    matrix = data.index(b"tkhd") + 44  # ISO/IEC 14496-12, 8.3.2: the track's matrix
    data[matrix:matrix + 36] = struct.pack(">9i", a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(data)
    _, expected = cv2.VideoCapture(str(path)).read()
    [frame] = open_source(path)
    assert np.array_equal(frame.picture, expected)
    assert frame.picture.shape[:2] == ((96, 64) if turn[0] == 0 else (64, 96))


def test_arrays(tmp_path: Path) -> None:
    stack = np.stack([_picture(seed=s) for s in range(3)])
    np.save(tmp_path / "s.npy", stack)
    frames = list(open_source(tmp_path / "s.npy"))
    assert [f.name for f in frames] == ["0", "1", "2"] and np.array_equal(frames[2].picture, stack[2])
    assert [f.size for f in ArraySource(stack)] == [(64, 48)] * 3


def test_a_number_is_a_camera_unless_it_is_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    source = open_source("7")
    assert isinstance(source, CameraSource) and source.index == 7
    with pytest.raises(SourceError, match=r"camera 7: cannot be opened.*ls /dev/video"):
        next(iter(source))
    (tmp_path / "7").mkdir()
    with pytest.raises(SourceError, match="no pictures"):
        open_source("7")


def _bad(folder: Path, kind: str) -> Path:
    path = folder / {"text": "a.png", "cut": "a.png", "cutjpg": "a.jpg", "npy": "a.npy", "npyshape": "a.npy",
                     "video": "a.mp4", "emptyvideo": "a.mp4"}.get(kind, "a")
    if kind == "text":
        path.write_text("this is no picture")
    elif kind in ("cut", "cutjpg"):
        write_picture(path, _picture(256, 200))
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    elif kind == "npy":
        path.write_text("no array")
    elif kind == "npyshape":
        np.save(path, np.zeros((4, 5, 6), np.float64))
    elif kind == "video":
        path.write_bytes(bytes(range(256)) * 40)
    elif kind == "emptyvideo":
        path.touch()
    elif kind == "emptyfolder":
        path.mkdir()
    return path


@pytest.mark.parametrize(("kind", "says"), [
    ("missing", "no such file or folder"), ("text", "cannot be read"), ("cut", "broken or cut short"),
    ("cutjpg", "broken or cut short"),
    ("npy", "not a NumPy array"), ("npyshape", r"float64 array of shape \(4, 5, 6\)"),
    ("video", "not a video that can be decoded.*ffmpeg"), ("emptyvideo", "file is empty"),
    ("emptyfolder", "no pictures in this folder"),
])
def test_bad_input_is_one_line_that_names_the_file(tmp_path: Path, kind: str, says: str) -> None:
    path = _bad(tmp_path, kind)
    with pytest.raises(SourceError, match=says) as error:
        list(open_source(path))
    assert str(path) in str(error.value) and "\n" not in str(error.value)


def test_frames_of_different_sizes_are_named_when_their_turn_comes(tmp_path: Path) -> None:
    for name, size in (("1", (64, 48)), ("2", (64, 48)), ("3", (64, 54))):
        write_picture(tmp_path / f"{name}.png", _picture(*size))
    seen = []
    with pytest.raises(SourceError, match="frame 3 is 64x54, frame 1 is 64x48"):
        for frame in open_source(tmp_path):
            seen.append(frame.name)
    assert seen == ["1", "2"]


def test_frames_of_slightly_different_sizes_are_cut_or_continued(tmp_path: Path) -> None:
    """Scans of one camera differ by a few pixels; what lies about the middle stays where it is."""
    whole = np.random.default_rng(0).integers(0, 256, (50, 66), dtype=np.uint8)
    for name, part in (("1", whole[1:49, 1:65]), ("2", whole), ("3", whole[2:48, 2:64])):
        write_picture(tmp_path / f"{name}.png", np.ascontiguousarray(part))
    first, larger, smaller = (frame.picture for frame in open_source(tmp_path))
    assert np.array_equal(larger, first)
    assert smaller.shape == first.shape and np.array_equal(smaller[1:-1, 1:-1], first[1:-1, 1:-1])
    assert np.array_equal(smaller[0], smaller[1]) and np.array_equal(smaller[:, -1], smaller[:, -2])


def test_two_pictures_of_one_name(tmp_path: Path) -> None:
    for name in ("5.png", "5.tif"):
        write_picture(tmp_path / name, _picture())
    with pytest.raises(SourceError, match="would both be frame 5"):
        open_source(tmp_path)


def test_video_cut_short_gives_what_it_has_first(tmp_path: Path) -> None:
    path = _video(tmp_path / "v.avi", 30)
    source = VideoSource(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 3])
    seen = []
    with pytest.raises(SourceError, match=r"broken after frame \d+ of 30"):
        for frame in source:
            seen.append(frame)
    assert 3 <= len(seen) < 20


def test_deeper_pictures_are_mapped_alike_over_a_run(tmp_path: Path) -> None:
    first, second = _picture(seed=1) // 2 + np.uint8(100), _picture(seed=2) // 4
    for name, picture in (("1", first), ("2", second)):
        write_picture(tmp_path / f"{name}.png", picture.astype(np.uint16) * 16)  # 12 bits
    frames = list(open_source(tmp_path))
    assert np.array_equal(frames[0].picture, first) and np.array_equal(frames[1].picture, second)


def test_depth_in_metres_is_mapped_to_a_round_number(tmp_path: Path) -> None:
    depth = np.linspace(0, 4.2, 64 * 48, dtype=np.float32).reshape(48, 64)
    depth[0, 0] = np.nan
    write_picture(tmp_path / "a.tif", depth)
    (frame,) = open_source(tmp_path / "a.tif")
    assert np.array_equal(frame.picture, np.rint(np.nan_to_num(depth) * np.float32(51)))


def test_frames_of_a_video_keep_their_times(tmp_path: Path) -> None:
    times = [0, 200, 300, 1300, 1500]
    with av.open(str(tmp_path / "v.mp4"), "w") as file:
        stream = file.add_stream("mpeg4", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        stream.codec_context.time_base = Fraction(1, 1000)
        for k, t in enumerate(times):
            frame = av.VideoFrame.from_ndarray(np.dstack([_picture(seed=k)] * 3), format="bgr24")
            frame.pts, frame.time_base = t, Fraction(1, 1000)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    assert [f.time_s for f in open_source(tmp_path / "v.mp4")] == pytest.approx([t / 1000 for t in times])
