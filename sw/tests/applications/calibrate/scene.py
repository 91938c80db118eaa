# SPDX-License-Identifier: Apache-2.0
"""Pictures of a board by a camera that is known: every pixel's ray is met with the board, four rays a pixel; and the
corners alone, also through a flat port."""

from __future__ import annotations

import cv2
import numpy as np

from signum.applications.calibrate.target import SquareBoard, TargetKind
from signum.common.arrays import Floats, Image
from signum.geometry.lens import Lens

FINE = 2
"""Rays across and down a pixel."""
SQUARE_PX = 60
"""Side of a square of the board's texture, pixels."""
CHARUCO = SquareBoard(TargetKind.charuco, (11, 8), 0.03, 0.0225, "5X5_100")
CHESSBOARD = SquareBoard(TargetKind.chessboard, (10, 7), 0.03, 0.02, "5X5_100")
SIZE = 480, 360
NARROW = Lens(np.array([[420.0, 0, 243.3], [0, 417.0, 177.8], [0, 0, 1]]),
              np.array([-0.28, 0.09, 0.0008, -0.0005, 0.0]), SIZE)
FISHEYE = Lens(np.array([[214.0, 0, 241.4], [0, 213.0, 182.7], [0, 0, 1]]), np.array([0.04, -0.02, 0.008, -0.002]),
               SIZE, True)

Pose = tuple[Floats, Floats]
"""Rotation matrix (3, 3) and translation (3,), metres, from the board's axes to the camera's."""


def poses(count: int, seed: int, reach: float, near: float, far: float, tilt_deg: float = 40.0) -> list[Pose]:
    """Places of the board all over the view: in turns of a grid, tilted to all sides.

    Args:
        count: of the poses.
        seed: of the places.
        reach: largest x/z and y/z times 3/4 of the board's middle.
        near: smallest distance, metres.
        far: largest distance, metres.
        tilt_deg: largest tilt.
    """
    rng = np.random.default_rng(seed)
    middle = np.array([*CHARUCO.squares, 0]) * CHARUCO.square_m / 2
    out = []
    for k in range(count):
        x, y = np.array([k % 3 - 1, k // 3 % 3 - 1]) + rng.uniform(-0.25, 0.25, 2)
        z = float(rng.uniform(near, far))
        around = np.deg2rad(np.append(rng.uniform(-tilt_deg, tilt_deg, 2), rng.uniform(-25, 25)))
        turn = np.asarray(cv2.Rodrigues(around)[0], np.float64)
        move = np.array([x * reach * z, 0.75 * y * reach * z, z])
        out.append((turn, np.asarray(move - turn @ middle)))
    return out


class Scene:
    """What a camera sees of a board.

    Args:
        lens: the camera.
        target: the board.
        seed: of the noise.
    """

    def __init__(self, lens: Lens, target: SquareBoard, seed: int = 0) -> None:
        self.lens, self.target = lens, target
        self._texture = cv2.GaussianBlur(target.draw(SQUARE_PX).astype(np.float32), (0, 0), 1.0)
        self._rng = np.random.default_rng(seed)
        width, height = lens.size
        u, v = np.meshgrid(np.arange(width), np.arange(height))
        rays = lens.rays(np.stack([u.ravel(), v.ravel()], -1)).reshape(*u.shape, 2).astype(np.float32)
        self._rays = np.asarray(cv2.resize(rays, None, fx=FINE, fy=FINE, interpolation=cv2.INTER_LINEAR))

    def picture(self, pose: Pose) -> Image:
        """The picture, uint8 (H, W), of a blurred and noisy camera."""
        turn, move = pose
        plane = np.linalg.inv(np.c_[turn[:, :2], move]).astype(np.float32)  # a ray (x, y, 1) to the board's metres
        x, y = self._rays[..., 0], self._rays[..., 1]
        a, b, c = (row[0] * x + row[1] * y + row[2] for row in plane)
        scale = np.float32(SQUARE_PX / self.target.square_m) / np.where(c > 1e-6, c, np.float32(np.inf))
        x, y = (np.where(c > 1e-6, w * scale + np.float32(SQUARE_PX - 0.5), np.float32(-1e4)) for w in (a, b))
        fine = cv2.remap(self._texture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=120)
        plain = cv2.resize(np.asarray(fine), self.lens.size, interpolation=cv2.INTER_AREA)
        seen = 30 + 0.75 * cv2.GaussianBlur(plain, (0, 0), 0.6) + self._rng.normal(0, 2, plain.shape)
        return np.asarray(np.clip(np.rint(seen), 0, 255), np.uint8)


def beside(pose: Pose, turn: Floats, move: Floats) -> Pose:
    """A pose in the axes of a second camera, to which (turn, move) lead."""
    return turn @ pose[0], turn @ pose[1] + move


def undistortion_error(found: Lens, true: Lens) -> float:
    """Largest error of the undistortion over the whole picture without distortion: by how many pixels of the camera's
    picture a pixel is taken from beside its true place."""
    one, two = (np.stack(lens.maps(matrix=true.matrix)) for lens in (found, true))
    return float(np.hypot(*(one - two)).max())


def through_port(points: Floats, lens: Lens, gap: float, index: float = 1.333) -> Floats:
    """Pixels (n, 2) of points (n, 3) in water behind a flat port at `gap` metres before the camera's pupil, square to
    its axis; the glass is thin. Each ray obeys Snell's law at the port.

    The height h where a point's ray meets the port solves h = gap tan(a), r - h = (z - gap) tan(b), sin a = index sin
    b, by bisection.
    """
    r, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    low, high = np.zeros(len(r)), np.full(len(r), np.pi / 2 - 1e-9)
    for _ in range(60):
        angle = (low + high) / 2
        water = np.arcsin(np.sin(angle) / index)
        beyond = gap * np.tan(angle) + (z - gap) * np.tan(water) > r
        low, high = np.where(beyond, low, angle), np.where(beyond, angle, high)
    factor = np.where(r > 0, np.tan((low + high) / 2) / np.maximum(r, 1e-12), 1 / z)
    return lens.project(np.stack([points[:, 0] * factor, points[:, 1] * factor, np.ones(len(r))], -1))


def chessboard_points(target: SquareBoard) -> Floats:
    """Inner corners (n, 3), metres, of a board."""
    i, j = np.meshgrid(np.arange(1, target.squares[0]), np.arange(1, target.squares[1]))
    return np.asarray(np.stack([i.ravel(), j.ravel(), np.zeros(i.size)], -1) * target.square_m, np.float64)
