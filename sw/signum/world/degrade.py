# SPDX-License-Identifier: Apache-2.0
"""Murky water as the paper's figure 8 makes it."""

from __future__ import annotations

import numpy as np

from signum.common.arrays import Image

SNOW = 250
"""Number of snow flakes."""
MID_GREY = 128
"""Grey level about which contrast is reduced."""


def degrade(image: Image, seed: int = 0, light_radius: float = 0.25, corner_light: float = 0.3) -> Image:
    """The paper's three degradations, one after the other.

    1. contrast: intensity / 4, recentred to mid grey;
    2. light: times 1 - k (r - r0)^2 beyond the distance r0 from the centre;
    3. snow: 250 solid white 3x3 squares, uniformly placed, whole ones.

    Args:
        image: uint8 (H, W), at least 3x3.
        seed: of the snow.
        light_radius: r0 as a fraction of the half diagonal, below 1. The paper gives neither r0 nor k.
        corner_light: light left in the corners, which fixes k.

    Returns:
        uint8 (H, W).
    """
    height, width = image.shape
    y, x = np.mgrid[:height, :width] - np.array([(height - 1) / 2, (width - 1) / 2])[:, None, None]
    beyond = np.clip(np.hypot(x, y) / (np.hypot(width, height) / 2) - light_radius, 0, None) / (1 - light_radius)
    light = 1 - (1 - corner_light) * beyond**2
    out: Image = np.rint((image / 4 + (MID_GREY - MID_GREY / 4)) * light).astype(np.uint8)
    rng = np.random.default_rng(seed)
    for top, left in zip(rng.integers(0, height - 2, SNOW), rng.integers(0, width - 2, SNOW), strict=True):
        out[top:top + 3, left:left + 3] = 255
    return out
