# SPDX-License-Identifier: Apache-2.0
"""A stereo pair: how its second camera sits beside the first, and the pair as one without distortion and rotation."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.common.console import notes
from signum.geometry.lens import CalibrationError, Lens

ROTATION_ERROR = 1e-3
"""Largest error of an entry of R R' against the unit matrix."""
STILL = 1e-6
"""Largest share by which the cameras of a pair that needs no rectification differ."""
SHORTEST_BASELINE, LONGEST_BASELINE = 1e-3, 10.0
"""Length of T, metres: no pair under water is smaller or wider."""
SHORTEST_MM = 20.0
"""Length of T from which its unit is millimetres, whose cameras cannot sit closer; in between it may be either."""
LONGEST_NUMBER = 1e4
"""Largest entry of T, in whatever unit."""


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
        given: geometry of the pair as it was calibrated, if it needs no rectification.
    """

    geometry: StereoGeometry
    size: tuple[int, int]
    maps: tuple[tuple[Floats, Floats], tuple[Floats, Floats]]
    given: StereoGeometry | None = None

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


@dataclass(frozen=True, eq=False)
class Rig:
    """Two calibrated cameras.

    Attributes:
        first: camera.
        second: camera.
        turn: rotation (3, 3) from the first camera's axes (right, down, forward) to the second's.
        move: translation (3,) after it, so that the second camera sits at -turn' move of the first.
        label: what messages begin with: the calibration's name.
    """

    first: Lens
    second: Lens
    turn: Floats
    move: Floats
    label: str

    def in_metres(self) -> Rig:
        """The pair with T in metres; T in millimetres is recognised by its length, which is said.

        Raises:
            CalibrationError: if T is too short or too long for a pair of cameras in either unit.
        """
        length = float(np.linalg.norm(self.move))
        if SHORTEST_BASELINE <= length <= LONGEST_BASELINE:
            return self
        if not SHORTEST_MM <= length <= 1e3 * LONGEST_BASELINE:
            raise CalibrationError(f"{self.label}: T is of length {length:g}; expected metres, {SHORTEST_BASELINE:g} "
                                   f"to {LONGEST_BASELINE:g}, or millimetres, {SHORTEST_MM:g} to "
                                   f"{1e3 * LONGEST_BASELINE:g}")
        notes.print(f"{self.label}: T is {length:.1f} long, which can only be millimetres: taken as "
                    f"{length / 1e3:.4f} m")
        return Rig(self.first, self.second, self.turn, self.move / 1e3, self.label)

    def ordered(self) -> Rig:
        """The pair with the left camera first; a pair in the other order is exchanged, which is said.

        Raises:
            CalibrationError: if the cameras do not sit side by side.
        """
        right, down, ahead = -self.turn.T @ self.move
        if abs(right) < max(abs(down), abs(ahead)):
            where = "above or below" if abs(down) >= abs(ahead) else "before or behind"
            raise CalibrationError(f"{self.label}: the second camera sits {where} the first ({right:.3f} m to the "
                                   f"right, {down:.3f} m down, {ahead:.3f} m ahead); expected them side by side: check "
                                   "R and T, and for cameras above each other turn the pictures before calibrating")
        if right > 0:
            return self
        notes.print(f"{self.label}: by T the first camera sits {-right:.3f} m to the right of the second: they are "
                    "taken in the other order, the second for the left frames")
        return Rig(self.second, self.first, self.turn.T, -self.turn.T @ self.move, self.label)

    def _level(self) -> StereoGeometry | None:
        """Geometry of the pair if it needs no rectification, else None."""
        one, two = self.first.matrix, self.second.matrix
        if (self.first.fisheye or self.first.distortion.any() or self.second.distortion.any()
                or np.abs(self.turn - np.eye(3)).max() > STILL or np.abs(self.move[1:]).max() > -STILL * self.move[0]
                or not np.allclose(one[[0, 1, 1], [0, 1, 2]], two[[0, 1, 1], [0, 1, 2]], rtol=STILL)):
            return None
        return StereoGeometry(float(one[0, 0]), float(-self.move[0]), (float(one[0, 2]), float(one[1, 2])),
                              float(two[0, 2] - one[0, 2]))

    def scaled(self, size: tuple[int, int]) -> Rig:
        """The pair with pictures of another resolution.

        Raises:
            CalibrationError: if they have another aspect.
        """
        lenses = [lens.scaled(size, self.label) for lens in (self.first, self.second)]
        return Rig(lenses[0], lenses[1], self.turn, self.move, self.label)

    def rectifier(self, size: tuple[int, int] | None = None) -> Rectifier:
        """What rectifies the pair's frames, of `size` (width, height), by default that of the calibration.

        Raises:
            CalibrationError: if the pair cannot be rectified, or not at this size.
        """
        if self.first.size != self.second.size:
            raise CalibrationError(f"{self.label}: one camera is calibrated for {self.first.size[0]}x"
                                   f"{self.first.size[1]}, the other for {self.second.size[0]}x{self.second.size[1]}: "
                                   "both must give pictures of one size")
        if self.first.fisheye != self.second.fisheye:
            raise CalibrationError(f"{self.label}: one camera has the fisheye model, the other the pinhole model: "
                                   "calibrate both with the same")
        rig = self.in_metres().ordered()
        rig = rig if size is None else rig.scaled(size)
        one, two = rig.first, rig.second
        if one.fisheye:
            r1, r2, p1, p2, *_ = cv2.fisheye.stereoRectify(
                one.matrix, one.distortion, two.matrix, two.distortion, one.size, rig.turn, rig.move,
                cv2.CALIB_ZERO_DISPARITY)
        else:
            r1, r2, p1, p2, *_ = cv2.stereoRectify(one.matrix, one.distortion, two.matrix, two.distortion, one.size,
                                                   rig.turn, rig.move.reshape(3, 1), alpha=0)
        if not all(np.isfinite(m).all() for m in (r1, r2, p1, p2)) or not p1[0, 0] > 0 or not p2[0, 0] > 0:
            raise CalibrationError(f"{self.label}: the pair cannot be rectified; check K1 D1 K2 D2 R T")
        baseline = -p2[0, 3] / p2[0, 0]
        if not baseline > 0:
            raise CalibrationError(f"{self.label}: the second camera is not to the right of the first; check R and T")
        geometry = StereoGeometry(float(p1[0, 0]), float(baseline), (float(p1[0, 2]), float(p1[1, 2])),
                                  float(p2[0, 2] - p1[0, 2]))
        maps = [lens.maps(np.asarray(r, np.float64), np.asarray(p, np.float64)) for lens, r, p in
                ((one, r1, p1), (two, r2, p2))]
        return Rectifier(geometry, one.size, (maps[0], maps[1]), rig._level())
