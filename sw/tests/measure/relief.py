# SPDX-License-Identifier: Apache-2.0
"""Rectified pairs of floors on which boulders stand that hide parts of them, with the disparity of every left pixel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.world.seafloor import PHOTOS, Float, photograph, quilt

WIDTH, HEIGHT = 640, 431
MARGIN = 120
"""Texture beyond the picture's edges, pixels: more than any disparity."""
NOISE = 2.0
"""Standard deviation of the sensor's noise, grey levels."""

Disparity = Callable[[Float, Float], Float]
"""Disparity at left positions x, y, pixels."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Something with a disparity and a texture of its own; `covers` tells at which left positions x, y it is."""

    disparity: Disparity
    covers: Callable[[Float, Float], np.ndarray]
    texture: Float


def relief_pair(seed: int) -> tuple[tuple[Image, Image], Float]:
    """A left and a right picture, uint8 (431, 640), and float32 (431, 640) disparities of the left one, 4 to 50 pixels.

    A sloping, undulating floor carries four to eight elliptic boulders, nearer by 4 to 20 pixels of disparity, tilted
    and bulging. Each has its own scale, contrast and brightness of one of PHOTOS. Both pictures are blurred a little
    and have noise of their own.
    """
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(WIDTH, dtype=np.float32), np.arange(HEIGHT, dtype=np.float32))
    floor = _floor(rng)
    surfaces = [Surface(floor, lambda u, v: np.ones(u.shape, bool), _texture(rng, quilted=True))]
    surfaces += [_boulder(rng, floor) for _ in range(rng.integers(4, 9))]
    left, right = np.zeros_like(x), np.zeros_like(x)
    nearest_left, nearest_right = np.full_like(x, -np.inf), np.full_like(x, -np.inf)
    for surface in surfaces:
        disparity = surface.disparity(x, y)
        _paint(left, nearest_left, surface, disparity, x, y)
        seen = x + disparity
        for _ in range(8):  # the left position that is seen at x on the right; slopes are a few percent
            seen = x + surface.disparity(seen, y)
        _paint(right, nearest_right, surface, seen - x, seen, y)
    return (_sense(left, rng), _sense(right, rng)), nearest_left


def _floor(rng: np.random.Generator) -> Disparity:
    base, slope_x, slope_y = rng.uniform(12, 22), *rng.uniform((-0.02, -0.03), (0.02, 0.03))
    swell = cv2.GaussianBlur(rng.normal(size=(HEIGHT, WIDTH)).astype(np.float32), (0, 0), float(rng.uniform(25, 60)))
    swell = np.asarray(swell * (rng.uniform(1, 4) / swell.std()), np.float32)
    lowest = base - abs(slope_x) * WIDTH / 2 - abs(slope_y) * HEIGHT / 2 + float(swell.min())
    lift = max(0.0, 4.0 - lowest)

    def disparity(u: Float, v: Float) -> Float:
        height = cv2.remap(swell, np.clip(u, 0, WIDTH - 1), np.clip(v, 0, HEIGHT - 1), cv2.INTER_LINEAR)
        return np.asarray(base + lift + slope_x * (u - WIDTH / 2) + slope_y * (v - HEIGHT / 2) + height, np.float32)

    return disparity


def _boulder(rng: np.random.Generator, floor: Disparity) -> Surface:
    x, y = rng.uniform(0, WIDTH), rng.uniform(0, HEIGHT)
    a, b = rng.uniform(25, 90, 2)
    near = rng.uniform(4, 20) + float(floor(np.array([[x]], np.float32), np.array([[y]], np.float32))[0, 0])
    tilt_x, tilt_y = rng.uniform(-0.05, 0.05, 2)
    bulge = rng.uniform(0, 5)

    def radius(u: Float, v: Float) -> Float:
        return np.asarray(((u - x) / a) ** 2 + ((v - y) / b) ** 2, np.float32)

    def disparity(u: Float, v: Float) -> Float:
        dome = bulge * np.sqrt(np.clip(1 - radius(u, v), 0, 1))
        return np.asarray(near + tilt_x * (u - x) + tilt_y * (v - y) + dome, np.float32)

    return Surface(disparity, lambda u, v: np.asarray(radius(u, v) < 1), _texture(rng))


def _texture(rng: np.random.Generator, quilted: bool = False) -> Float:
    """A photograph as it is, which is large enough for a boulder, or quilted to cover the floor without repetition."""
    photo = photograph(PHOTOS[rng.integers(len(PHOTOS))], float(rng.uniform(1.0, 1.6)))
    texture = quilt(photo, WIDTH + 2 * MARGIN, rng) if quilted else photo.astype(np.float32)
    texture = (texture - texture.mean()) / texture.std() * rng.uniform(20, 45) + rng.uniform(90, 150)
    return np.asarray(texture, np.float32)


def _paint(picture: Float, nearest: Float, surface: Surface, disparity: Float, u: Float, v: Float) -> None:
    """Where the surface, seen at left positions u, v, is nearer than what was painted before."""
    shown = surface.covers(u, v) & (disparity > nearest)
    picture[shown] = cv2.remap(surface.texture, u + MARGIN, v + MARGIN, cv2.INTER_CUBIC,
                               borderMode=cv2.BORDER_REFLECT)[shown]
    nearest[shown] = disparity[shown]


def _sense(picture: Float, rng: np.random.Generator) -> Image:
    noisy = cv2.GaussianBlur(picture, (0, 0), 0.6) + rng.normal(0, NOISE, picture.shape)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), np.uint8)
