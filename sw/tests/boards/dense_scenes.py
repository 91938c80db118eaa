# SPDX-License-Identifier: Apache-2.0
"""Frames and passes for comparisons of boards with a dense engine."""

from __future__ import annotations

import random

import cv2
import numpy as np

from golden.dense import DensePass
from golden.params import Config
from signum.common.arrays import Image

MARGIN = 40
"""Pixels around a scene within which frames move."""


def scene(rng: random.Random, size: tuple[int, int]) -> Image:
    """A random texture, uint8, MARGIN larger than `size` (width, height) on every side."""
    source = np.random.default_rng(rng.getrandbits(32))
    noise = source.integers(0, 256, (size[1] + 2 * MARGIN, size[0] + 2 * MARGIN), dtype=np.uint8)
    return np.asarray(cv2.GaussianBlur(noise, (0, 0), rng.choice((0.5, 1.0, 2.0))), np.uint8)


def random_pair(rng: random.Random, size: tuple[int, int], of: Image | None = None) -> tuple[Image, Image]:
    """Two frames of a scene, the second one moved, with noise of its own; now and then of two scenes.

    Args:
        rng: of the motion and the noise.
        size: (width, height), pixels.
        of: the scene, MARGIN larger on every side; a random texture if None.
    """
    first = scene(rng, size) if of is None else of
    second = scene(rng, size) if rng.random() < 0.1 else first
    source = np.random.default_rng(rng.getrandbits(32))
    frames = []
    for seen, reach in ((first, 0), (second, 6)):
        x, y = MARGIN + rng.randint(-reach, reach), MARGIN + rng.randint(-reach // 3, reach // 3)
        frame = seen[y:y + size[1], x:x + size[0]].astype(np.int16)
        frame += source.integers(-6, 7, frame.shape, dtype=np.int16)
        frames.append(np.clip(frame, 0, 255).astype(np.uint8))
    return frames[0], frames[1]


def random_search(rng: random.Random, config: Config) -> DensePass:
    """A pass that the board takes: mostly of about the motions of `random_pair`, some far outside the image."""
    offsets = rng.choice((config.dense_offsets, config.dense_offsets, rng.randint(1, config.dense_offsets)))
    near = -offsets // 2 + rng.randint(-4, 4)
    start = near if rng.random() < 0.8 else rng.randint(-512, 511)
    down = rng.randint(-2, 2) if rng.random() < 0.8 else rng.randint(-60, 60)
    return DensePass(rng.choice(config.dense_windows), offsets, start, down)
