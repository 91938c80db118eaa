"""Camera calibration from OpenCV's YAML: the lens of one camera, and the rectification of a stereo pair."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.common.errors import SignumError


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


def _open(path: Path) -> cv2.FileStorage:
    if not path.is_file():
        raise CalibrationError(f"{path}: no such calibration file")
    try:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    except (cv2.error, SystemError):
        storage = None
    if storage is None or not storage.isOpened():
        raise CalibrationError(f"{path}: not an OpenCV YAML file; write one with cv2.FileStorage")
    return storage


def _matrix(storage: cv2.FileStorage, path: Path, *names: str) -> Floats:
    for name in names:
        node = storage.getNode(name)
        if not node.empty():
            value = node.mat() if node.isMap() else np.array([node.real()])
            if value is not None:
                return np.asarray(value, np.float64)
    raise CalibrationError(f"{path}: has no {' or '.join(names)}; see OpenCV's calibration samples for the names")


def _size(storage: cv2.FileStorage, path: Path) -> tuple[int, int]:
    for names in (("image_width", "image_height"), ("width", "height")):
        nodes = [storage.getNode(name) for name in names]
        if not any(node.empty() for node in nodes):
            return int(nodes[0].real()), int(nodes[1].real())
    raise CalibrationError(f"{path}: has no image_width and image_height")


def read_mono(path: Path) -> tuple[Floats, Floats, tuple[int, int]]:
    """Camera matrix (3, 3), distortion coefficients and image size of a single camera.

    Accepts the names `camera_matrix` and `distortion_coefficients` (OpenCV's sample) or `K` and `D`.

    Raises:
        CalibrationError: if the file or an entry is missing.
    """
    storage = _open(path)
    distortion = _matrix(storage, path, "distortion_coefficients", "D").ravel()
    return _matrix(storage, path, "camera_matrix", "K"), distortion, _size(storage, path)


def read_stereo(path: Path) -> Rectifier:
    """Rectifier of a stereo calibration: `K1 D1 K2 D2 R T` (or `M1 ... M2`), `image_width`, `image_height`; T in
    metres.

    Raises:
        CalibrationError: if the file or an entry is missing, or the cameras do not sit side by side.
    """
    storage = _open(path)
    k1, k2 = _matrix(storage, path, "K1", "M1"), _matrix(storage, path, "K2", "M2")
    d1, d2 = _matrix(storage, path, "D1"), _matrix(storage, path, "D2")
    turn, move = _matrix(storage, path, "R"), _matrix(storage, path, "T")
    size = _size(storage, path)
    r1, r2, p1, p2, *_ = cv2.stereoRectify(k1, d1, k2, d2, size, turn, move.reshape(3, 1), alpha=0)
    baseline = -p2[0, 3] / p2[0, 0]
    if not baseline > 0:
        raise CalibrationError(f"{path}: the second camera is not to the right of the first; swap them, or check T")
    geometry = StereoGeometry(float(p1[0, 0]), float(baseline), (float(p1[0, 2]), float(p1[1, 2])),
                              float(p2[0, 2] - p1[0, 2]))

    def maps(k: Floats, d: Floats, r: object, p: object) -> tuple[Floats, Floats]:
        x, y = cv2.initUndistortRectifyMap(k, d, np.asarray(r), np.asarray(p), size, cv2.CV_32FC1)
        return np.asarray(x), np.asarray(y)

    return Rectifier(geometry, size, (maps(k1, d1, r1, p1), maps(k2, d2, r2, p2)))
