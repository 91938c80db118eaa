# SPDX-License-Identifier: Apache-2.0
"""The lens of one camera: how directions fall on its picture, by OpenCV's pinhole model or its fisheye model.

Both begin with a direction's x/z and y/z. The pinhole model (plumb_bob, radtan, rational_polynomial in ROS and Kalibr)
multiplies them by a polynomial of the radius; the fisheye model (equidistant, Kannala and Brandt) by one of the angle,
so that it reaches wide lenses, where the radius grows without bound. Source: OpenCV's documentation of the modules
calib3d and fisheye.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.common.errors import SignumError


class CalibrationError(SignumError):
    """A calibration that cannot be used."""


@dataclass(frozen=True, eq=False)
class Lens:
    """A calibrated camera.

    Attributes:
        matrix: camera matrix (3, 3), pixels.
        distortion: coefficients (n,) as OpenCV orders them: 4, 5, 8, 12 or 14 of the pinhole model, 4 of the fisheye's.
        size: width and height of the pictures it is for, pixels.
        fisheye: whether the coefficients are those of the fisheye model.
    """

    matrix: Floats
    distortion: Floats
    size: tuple[int, int]
    fisheye: bool = False

    @property
    def focal(self) -> float:
        """Focal length across, pixels; also that of frames whose distortion is taken out."""
        return float(self.matrix[0, 0])

    def scaled(self, size: tuple[int, int], label: str = "calibration") -> Lens:
        """The same camera with pictures of another resolution, (width, height), of the same view.

        Raises:
            CalibrationError: if the pictures have another aspect, so that they cannot be the whole view; the message
                begins with `label`.
        """
        if size == self.size:
            return self
        if not same_aspect(self.size, size):
            raise CalibrationError(
                f"{label}: is for {_size(self.size)} (aspect {self.size[0] / self.size[1]:.3f}), the frames are "
                f"{_size(size)} (aspect {size[0] / size[1]:.3f}): another aspect is another part of the sensor, which "
                "a calibration does not tell; calibrate at the frames' own aspect")
        return self._resized((size[0] / self.size[0], size[1] / self.size[1]), size)

    def binned(self, across: int, down: int) -> Lens:
        """The camera whose sensor joins `across` x `down` pixels into one."""
        size = self.size[0] // across, self.size[1] // down
        return self._resized((1 / across, 1 / down), size)

    def cropped(self, x: int, y: int, size: tuple[int, int]) -> Lens:
        """The camera that gives only the part of its view whose top left pixel is (x, y), of size (width, height)."""
        matrix = self.matrix.copy()
        matrix[:2, 2] -= x, y
        return replace(self, matrix=matrix, size=size)

    def _resized(self, factor: tuple[float, float], size: tuple[int, int]) -> Lens:
        matrix = self.matrix.copy()
        matrix[0, :2] *= factor[0]
        matrix[1, 1] *= factor[1]
        matrix[:2, 2] = (matrix[:2, 2] + 0.5) * factor - 0.5  # (0, 0) is the centre of the top left pixel
        return replace(self, matrix=matrix, size=size)

    def maps(self, turn: Floats | None = None, matrix: Floats | None = None) -> tuple[Floats, Floats]:
        """For every pixel of a picture without distortion, the x and y in this camera's picture; float32 (height,
        width).

        Args:
            turn: rotation (3, 3) from this camera to the one without distortion; none by default.
            matrix: camera matrix (3, 3) of the one without distortion; by default this one's.
        """
        turned = np.eye(3) if turn is None else np.asarray(turn, np.float64)
        new = self.matrix if matrix is None else np.asarray(matrix, np.float64)[:, :3]
        make = cv2.fisheye.initUndistortRectifyMap if self.fisheye else cv2.initUndistortRectifyMap
        x, y = make(self.matrix, self._coefficients, turned, new, self.size, cv2.CV_32FC1)
        return np.asarray(x), np.asarray(y)

    def project(self, points: Floats, turn: Floats | None = None, move: Floats | None = None) -> Floats:
        """Pixels (n, 2) of points (n, 3), which rotation (3,) or (3, 3) and translation (3,) take to the camera's
        axes: right, down, forward."""
        around = np.zeros(3) if turn is None else np.asarray(turn, np.float64)
        around = np.asarray(cv2.Rodrigues(around)[0] if around.shape == (3, 3) else around, np.float64).reshape(3)
        shift = np.zeros(3) if move is None else np.asarray(move, np.float64).reshape(3)
        cloud = np.ascontiguousarray(points, np.float64).reshape(-1, 1, 3)
        if self.fisheye:
            seen, _ = cv2.fisheye.projectPoints(cloud, around, shift, self.matrix, self._coefficients)
        else:
            seen, _ = cv2.projectPoints(cloud, around, shift, self.matrix, self._coefficients)
        return np.asarray(seen, np.float64).reshape(-1, 2)

    def rays(self, pixels: Floats) -> Floats:
        """x/z and y/z (n, 2) of the directions that fall on pixels (n, 2)."""
        seen = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        if self.fisheye:
            straight = cv2.fisheye.undistortPoints(seen, self.matrix, self._coefficients)
            return np.asarray(straight, np.float64).reshape(-1, 2)
        often = cv2.TERM_CRITERIA_MAX_ITER | cv2.TERM_CRITERIA_EPS, 40, 1e-10
        straight = cv2.undistortPoints(seen, self.matrix, self._coefficients, None, None, None, often)
        return np.asarray(straight, np.float64).reshape(-1, 2)

    @property
    def _coefficients(self) -> Floats:
        return self.distortion.reshape(4, 1) if self.fisheye else self.distortion


def same_aspect(one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether pictures of two sizes can show the same view: scaled to the smaller one's width, the heights differ by
    less than a pixel."""
    (width, height), (wide, high) = sorted((one, other))
    return abs(high * width / wide - height) < 1


def _size(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"
