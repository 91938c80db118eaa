# SPDX-License-Identifier: Apache-2.0
"""Water, lamp and sensor in a picture: attenuation, backscatter, light cone, fall-off, marine snow, noise.

A point of albedo J at range R, lit by a lamp beside the camera, has the grey level
`J light(angle) exp(-2 c (R - R0)) (R0 / R)^2 + B (1 - exp(-2 c R))`; R0 is the range at which the exposure is set.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.geometry.camera import Sight
from signum.world.camera import Pinhole
from signum.world.seafloor import Float


@dataclass(frozen=True)
class Water:
    """Water, lamp and sensor.

    Attributes:
        attenuation: c, per metre.
        backscatter: B, grey levels of light scattered back by an infinite path.
        cone: half angle of the lamp's cone at which its light falls to 1/e, radians; 0 is even light.
        exposed: R0, metres.
        snow: particles in view at any time.
        noise: standard deviation of the sensor's noise, grey levels.
        figure8: the paper's contrast loss (to a quarter, about mid grey) and radial fall-off in addition.
    """

    attenuation: float = 0.0
    backscatter: float = 0.0
    cone: float = 0.0
    exposed: float = 2.0
    snow: int = 0
    noise: float = 0.0
    figure8: bool = False


CLEAR = Water()
COASTAL = Water(attenuation=0.25, backscatter=60.0, cone=0.6, snow=150, noise=1.5)
"""Turbid coastal water with a lamp."""
PAPER = Water(snow=250, noise=1.0, figure8=True)
"""The degradation of the paper's figure 8, with snow that drifts."""
WATERS = {"clear": CLEAR, "coastal": COASTAL, "paper": PAPER}
"""By name."""


@dataclass
class Snow:
    """Marine snow: particles spread over the space before the camera, sinking and drifting with the water.

    They fill a box that moves with the camera and wraps round, so their number in view is constant.
    """

    count: int
    seed: int = 0
    box: float = 3.0
    sink: float = 0.02
    positions: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng([self.seed, 2])
        # A frustum fills about a twelfth of the box around it.
        self.positions = self._rng.uniform(0, self.box, (12 * self.count, 3))

    def drift(self, flow: Floats, dt: float) -> None:
        """Carry the particles with water flowing at `flow` (3,) m/s for dt seconds."""
        wander = self._rng.normal(0.0, 0.03 * np.sqrt(dt), self.positions.shape)
        self.positions = (self.positions + (flow + np.array([0, 0, self.sink])) * dt + wander) % self.box

    def draw(self, image: Float, camera: Pinhole, sight: Sight, depth: Float) -> None:
        """Draw the particles nearer than the scene into `image`, in place: squares of 1 to 5 pixels, white nearest
        by."""
        local = ((self.positions - sight.position) % self.box - self.box / 2) @ sight.rotation
        z = local[:, 2]
        ahead = z > 0.15
        pixel = np.rint(local[ahead, :2] / z[ahead, None] * camera.focal + camera.centre).astype(int)
        inside = (pixel >= 0).all(axis=1) & (pixel < camera.size).all(axis=1)
        pixel, near = pixel[inside], z[ahead][inside]
        halves = np.clip(np.rint(0.5 + 0.6 / near), 0, 2).astype(int)
        shown = near < depth[pixel[:, 1], pixel[:, 0]]
        for (u, v), half in zip(pixel[shown].tolist(), halves[shown].tolist(), strict=True):
            image[max(v - half, 0):v + half + 1, max(u - half, 0):u + half + 1] = 255


def expose(albedo: Float, depth: Float, camera: Pinhole, water: Water) -> Float:
    """The light from a scene at the sensor, float32 (height, width), grey levels; before snow and noise.

    Args:
        albedo: float32 (height, width), grey levels in clear water under even light.
        depth: metres along the optical axis, infinite for open water.
        camera, water: of the picture.
    """
    image = albedo
    if water.attenuation or water.cone or water.backscatter:
        slant = _slant(camera)
        distance = depth * slant
        finite = np.isfinite(distance)
        r = np.where(finite, distance, np.float32(60.0))
        through = cv2.exp(np.float32(-2 * water.attenuation) * r)
        lit = through * (np.float32(np.exp(water.attenuation * water.exposed) * water.exposed) / r) ** 2
        if water.cone:
            lit *= _cone(camera, water.cone)
        image = albedo * lit + np.float32(water.backscatter) * (1 - through)
    if water.figure8:
        image = np.asarray((128 + (image - 128) / 4) * _fall_off(camera), np.float32)
    return np.asarray(image, np.float32)


def sense(image: Float, noise: float, rng: np.random.Generator) -> Image:
    """The sensor's picture of the light: noise, clipping, 8 bits."""
    if noise:
        image = image + np.float32(noise) * rng.standard_normal(image.shape, np.float32)
    return np.asarray(cv2.convertScaleAbs(np.maximum(image, 0)), np.uint8)


@lru_cache(maxsize=8)
def _slant(camera: Pinhole) -> Float:
    """Range divided by depth, of every pixel."""
    return np.asarray(np.sqrt((camera.rays**2).sum(axis=-1)), np.float32)


@lru_cache(maxsize=8)
def _cone(camera: Pinhole, half_angle: float) -> Float:
    """The lamp's light over the picture, relative to the axis."""
    return np.asarray(np.exp(-((np.arccos(1 / _slant(camera)) / half_angle) ** 2)), np.float32)


@lru_cache(maxsize=8)
def _fall_off(camera: Pinhole, clear: float = 0.3, corner: float = 0.5) -> Float:
    """The paper's factor, linear in (r - r0)^2 for r > r0; r0 is `clear` half diagonals, and the factor is `corner` in
    the corners."""
    r = np.hypot(camera.rays[..., 0], camera.rays[..., 1])
    r = r / r.max()
    return np.asarray(1 - (1 - corner) * (np.maximum(r - clear, 0) / (1 - clear)) ** 2, np.float32)
