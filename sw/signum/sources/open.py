"""Where frames come from: a folder of pictures, one picture, a video, a ROS bag, a camera, an array in memory, the
simulated world; lens distortion is taken out where a calibration is at hand.

A frame's name is its file's name without the ending for pictures, the index from 0 for everything else; it is what
the tables call `frame`. All frames of a source have one size. A frame that cannot be used raises SourceError when its
turn comes, so that what was finished before can be kept.
"""

from __future__ import annotations

import re
from pathlib import Path

import cv2
from PIL import Image as PilImage

from signum.common.errors import SourceError
from signum.frames.frame import Source
from signum.sources.files import (
    PICTURES,
    ArraySource,
    CameraSource,
    FolderSource,
    PictureSource,
    UndistortedSource,
    VideoSource,
)

VIDEOS = frozenset({".mp4", ".avi", ".mov", ".mkv", ".m4v", ".mpg", ".mpeg", ".webm", ".ts", ".wmv"})
BAGS = frozenset({".bag", ".mcap", ".db3"})
CAMERA = re.compile(r"(?:camera:)?(\d{1,2})$")
WORLD = re.compile(r"world(?::|$)")

# OpenCV's own chatter about odd TIFF tags would bury our one line.
PilImage.MAX_IMAGE_PIXELS = None
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)


def open_source(text: str | Path, calibration: Path | None = None) -> Source:
    """The source a user names: a folder, a picture, a video, a .npy array, a ROS bag (`dive.bag`, `dive.mcap`, a bag's
    folder, with `#topic` behind it if it has several), `world` (simulated) or a camera's number (`0` or `camera:0`).

    Args:
        text: the name.
        calibration: OpenCV YAML of the camera, whose distortion is taken out; None for none.

    Raises:
        SourceError: if there is no such thing, or it is plainly unusable.
        CalibrationError: if the calibration is.
    """
    source = _open(text)
    return source if calibration is None else UndistortedSource(source, calibration)


def _open(text: str | Path) -> Source:
    file, _, topic = str(text).partition("#")
    if _is_bag(Path(file)):
        from signum.sources.bags import BagSource  # imports this module, and takes a while itself

        return BagSource(Path(file), topic or None)
    if WORLD.match(str(text)) and not Path(text).exists():
        from signum.sources.simulated import WorldSource  # imports this module

        return WorldSource.named(str(text))
    path = Path(text)
    if path.is_dir():
        return FolderSource(path)
    if not path.exists():
        camera = CAMERA.match(str(text))
        if camera:
            return CameraSource(int(camera[1]))
        raise SourceError(f"{path}: no such file or folder; check the spelling (here is {Path.cwd()})")
    if not path.stat().st_size:
        raise SourceError(f"{path}: the file is empty; copy or record it again")
    kind = path.suffix.lower()
    if kind in PICTURES:
        return PictureSource(path)
    if kind == ".npy":
        return ArraySource.load(path)
    return VideoSource(path)


def _is_bag(path: Path) -> bool:
    """Whether a path is a ROS bag: by its ending, or a ROS 2 bag's folder."""
    return (path.is_file() and path.suffix.lower() in BAGS) or (path / "metadata.yaml").is_file()


