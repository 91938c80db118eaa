# SPDX-License-Identifier: Apache-2.0
"""Camera calibration from OpenCV's YAML: the lens of one camera, and the rectification of a stereo pair."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.common.checks import array, check_pixels, read_text, within
from signum.common.errors import SignumError

REAL = "d", "f"
"""Types of a matrix' numbers, as OpenCV names them: float64 and float32."""
COEFFICIENTS = 4, 5, 8, 12, 14
"""Numbers of distortion coefficients that OpenCV's models have."""
LARGEST_COEFFICIENT = 1e4
"""Largest magnitude of a distortion coefficient."""
LARGEST_PX = 1e6
"""Largest focal length or coordinate of the principal point, pixels."""
LONGEST_SIDE = 65535
"""Largest width or height of a picture, pixels."""
ROTATION_ERROR = 1e-3
"""Largest error of an entry of R R' against the unit matrix."""
SHORTEST_BASELINE, LONGEST_BASELINE = 1e-4, 100.0
"""Length of T, metres."""
DEEPEST = 32
"""Levels of lists in lists of a file that is parsed."""


class CalibrationError(SignumError):
    """A calibration file that cannot be used."""


@dataclass(frozen=True, eq=False)
class StereoGeometry:
    """A rectified pair: depth Z = focal * baseline / (disparity + shift).

    Attributes:
        focal: pixels.
        baseline: metres from the left to the right camera.
        centre: principal point of the left camera, pixels.
        shift: difference of the principal points, right minus left, pixels.
    """

    focal: float
    baseline: float
    centre: tuple[float, float]
    shift: float = 0.0

    def shrunk(self, factor: tuple[float, float]) -> StereoGeometry:
        """The geometry, in pixels of the smaller pair, of the pair scaled down by `factor` across and down."""
        centre = ((self.centre[0] + 0.5) / factor[0] - 0.5, (self.centre[1] + 0.5) / factor[1] - 0.5)
        return StereoGeometry(self.focal / factor[0], self.baseline, centre, self.shift / factor[0])

    def depth(self, disparity: Floats) -> Floats:
        """Metres along the optical axis of disparities in pixels, any shape; NaN where disparity + shift is not
        positive."""
        d = np.asarray(disparity, np.float64) + self.shift
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(d > 0, self.focal * self.baseline / d, np.nan)

    def points(self, x: Floats, y: Floats, disparity: Floats) -> Floats:
        """Points (n, 3), metres, right, down and forward of the left camera, of pixels x, y (n,) with disparities
        (n,)."""
        z = self.depth(disparity)
        return np.stack([(x - self.centre[0]) / self.focal * z, (y - self.centre[1]) / self.focal * z, z], axis=-1)


@dataclass(frozen=True, eq=False)
class Rectifier:
    """Rectifies the frames of two cameras.

    Attributes:
        geometry: of the rectified pair.
        size: width and height of the frames, pixels.
        maps: for the left and the right camera, the x and y in its frame of each rectified pixel, (height, width).
    """

    geometry: StereoGeometry
    size: tuple[int, int]
    maps: tuple[tuple[Floats, Floats], tuple[Floats, Floats]]

    def __call__(self, left: Image, right: Image) -> tuple[Image, Image]:
        """Rectified pair, uint8 (height, width) of the calibration's size.

        Raises:
            CalibrationError: if the frames have another size than the calibration.
        """
        out = []
        for frame, (x, y) in zip((left, right), self.maps, strict=True):
            if frame.shape[1::-1] != self.size:
                raise CalibrationError(f"frame is {frame.shape[1]}x{frame.shape[0]}, the calibration is for "
                                       f"{self.size[0]}x{self.size[1]}: use the calibration of this camera")
            out.append(np.asarray(cv2.remap(frame, x, y, cv2.INTER_LINEAR), np.uint8))
        return out[0], out[1]


class _Entries:
    """The entries of a calibration file, each checked as it is read.

    The numbers of a matrix are taken one by one: OpenCV's own reading would trust `rows`, `cols` and `dt`.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        text = read_text(path, "calibration", CalibrationError)
        broken = f"{path}: not an OpenCV YAML file; write one with cv2.FileStorage"
        if _depth(text) > DEEPEST:
            raise CalibrationError(f"{broken} (lists lie in lists {DEEPEST} deep)")
        try:
            self._storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
            opened = self._storage.isOpened()
        except (cv2.error, SystemError) as error:
            raise CalibrationError(broken) from error
        if not opened:
            raise CalibrationError(broken)

    def matrix(self, names: tuple[str, ...], shapes: Sequence[tuple[int, ...]], largest: float) -> Floats:
        """The first entry that there is of those names.

        Raises:
            CalibrationError: if there is none, or it is no matrix of one of the shapes with finite numbers.
        """
        name, node = self._node(*names)
        label = f"{self.path}: {name}"
        data = node
        shape: tuple[int, ...] = (node.size(),)
        if node.isMap():
            data, kind = node.getNode("data"), node.getNode("dt").string()
            if kind not in REAL:
                raise CalibrationError(f"{label} has dt {kind!r}; expected one of {', '.join(REAL)}")
            sizes = node.getNode("sizes")  # of an array of any number of dimensions
            sides = ([sizes.at(i) for i in range(sizes.size())] if sizes.isSeq()
                     else [node.getNode(side) for side in ("rows", "cols")])
            shape = tuple(self._whole(side, f"{label}: rows or cols") for side in sides)
        elif not node.isSeq():
            raise CalibrationError(f"{label} is no matrix; expected rows, cols, dt and data")
        count = data.size() if data.isSeq() else 0
        if math.prod(shape) != count:
            raise CalibrationError(f"{label} has {count} numbers; expected {math.prod(shape)}, as its shape is "
                                   f"{'x'.join(map(str, shape))}")
        numbers = [data.at(i) for i in range(count)]
        if not all(n.isReal() or n.isInt() for n in numbers):
            raise CalibrationError(f"{label} contains what is no number; expected {count} numbers")
        values = np.array([n.real() for n in numbers], np.float64).reshape(shape)
        return array(values, label, shapes, largest, CalibrationError)

    def camera(self, *names: str) -> Floats:
        """A camera matrix (3, 3): focal lengths and principal point in pixels."""
        value = self.matrix(names, [(3, 3)], LARGEST_PX)
        label = f"{self.path}: {self._node(*names)[0]}"
        for axis in (0, 1):
            within(float(value[axis, axis]), f"{label}: focal length {'xy'[axis]}", 1.0, LARGEST_PX, CalibrationError)
        if value[1, 0] or value[2].tolist() != [0, 0, 1]:
            raise CalibrationError(f"{label}: expected fx s cx, 0 fy cy, 0 0 1")
        return value

    def distortion(self, *names: str) -> Floats:
        """Distortion coefficients (n,), as many as OpenCV's model has."""
        shapes = [shape for n in COEFFICIENTS for shape in ((n,), (1, n), (n, 1))]
        return self.matrix(names, shapes, LARGEST_COEFFICIENT).ravel()

    def size(self) -> tuple[int, int]:
        """Width and height of the pictures."""
        names = next((pair for pair in (("image_width", "image_height"), ("width", "height"))
                      if not any(self._storage.getNode(name).empty() for name in pair)), None)
        if names is None:
            raise CalibrationError(f"{self.path}: has no image_width and image_height")
        width, height = (self._whole(self._storage.getNode(name), f"{self.path}: {name}") for name in names)
        check_pixels(width, height, f"{self.path}: {names[0]} and {names[1]}", CalibrationError)
        return width, height

    def _node(self, *names: str) -> tuple[str, cv2.FileNode]:
        for name in names:
            node = self._storage.getNode(name)
            if not node.empty():
                return name, node
        raise CalibrationError(f"{self.path}: has no {' or '.join(names)}; "
                               "see OpenCV's calibration samples for the names")

    @staticmethod
    def _whole(node: cv2.FileNode, label: str) -> int:
        if not (node.isInt() or node.isReal()) or node.real() != np.rint(node.real()):
            raise CalibrationError(f"{label} is no whole number; expected one from 1 to {LONGEST_SIDE}")
        return int(within(node.real(), label, 1, LONGEST_SIDE, CalibrationError))


def _depth(text: str) -> int:
    """How deep brackets or indented lines lie in each other: OpenCV's parser calls itself for each level."""
    depth = deepest = 0
    for character in text:
        if character in "[{<":
            depth += 1
            deepest = max(deepest, depth)
        elif character in "]}>":
            depth -= 1
    indents: set[int] = {len(line) - len(line.lstrip(" -")) for line in text.splitlines()}
    return max(deepest, len(indents))


def read_mono(path: Path) -> tuple[Floats, Floats, tuple[int, int]]:
    """Camera matrix (3, 3), distortion coefficients (n,) and image size of a single camera.

    Accepts the names `camera_matrix` and `distortion_coefficients` (OpenCV's sample) or `K` and `D`.

    Raises:
        CalibrationError: if the file or an entry is missing, or an entry is not what a camera has.
    """
    entries = _Entries(path)
    distortion = entries.distortion("distortion_coefficients", "D")
    return entries.camera("camera_matrix", "K"), distortion, entries.size()


def read_stereo(path: Path) -> Rectifier:
    """Rectifier of a stereo calibration: `K1 D1 K2 D2 R T` (or `M1 ... M2`), `image_width`, `image_height`; T in
    metres.

    Raises:
        CalibrationError: if the file or an entry is missing, an entry is not what a pair has, or the cameras do not sit
            side by side.
    """
    entries = _Entries(path)
    k1, k2 = entries.camera("K1", "M1"), entries.camera("K2", "M2")
    d1, d2 = entries.distortion("D1"), entries.distortion("D2")
    turn = entries.matrix(("R",), [(3, 3)], 1.0 + ROTATION_ERROR)
    if np.abs(turn @ turn.T - np.eye(3)).max() > ROTATION_ERROR or np.linalg.det(turn) < 0:
        raise CalibrationError(f"{path}: R is no rotation; expected orthogonal rows of length 1")
    move = entries.matrix(("T",), [(3,), (3, 1), (1, 3)], LONGEST_BASELINE)
    if not np.linalg.norm(move) >= SHORTEST_BASELINE:
        raise CalibrationError(f"{path}: T is of length {np.linalg.norm(move):g}; expected metres, "
                               f"{SHORTEST_BASELINE:g} to {LONGEST_BASELINE:g}")
    size = entries.size()
    r1, r2, p1, p2, *_ = cv2.stereoRectify(k1, d1, k2, d2, size, turn, move.reshape(3, 1), alpha=0)
    if not all(np.isfinite(m).all() for m in (r1, r2, p1, p2)) or not p1[0, 0] > 0 or not p2[0, 0] > 0:
        raise CalibrationError(f"{path}: the pair cannot be rectified; check K1 D1 K2 D2 R T")
    baseline = -p2[0, 3] / p2[0, 0]
    if not baseline > 0:
        raise CalibrationError(f"{path}: the second camera is not to the right of the first; swap them, or check T")
    geometry = StereoGeometry(float(p1[0, 0]), float(baseline), (float(p1[0, 2]), float(p1[1, 2])),
                              float(p2[0, 2] - p1[0, 2]))

    def maps(k: Floats, d: Floats, r: object, p: object) -> tuple[Floats, Floats]:
        x, y = cv2.initUndistortRectifyMap(k, d, np.asarray(r), np.asarray(p), size, cv2.CV_32FC1)
        return np.asarray(x), np.asarray(y)

    return Rectifier(geometry, size, (maps(k1, d1, r1, p1), maps(k2, d2, r2, p2)))
