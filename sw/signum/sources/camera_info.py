# SPDX-License-Identifier: Apache-2.0
"""Calibrations that a bag holds beside its pictures: messages sensor_msgs/CameraInfo and foxglove.CameraCalibration."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from signum.geometry.document import Entries
from signum.geometry.lens import CalibrationError
from signum.sources.logs import MEND, Log, opened

KINDS = "sensor_msgs/msg/CameraInfo", "foxglove.CameraCalibration", "foxglove_msgs/msg/CameraCalibration"
FIELDS = "width", "height", "distortion_model", "binning_x", "binning_y", "roi"
"""Fields whose names are the same in ROS 1 and 2; d, k, r and p are capitals in ROS 1."""
PART = "x_offset", "y_offset", "width", "height"
"""Fields of a region of interest."""


def read_camera_infos(path: Path, topics: list[str], count: int) -> list[Entries]:
    """The entries of the first message of each of `count` topics.

    Args:
        path: of the bag.
        topics: their names; none, if the bag has no more than are needed.
        count: how many cameras: 1, or 2 for a pair, whose left one is then the topic with "left" in its name.

    Raises:
        SourceError: if it is no bag.
        CalibrationError: if it has no such topics, or the messages cannot be read.
    """
    with opened(path) as log:
        there = sorted(name for name, topic in log.topics.items() if topic.kind in KINDS)
        if not there:
            raise CalibrationError(f"{path}: no CameraInfo in this bag (it has {', '.join(sorted(log.topics))}); give "
                                   "a calibration file")
        asked = topics or sorted(there, key=lambda name: "left" not in name)
        example = f"'{path}#{','.join(sorted(there, key=lambda name: 'left' not in name)[:count])}'"
        if len(asked) != count or (count == 2 and not topics and "left" not in asked[0]):
            raise CalibrationError(f"{path}: has CameraInfo on {', '.join(there)}; name "
                                   f"{'one' if count == 1 else 'the left and the right one'}, e.g. {example}")
        unknown = [name for name in asked if name not in there]
        if unknown:
            raise CalibrationError(f"{path}: no CameraInfo on {unknown[0]}; it has {', '.join(there)}")
        return [Entries(_tree(_first(log, path, name)), f"{path}#{name}") for name in asked]


def _first(log: Log, path: Path, topic: str) -> Any:
    try:
        _, message = next(log.messages(topic))
    except StopIteration:
        raise CalibrationError(f"{path}#{topic}: no message on this topic; give a calibration file") from None
    except Exception as error:  # a damaged bag makes its reader raise errors of any type
        raise CalibrationError(f"{path}#{topic}: cannot be read ({error}); mend it with {MEND}, or give a calibration "
                               "file") from error
    return message


def _tree(message: Any) -> dict[str, Any]:
    """A message's fields by their names in ROS 2, as its YAML would have them."""
    out: dict[str, Any] = {name: getattr(message, name) for name in FIELDS if hasattr(message, name)}
    if "roi" in out:
        out["roi"] = {name: getattr(out["roi"], name) for name in PART}
    for name in "dkrp":
        value = getattr(message, name, None)
        value = getattr(message, name.upper(), ()) if value is None else value
        out[name] = np.asarray(value, np.float64).ravel().tolist()
    return out
