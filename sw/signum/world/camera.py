# SPDX-License-Identifier: Apache-2.0
"""Pinhole cameras and their pictures of the seafloor."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.geometry.camera import Sight
from signum.world.seafloor import Float, Seafloor

BASELINE_M = 0.12
"""Distance between the two cameras of the simulated stereo pair, metres."""
COARSE = 4
"""Pixels between the rays whose intersection with the floor is computed; it is interpolated in between, as relief is
smooth at that scale."""
MEET_ITERATIONS = 5
"""Fixed-point iterations of that intersection; each reduces the error by the slope times the tangent of the viewing
angle."""


@dataclass(frozen=True, eq=False)
class Pinhole:
    """A distortion-free camera: size (width, height) and focal length in pixels; the axis meets the image centre."""

    size: tuple[int, int] = (384, 288)
    focal: float = 400.0
    rays: Float = field(init=False, repr=False)
    """Camera-frame directions of all pixels, z = 1, float32 (height, width, 3)."""

    def __post_init__(self) -> None:
        u, v = np.meshgrid(np.arange(self.size[0]), np.arange(self.size[1]))
        cx, cy = self.centre
        object.__setattr__(self, "rays", np.stack([(u - cx) / self.focal, (v - cy) / self.focal, np.ones_like(u)],
                                                  axis=-1).astype(np.float32))

    @property
    def centre(self) -> tuple[float, float]:
        """Principal point, pixels."""
        return (self.size[0] - 1) / 2, (self.size[1] - 1) / 2

    def project(self, sight: Sight, points: Floats) -> Floats:
        """Pixels (n, 2) of world points (n, 3); NaN behind the camera."""
        local = (np.atleast_2d(points) - sight.position) @ sight.rotation
        z = np.where(local[:, 2] > 1e-6, local[:, 2], np.nan)
        return np.asarray(local[:, :2] / z[:, None] * self.focal + self.centre)

    def unproject(self, sight: Sight, pixels: Floats, depths: Floats) -> Floats:
        """World points (n, 3) seen at pixels (n, 2) with depths (n,) along the optical axis, metres."""
        rays = np.hstack([(np.atleast_2d(pixels) - self.centre) / self.focal, np.ones((len(depths), 1))])
        return np.asarray(sight.position + (rays * np.asarray(depths)[:, None]) @ sight.rotation.T)

    def meet(self, sight: Sight, floor: Seafloor) -> Float:
        """Depth of the floor along the optical axis, metres, float32 (height, width); infinite where a pixel's ray does
        not meet the floor within 60 m.
        """
        width, height = self.size
        step_u, step_v = -(-(width - 1) // COARSE), -(-(height - 1) // COARSE)
        u, v = np.meshgrid(np.arange(step_u + 1) * COARSE, np.arange(step_v + 1) * COARSE)
        cx, cy = self.centre
        local = np.stack([(u - cx) / self.focal, (v - cy) / self.focal, np.ones_like(u)], axis=-1)
        ray = (local @ sight.rotation.T).astype(np.float32)
        down = np.maximum(ray[..., 2], 1e-3)
        x0, y0, z0 = (np.float32(c) for c in sight.position)
        t = np.asarray(-z0 / down, np.float32)
        for _ in range(MEET_ITERATIONS if floor.relief > 0 or any(floor.slope) else 0):
            t = np.asarray((floor.depth(x0 + t * ray[..., 0], y0 + t * ray[..., 1]) - z0) / down, np.float32)
        # 1/t is linear in the pixel over a plane, so interpolating it is exact there.
        inverse = 1 / np.maximum(t, np.float32(1e-3))
        matrix = np.array([[1 / COARSE, 0, 0], [0, 1 / COARSE, 0]], np.float64)
        full = cv2.warpAffine(inverse, matrix, self.size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                              borderMode=cv2.BORDER_REPLICATE)
        out = 1 / np.maximum(full, np.float32(1 / 60))
        out[out >= 60] = np.inf
        return np.asarray(out, np.float32)


def see_floor(camera: Pinhole, sight: Sight, floor: Seafloor) -> tuple[Float, Float]:
    """The floor in clear water under even light.

    Returns:
        (albedo in grey levels, depth along the optical axis in metres, infinite where no floor is seen), float32
        (height, width).
    """
    depth = camera.meet(sight, floor)
    seen = np.isfinite(depth)
    t = np.where(seen, depth, np.float32(0))
    turn = sight.rotation.astype(np.float32)
    x = t * (camera.rays @ turn[0]) + np.float32(sight.position[0])
    y = t * (camera.rays @ turn[1]) + np.float32(sight.position[1])
    middle = float(np.median(t[seen])) if seen.any() else 1.0
    albedo = floor.albedo(x, y, middle / camera.focal)
    albedo[~seen] = 0
    return albedo, depth
