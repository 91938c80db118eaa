# SPDX-License-Identifier: Apache-2.0
"""Calibration files as trees of mappings, lists, numbers and texts, and their entries, each checked as it is read.

What OpenCV has written (YAML with its `%YAML` head, XML, JSON) is parsed by OpenCV, other YAML (ROS, Kalibr) by PyYAML.
The numbers of a matrix are taken one by one: OpenCV's own reading would trust `rows`, `cols` and `dt`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.common.checks import array, check_pixels, read_text, within
from signum.common.errors import lacking
from signum.geometry.lens import CalibrationError

REAL = "d", "f"
"""Types of a matrix' numbers, as OpenCV names them: float64 and float32."""
COEFFICIENTS = 4, 5, 8, 12, 14
"""Numbers of distortion coefficients that OpenCV's pinhole model has."""
LARGEST_COEFFICIENT = 1e4
"""Largest magnitude of a distortion coefficient."""
LARGEST_PX = 1e6
"""Largest focal length or coordinate of the principal point, pixels."""
LONGEST_SIDE = 65535
"""Largest width or height of a picture, pixels."""
LARGEST_SKEW_PX = 0.05
"""Largest shift by a skew at the picture's edge, pixels: OpenCV's models have none."""
DEEPEST = 32
"""Levels of lists in lists of a file that is parsed."""


class Entries:
    """The entries of a calibration.

    Args:
        tree: name of each entry and its value: a mapping, list, number or text.
        label: what messages begin with: the file's name.
    """

    def __init__(self, tree: Mapping[str, Any], label: str) -> None:
        self.tree, self.label = tree, label

    def has(self, *names: str) -> bool:
        """Whether there are entries of all these names."""
        return all(self.tree.get(name) is not None for name in names)

    def below(self, name: str) -> Entries:
        """The entries of a mapping.

        Raises:
            CalibrationError: if there is none of that name.
        """
        node = self.tree.get(name)
        if not isinstance(node, Mapping):
            raise CalibrationError(f"{self.label}: {name} is no mapping; expected the entries of a camera")
        return Entries(node, f"{self.label}: {name}")

    def text(self, name: str) -> str:
        """A text in small letters; empty where there is none."""
        return str(self.tree.get(name) or "").strip().lower()

    def matrix(self, names: tuple[str, ...], shapes: Sequence[tuple[int, ...]], largest: float) -> Floats:
        """The first entry that there is of those names.

        Raises:
            CalibrationError: if there is none, or it is no matrix of one of the shapes with finite numbers.
        """
        name, node = self._entry(*names)
        label = f"{self.label}: {name}"
        shape: tuple[int, ...] | None = None
        if isinstance(node, Mapping):
            kind = node.get("dt", "d")
            if kind not in REAL:
                raise CalibrationError(f"{label} has dt {kind!r}; expected one of {', '.join(REAL)}")
            sides = node.get("sizes") or [node.get("rows"), node.get("cols")]  # sizes: any number of dimensions
            shape = tuple(_whole(side, f"{label}: rows or cols") for side in sides)
            node = node.get("data")
        elif not isinstance(node, list | tuple):
            raise CalibrationError(f"{label} is no matrix; expected rows, cols, dt and data")
        data = node if isinstance(node, list | tuple) else []
        if data and all(isinstance(line, list | tuple) and len(line) == len(data[0]) for line in data):
            shape = shape or (len(data), len(data[0]))
            data = [value for line in data for value in line]
        shape = shape or (len(data),)
        if math.prod(shape) != len(data):
            raise CalibrationError(f"{label} has {len(data)} numbers; expected {math.prod(shape)}, as its shape is "
                                   f"{'x'.join(map(str, shape))}")
        numbers = [_number(value) for value in data]
        if None in numbers:
            raise CalibrationError(f"{label} contains what is no number; expected {len(data)} numbers")
        return array(np.array(numbers, np.float64).reshape(shape), label, shapes, largest, CalibrationError)

    def camera(self, *names: str) -> Floats:
        """A camera matrix (3, 3): focal lengths and principal point in pixels."""
        value = self.matrix(names, [(3, 3), (9,)], LARGEST_PX).reshape(3, 3)
        label = f"{self.label}: {self._entry(*names)[0]}"
        if not value.any():
            raise CalibrationError(f"{label} is all 0: the camera was not calibrated when this was recorded")
        for axis in (0, 1):
            within(float(value[axis, axis]), f"{label}: focal length {'xy'[axis]}", 1.0, LARGEST_PX, CalibrationError)
        if value[1, 0] or value[2].tolist() != [0, 0, 1]:
            raise CalibrationError(f"{label}: expected fx s cx, 0 fy cy, 0 0 1")
        skew = float(value[0, 1] / value[1, 1] * max(value[1, 2], 1.0))
        if abs(skew) > LARGEST_SKEW_PX:
            raise CalibrationError(f"{label}: a skew of {value[0, 1]:g}, which OpenCV's models do not have: calibrate "
                                   "without it (CALIB_FIX_SKEW)")
        return value

    def distortion(self, *names: str, fisheye: bool = False) -> Floats:
        """Distortion coefficients (n,), as many as OpenCV's model has; an empty list is a lens without distortion."""
        if self._entry(*names)[1] in ([], ()):
            return np.zeros(4 if fisheye else 5)
        counts = (4, 5) if fisheye else COEFFICIENTS
        shapes = [shape for n in counts for shape in ((n,), (1, n), (n, 1))]
        value = self.matrix(names, shapes, LARGEST_COEFFICIENT).ravel()
        if fisheye and value[4:].any():
            raise CalibrationError(f"{self.label}: {self._entry(*names)[0]} has 5 coefficients; expected 4 of a "
                                   "fisheye lens (k1 k2 k3 k4)")
        return value[:4] if fisheye else value

    def size(self) -> tuple[int, int]:
        """Width and height of the pictures."""
        names = next((pair for pair in (("image_width", "image_height"), ("width", "height")) if self.has(*pair)), None)
        if names is None:
            raise CalibrationError(f"{self.label}: has no image_width and image_height")
        width, height = (_whole(self.tree[name], f"{self.label}: {name}") for name in names)
        check_pixels(width, height, f"{self.label}: {names[0]} and {names[1]}", CalibrationError)
        return width, height

    def whole(self, name: str, least: int = 0) -> int:
        """A whole number; `least` where there is none, which is also the smallest that is allowed."""
        value = self.tree.get(name)
        return least if value is None else _whole(value, f"{self.label}: {name}", least)

    def _entry(self, *names: str) -> tuple[str, Any]:
        for name in names:
            if self.tree.get(name) is not None:
                return name, self.tree[name]
        raise CalibrationError(f"{self.label}: has no {' or '.join(names)}; "
                               "see OpenCV's calibration samples for the names")


def read_entries(path: Path) -> Entries:
    """The entries of a calibration file: OpenCV's YAML, XML or JSON, or other YAML.

    Raises:
        CalibrationError: if there is no such file, or it is none of these.
    """
    text = read_text(path, "calibration", CalibrationError)
    broken = f"{path}: not an OpenCV YAML file, nor YAML of ROS or Kalibr"
    if _depth(text) > DEEPEST:
        raise CalibrationError(f"{broken} (lists lie in lists {DEEPEST} deep)")
    try:
        opencv = text.lstrip().startswith(("%YAML", "<?xml", "{"))
        tree = _by_opencv(text) if opencv else _plain(text)
    except (cv2.error, SystemError, ValueError, RecursionError) as error:
        where = f" ({error})" if str(error).startswith("line ") else ""
        raise CalibrationError(f"{broken}{where}; write it again with what made it") from error
    if not isinstance(tree, Mapping):
        raise CalibrationError(f"{broken}: it has no entries")
    return Entries({str(name): value for name, value in tree.items()}, str(path))


def _plain(text: str) -> Any:
    try:
        from signum.geometry.plain_yaml import parse_yaml
    except ModuleNotFoundError as error:
        raise lacking("ros", error) from error
    return parse_yaml(text)


def _by_opencv(text: str) -> Any:
    storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
    if not storage.isOpened():
        raise ValueError("not opened")
    return _value(storage.root())


def _value(node: cv2.FileNode) -> Any:
    """A node of OpenCV's storage, and those below."""
    if node.isMap():
        return {key: _value(node.getNode(key)) for key in list(node.keys())}
    if node.isSeq():
        return [_value(node.at(i)) for i in range(node.size())]
    if node.isInt() or node.isReal():
        return node.real()
    return node.string() if node.isString() else None


def _number(value: Any) -> float | None:
    """A number; also one that YAML 1.1 takes for a text, as 1e-05. None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        return float(value)
    except (ValueError, OverflowError):
        return None


def _whole(value: Any, label: str, least: int = 1) -> int:
    number = None if isinstance(value, str) else _number(value)
    if number is None or not math.isfinite(number) or number != round(number):
        raise CalibrationError(f"{label} is no whole number; expected one from {least} to {LONGEST_SIDE}")
    return int(within(number, label, least, LONGEST_SIDE, CalibrationError))


def _depth(text: str) -> int:
    """How deep brackets, indented lines or dashes lie in each other: the parsers call themselves for each level."""
    depth = deepest = 0
    for character in text:
        if character in "[{<":
            depth += 1
            deepest = max(deepest, depth)
        elif character in "]}>":
            depth -= 1
    indents: set[int] = set()
    for line in text.splitlines():
        head = line[:len(line) - len(line.lstrip(" -"))]
        indents.add(len(head))
        deepest = max(deepest, head.count("- "))
    return max(deepest, len(indents))
