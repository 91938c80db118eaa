# SPDX-License-Identifier: Apache-2.0
"""Frames from ROS 1 bags, ROS 2 bags and MCAP files: image and compressed image topics."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from signum.common.arrays import Image
from signum.common.checks import TEXT_BYTES, check_file, check_pixels
from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source, decode_picture
from signum.sources.checksums import verify_mcap

RAW, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
DIRECT = {"mono8": 1, "8UC1": 1, "bgr8": 3, "8UC3": 3, "rgb8": 3, "bgra8": 4, "rgba8": 4}
"""Encodings of plain pixels, and their number of channels."""
CONVERT = {
    "rgb8": cv2.COLOR_RGB2BGR, "bgra8": cv2.COLOR_BGRA2BGR, "rgba8": cv2.COLOR_RGBA2BGR,
    # OpenCV names a Bayer pattern by its second row, ROS by its first.
    "bayer_rggb8": cv2.COLOR_BayerBG2BGR, "bayer_bggr8": cv2.COLOR_BayerRG2BGR,
    "bayer_gbrg8": cv2.COLOR_BayerGR2BGR, "bayer_grbg8": cv2.COLOR_BayerGB2BGR}


class BagSource(Source):
    """One image topic of a bag; frames are named by their index from 0.

    Args:
        path: .bag, .mcap, .db3 or the folder of a ROS 2 bag.
        topic: its name; None if the bag has only one image topic.

    Raises:
        SourceError: if it is no bag, has no such image topic, or has several and none is named.
    """

    def __init__(self, path: Path, topic: str | None = None) -> None:
        self.path = path
        with _opened(path) as reader:
            topics = {c.topic: 0 for c in reader.connections if c.msgtype in (RAW, COMPRESSED)}
            for c in reader.connections:
                if c.topic in topics:
                    topics[c.topic] += c.msgcount
            others = sorted({c.topic for c in reader.connections} - set(topics))
        listed = ", ".join(f"{name} ({count} frames)" for name, count in topics.items())
        if not topics:
            raise SourceError(f"{path}: no image topic in this bag (it has {', '.join(others) or 'nothing'}); "
                              f"signum reads {RAW} and {COMPRESSED}")
        if topic is None and len(topics) > 1:
            raise SourceError(f"{path}: several image topics: {listed}; choose one, e.g. '{path}#{next(iter(topics))}'")
        self.topic = topic or next(iter(topics))
        if self.topic not in topics:
            raise SourceError(f"{path}: no image topic {topic}; it has {listed}")
        super().__init__(f"{path}#{self.topic}", topics[self.topic])

    def _frames(self) -> Iterator[Frame]:
        with _opened(self.path) as reader:
            chosen = [c for c in reader.connections if c.topic == self.topic]
            messages = reader.messages(connections=chosen)
            for index in count():
                try:
                    connection, _, data = next(messages)
                    message: Any = reader.deserialize(data, connection.msgtype)
                except StopIteration:
                    break
                except Exception as error:  # a damaged bag makes its reader raise errors of any type
                    raise SourceError(f"{self.label}: broken at frame {index} ({error}); what came before is kept; "
                                      "mend it with `rosbag reindex` or `ros2 bag reindex`") from error
                label = f"{self.label}: frame {index}"
                yield Frame(str(index), _compressed(message, label) if connection.msgtype == COMPRESSED
                            else _raw(message, label))
            if index != self.count:
                raise SourceError(f"{self.label}: the bag lists {self.count} frames, {index} could be read; what was "
                                  "read is kept; mend it with `rosbag reindex` or `ros2 bag reindex`")


@contextmanager
def _opened(path: Path) -> Iterator[AnyReader]:
    parts = [path]
    if path.is_dir():
        check_file(path / "metadata.yaml", "bag's metadata", SourceError, TEXT_BYTES)
        parts = [part for part in sorted(path.iterdir()) if not part.is_dir() and part.name != "metadata.yaml"]
    for part in parts:
        check_file(part, "bag", SourceError)
        if part.suffix == ".mcap":
            verify_mcap(part)
    try:
        reader = AnyReader([path], default_typestore=get_typestore(Stores.LATEST))
        reader.open()
    except Exception as error:  # of any type, from struct.error to those of sqlite
        raise SourceError(f"{path}: not a ROS bag that can be read ({error}); copy it again, or mend it with "
                          "`rosbag reindex`, `ros2 bag reindex` or `mcap recover`") from error
    try:
        yield reader
    finally:
        with suppress(Exception):  # of a damaged bag; what was wrong has been said
            reader.close()


def _raw(message: Any, label: str) -> Image:
    """The picture of a sensor_msgs/Image."""
    encoding = str(message.encoding)
    channels = 1 if encoding.startswith("bayer_") else DIRECT.get(encoding, 0)
    if not channels or (channels == 1 and encoding not in DIRECT and encoding not in CONVERT):
        raise SourceError(f"{label}: encoding {encoding!r}; signum reads {', '.join(sorted({*DIRECT, *CONVERT}))}: "
                          "convert the topic, e.g. with image_proc")
    height, width, step = int(message.height), int(message.width), int(message.step)
    data = np.frombuffer(np.ascontiguousarray(message.data), np.uint8)
    check_pixels(width, height, label, SourceError)
    if step < width * channels or data.size != height * step:
        raise SourceError(f"{label}: {data.size} bytes for {width}x{height} {encoding} pixels: the message is broken")
    rows = data[:height * step].reshape(height, step)[:, :width * channels]
    picture = rows if channels == 1 else rows.reshape(height, width, channels)
    if encoding in CONVERT:
        return np.asarray(cv2.cvtColor(np.ascontiguousarray(picture), CONVERT[encoding]), np.uint8)
    return np.array(picture, np.uint8)


def _compressed(message: Any, label: str) -> Image:
    """The picture of a sensor_msgs/CompressedImage: grey stays grey, all else is blue, green, red."""
    data = np.frombuffer(np.ascontiguousarray(message.data), np.uint8)
    picture = decode_picture(data.tobytes(), label)
    if picture.dtype != np.uint8:
        raise SourceError(f"{label}: {message.format!s} cannot be decoded to 8 bits; record the raw topic, or as JPEG")
    return np.ascontiguousarray(picture[:, :, :3] if picture.ndim == 3 else picture, np.uint8)
