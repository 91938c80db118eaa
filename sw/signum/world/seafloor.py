# SPDX-License-Identifier: Apache-2.0
"""A seafloor with relief, covered with texture quilted from a real photograph."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Image

Float = NDArray[np.float32]
PHOTOS = ("gravel", "grass", "brick")
"""scikit-image's bundled photographs that can cover a floor."""


def photograph(name: str, scale: float = 1.0) -> Image:
    """A bundled photograph of scikit-image, grey, enlarged by `scale`: uint8 (512 * scale, 512 * scale).

    Raises:
        ValueError: for a name not in PHOTOS.
    """
    if name not in PHOTOS:
        raise ValueError(f"no photograph {name!r}: one of {', '.join(PHOTOS)}")
    from skimage import data

    photo = np.asarray(getattr(data, name)(), np.uint8)
    return np.asarray(cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC), np.uint8)


def quilt(photo: Image, size: int, rng: np.random.Generator, patch: int = 256) -> Float:
    """Texture of any size without periodic repetition: rotated and mirrored random patches of a photograph, blended.

    Patches overlap by half; weights are a raised cosine, normalised to keep the variance, so that seams do not change
    the contrast.

    Args:
        photo: (h, w), both larger than `patch`.
        size: height and width of the result, pixels.
        rng: chooses the patches.
        patch: patch size, pixels, even.

    Returns:
        float32 (size, size) about the photograph's mean.
    """
    levels = photo.astype(np.float32)
    mean = float(levels.mean())
    flat = levels - cv2.GaussianBlur(levels, (0, 0), patch / 4)
    flat *= float(levels.std() / flat.std())
    step = patch // 2
    count = -(-size // step) + 1
    side = (count + 1) * step
    total, power = np.zeros((side, side), np.float32), np.zeros((side, side), np.float32)
    line = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(patch) + 0.5) / patch)
    weight = np.outer(line, line).astype(np.float32)
    for j in range(count):
        for i in range(count):
            y, x = rng.integers(0, flat.shape[0] - patch), rng.integers(0, flat.shape[1] - patch)
            piece = np.rot90(flat[y:y + patch, x:x + patch], int(rng.integers(4)))
            piece = piece[:, ::-1] if rng.integers(2) else piece
            here = np.s_[j * step:j * step + patch, i * step:i * step + patch]
            total[here] += weight * piece
            power[here] += weight**2
    inner = np.s_[step:step + size, step:step + size]
    return np.asarray(total[inner] / np.sqrt(power[inner]) + mean, np.float32)


@dataclass
class Seafloor:
    """A square patch of seafloor around the origin, continued by mirroring.

    Attributes:
        extent: length of its sides, metres.
        relief: standard deviation of its height, metres; 0 is a plane.
        feature: length scale of the relief, metres.
        texel: metres per pixel of the finest texture.
        photo: its texture, one of PHOTOS.
        quilted: whether the texture is a quilt of the photograph; False enlarges the photograph itself to the whole
            floor, so that nothing recurs on it.
        slope: (north, east) inclination of the mean plane, metres of depth per metre.
        seed: of texture and relief.
    """

    extent: float = 12.0
    relief: float = 0.0
    feature: float = 0.8
    texel: float = 0.0025
    photo: str = "gravel"
    quilted: bool = True
    slope: tuple[float, float] = (0.0, 0.0)
    seed: int = 0
    levels: list[Float] = field(init=False, repr=False)
    """Texture, each level half as fine as the one before."""
    height: Float = field(init=False, repr=False)
    """Height above the mean plane, metres, on a grid of `cell` metres."""
    cell: float = field(init=False, default=0.02)

    def __post_init__(self) -> None:
        rng = np.random.default_rng([self.seed, 1])
        photo, side = photograph(self.photo), round(self.extent / self.texel)
        self.levels = [quilt(photo, side, rng) if self.quilted else
                       cv2.resize(photo, (side, side), interpolation=cv2.INTER_CUBIC).astype(np.float32)]
        while len(self.levels) < 5:
            self.levels.append(np.asarray(cv2.pyrDown(self.levels[-1]), np.float32))
        count = round(self.extent / self.cell)
        self.height = np.zeros((count, count), np.float32)
        if self.relief > 0:
            coarse = cv2.GaussianBlur(rng.standard_normal((count, count)).astype(np.float32), (0, 0),
                                      self.feature / self.cell, borderType=cv2.BORDER_REFLECT_101)
            fine = cv2.GaussianBlur(rng.standard_normal((count, count)).astype(np.float32), (0, 0),
                                    self.feature / self.cell / 3, borderType=cv2.BORDER_REFLECT_101)
            shape = coarse / coarse.std() + 0.25 * fine / fine.std()
            self.height = np.asarray(self.relief * shape / shape.std(), np.float32)

    def depth(self, x: Float, y: Float) -> Float:
        """Z of the floor at north x, east y (metres), float32 of their shape; down is positive."""
        z = self.slope[0] * x + self.slope[1] * y
        if self.relief > 0:
            z = z - self._sample(self.height, x, y, self.cell, cv2.INTER_LINEAR)
        return np.asarray(z, np.float32)

    def albedo(self, x: Float, y: Float, footprint: float) -> Float:
        """Texture at north x, east y (metres), grey levels, seen with pixels that cover `footprint` metres."""
        level = int(np.clip(round(np.log2(max(footprint, 1e-9) / self.texel)), 0, len(self.levels) - 1))
        return self._sample(self.levels[level], x, y, self.texel * 2**level, cv2.INTER_CUBIC)

    def _sample(self, grid: Float, x: Float, y: Float, cell: float, how: int) -> Float:
        """`grid` at (x, y): rows run north to south, columns west to east."""
        middle = (grid.shape[0] - 1) / 2
        column = np.asarray(y / cell + middle, np.float32)
        row = np.asarray(middle - x / cell, np.float32)
        return np.asarray(cv2.remap(grid, column, row, how, borderMode=cv2.BORDER_REFLECT_101), np.float32)
