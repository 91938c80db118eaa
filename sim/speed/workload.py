# SPDX-License-Identifier: Apache-2.0
"""What `make bench` runs on the cocotb bench and on the Verilated board: two small frames, then a few searches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Job
from golden.log import Image

SIZE = (160, 128)
"""Pixels: the smallest that holds a +-32 search of a 64x64 window, to keep the cocotb bench short."""
SIGMA = 2.0
SHIFT = (5, -3)
"""Displacement (x, y) of the second frame's content from the first's, in pixels."""
SEARCHES = 2


def texture(width: int, height: int, seed: int = 1) -> Image:
    """Smooth random texture, uint8 (height, width)."""
    rng = np.random.default_rng(seed)
    coarse: NDArray[np.float64] = rng.normal(size=(height, width))
    for axis in (0, 1):
        for _ in range(3):
            coarse = coarse + np.roll(coarse, 1, axis)
    low, high = float(coarse.min()), float(coarse.max())
    return ((coarse - low) / (high - low) * 255).astype(np.uint8)


def pair(width: int, height: int) -> tuple[Image, Image]:
    """Two frames of the same texture, the second's content displaced by `SHIFT`."""
    margin = max(map(abs, SHIFT))
    wide = texture(width + 2 * margin, height + 2 * margin)
    (dx, dy), m = SHIFT, margin
    return (wide[m:m + height, m:m + width].copy(),
            wide[m - dy:m - dy + height, m - dx:m - dx + width].copy())


def frames() -> tuple[Image, Image]:
    """The frames of slots 0 and 1."""
    return pair(*SIZE)


def search_job(size: tuple[int, int], tag: int, surface: bool = False) -> Job:
    """A +-32 search of the 64x64 window in the middle of slot 0's frame over slot 1's."""
    x, y = (size[0] - 64) // 2, (size[1] - 64) // 2
    return Job(0, x, y, 64, 64, 1, x - 32, y - 32, 65, 65, tag, surface)


def jobs() -> list[Job]:
    """The searches."""
    return [search_job(SIZE, tag) for tag in range(SEARCHES)]
