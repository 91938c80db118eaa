# SPDX-License-Identifier: Apache-2.0
"""Opens what a user names: a source (pictures, a video, a ROS bag, a camera, a stream, an array file or the simulated
world), or a calibration."""

from __future__ import annotations

import re
from pathlib import Path

from signum.common.checks import check_file
from signum.common.errors import SourceError, lacking
from signum.common.urls import is_stream
from signum.frames.frame import Source
from signum.geometry.calibration import CalibrationError, Lens, Rig, read_lens, read_rig
from signum.geometry.document import Entries, read_entries
from signum.geometry.formats import lens_of, rig_of_two
from signum.sources.files import (
    PICTURES,
    ArraySource,
    FolderSource,
    PictureSource,
    UndistortedSource,
)
from signum.sources.live import CameraSource

BAGS = frozenset({".bag", ".mcap", ".db3"})
"""A file with one of these endings is a ROS bag."""
CAMERA = re.compile(r"(?:camera:)?(\d{1,2})$")
DEVICE = re.compile(r"/dev/(?:video\d+|v4l/.+)$")
UDP = re.compile(r"(?:udp|rtp)://", re.IGNORECASE)
V4L2 = "video4linux2"
"""FFmpeg's name of the driver of cameras."""
RECTIFIED = re.compile(r"#.*/image_rect(?:_mono|_color|_raw)?(?:/\w+)?$")
"""A topic that ROS' image_proc has rectified."""
WORLD = re.compile(r"world(?::|$)")


def open_source(text: str | Path, calibration: str | Path | None = None) -> Source:
    """Open a source by its name.

    Args:
        text: a folder, a picture, a video, a .npy array, a ROS bag (`dive.bag`, `dive.mcap` or a bag's folder, followed
            by `#topic` if it has several), a camera (`0`, `camera:0` or `/dev/video0`), a stream (`udp://:5600`,
            `rtsp://...` or `http://...`) or the simulated world (`world` or `world:name=value,...`).
        calibration: of the camera, whose distortion is taken out of every frame, as `open_lens` reads it; None for
            none.

    Raises:
        SourceError: if there is no such source, or none of it can be used. A bad frame raises when its turn comes.
        CalibrationError: if the calibration cannot be used.
    """
    source = _open(text)
    if calibration is None:
        return source
    if RECTIFIED.search(source.label):
        raise CalibrationError(f"{source.label}: by its name this topic is without distortion already, which would be "
                               "taken out twice: take the raw topic, or leave --calibration out")
    return UndistortedSource(source, open_lens(calibration), str(calibration))


def open_lens(text: str | Path) -> Lens:
    """Open the calibration of a single camera by its name.

    Args:
        text: a file of OpenCV, ROS or Kalibr (see `read_lens`), followed by `#cam1` if it has several cameras, or a bag
            with CameraInfo messages, followed by `#topic` if it has several such topics.

    Raises:
        CalibrationError: if it cannot be used.
    """
    file, topic = split_topic(str(text))
    if _is_bag(Path(file)):
        return lens_of(_camera_infos(Path(file), topic, 1)[0])
    path, camera = _split_camera(str(text))
    return read_lens(path, camera)


def open_rig(text: str | Path) -> Rig:
    """Open the calibration of a stereo pair by its name.

    Args:
        text: a file of OpenCV or Kalibr (see `read_rig`); two files of ROS, `left.yaml,right.yaml`; or a bag with
            CameraInfo messages, followed by `#/left/camera_info,/right/camera_info` if it has more than these two.

    Raises:
        CalibrationError: if it cannot be used.
    """
    file, topics = split_topic(str(text))
    if _is_bag(Path(file)):
        return rig_of_two(*_camera_infos(Path(file), topics, 2))
    left, comma, right = str(text).partition(",")
    if comma and not Path(text).exists():
        return rig_of_two(read_entries(Path(left)), read_entries(Path(right)))
    return read_rig(Path(text))


def _camera_infos(path: Path, topics: str, count: int) -> list[Entries]:
    try:
        from signum.sources.camera_info import read_camera_infos  # loads slowly
    except ModuleNotFoundError as error:
        raise lacking("ros", error) from error
    return read_camera_infos(path, [name for name in topics.split(",") if name], count)


def _split_camera(text: str) -> tuple[Path, str]:
    """A file's path and the camera in it, which follows the last `#`; the file's own name may have one."""
    name, mark, camera = text.rpartition("#")
    if not mark or Path(text).exists() or "/" in camera:
        return Path(text), ""
    return Path(name), camera


def _open(text: str | Path) -> Source:
    if not str(text).strip():
        raise SourceError("the source's name is empty: give a folder of pictures, a video, a bag or a camera's number")
    file, topic = split_topic(str(text))
    if _is_bag(Path(file)):
        try:
            from signum.sources.bags import BagSource  # loads slowly
        except ModuleNotFoundError as error:
            raise lacking("ros", error) from error

        return BagSource(Path(file), topic or None)
    if WORLD.match(str(text)) and not Path(text).exists():
        from signum.sources.simulated import WorldSource  # loads slowly

        return WorldSource.named(str(text))
    if is_stream(str(text)):
        return _stream(str(text))
    path = Path(text)
    if path.is_dir():
        return FolderSource(path)
    if DEVICE.match(str(text)):
        return _stream(str(text), V4L2)
    if not path.exists():
        camera = CAMERA.match(str(text))
        if camera:
            return CameraSource(int(camera[1]))
        raise SourceError(f"{path}: no such file or folder; check the spelling (in {Path.cwd()})")
    check_file(path, "video, picture, array or bag", SourceError)
    kind = path.suffix.lower()
    if kind in PICTURES:
        return PictureSource(path)
    if kind == ".npy":
        return ArraySource.load(path)
    from signum.sources.video import VideoSource  # loads FFmpeg

    return VideoSource(path)


def _stream(text: str, kind: str | None = None) -> Source:
    from signum.sources.stream import AvSource  # these load FFmpeg, too
    from signum.sources.udp import UdpSource

    return UdpSource(text) if UDP.match(text) else AvSource(text, kind)


def split_topic(text: str) -> tuple[str, str]:
    """A bag's path and topic: the topic follows the first `#` before which there is a bag, as a folder may have a `#`
    in its name."""
    if not _is_bag(Path(text)):
        for at in (k for k, character in enumerate(text) if character == "#"):
            if _is_bag(Path(text[:at])):
                return text[:at], text[at + 1:]
    return text, ""


def _is_bag(path: Path) -> bool:
    """Whether a path is a ROS bag: by its ending, or a ROS 2 bag's folder."""
    return (path.is_file() and path.suffix.lower() in BAGS) or (path / "metadata.yaml").is_file()
