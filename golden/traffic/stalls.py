# SPDX-License-Identifier: Apache-2.0
"""Stall shapes: endless streams of 0/1, whether one end of a handshake is ready in a clock."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import cycle, repeat

SHAPES = ("none", "cyclic", "random", "long")


def ready_pattern(shape: str, rng: random.Random) -> Iterator[int]:
    """Endless stream of `shape`: always 1; 1110 over and over; a fair coin; long runs of either.

    Raises:
        ValueError: for an unknown shape.
    """
    if shape == "none":
        return repeat(1)
    if shape == "cyclic":
        return cycle((1, 1, 1, 0))
    if shape == "random":
        return coin(0.5, rng)
    if shape == "long":
        return _long(rng)
    raise ValueError(f"unknown stall shape {shape!r}: one of {', '.join(SHAPES)}")


def coin(share: float, rng: random.Random) -> Iterator[int]:
    """Endless independent values, 1 with probability `share` (0..1)."""
    while True:
        yield int(rng.random() < share)


def _long(rng: random.Random) -> Iterator[int]:
    while True:
        yield from repeat(1, rng.randint(1, 40))
        yield from repeat(0, rng.randint(10, 80))
