# SPDX-License-Identifier: Apache-2.0
"""A case of the soak: a list of operations that stands on its own, so that it can be shortened, kept and replayed."""

from __future__ import annotations

import json
import random
from abc import ABC, abstractmethod
from collections import Counter
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from golden.params import CONFIGS, Config
from signum.common.arrays import Image

Operation = dict[str, Any]
"""What to do, under `do`, and its arguments: numbers, words and lists only."""


@dataclass(frozen=True)
class Case:
    """A case.

    Attributes:
        part: name of the part of the soak that plays it.
        config: name of the configuration.
        power_up: seed of the registers' values at power-up; 0 for all registers 0.
        operations: to carry out in order. Each has all its arguments, so that any of them may be left out.
    """

    part: str
    config: str
    power_up: int
    operations: tuple[Operation, ...]

    def write(self, file: Path) -> None:
        """Write the case as JSON."""
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(asdict(self), indent=1) + "\n")

    @staticmethod
    def read(file: Path) -> Case:
        """The case in a file that `write` wrote.

        Raises:
            ValueError: if the file holds no case.
        """
        try:
            case = Case(**json.loads(file.read_text()))
        except (TypeError, ValueError) as error:
            raise ValueError(f"{file} holds no case of the soak: {error}") from error
        return replace(case, operations=tuple(case.operations))


class Difference(Exception):
    """The board did not do what the model does.

    Args:
        kind: one word, by which a shorter case is known to show the same difference.
        about: what was seen and what was expected.
    """

    def __init__(self, kind: str, about: str) -> None:
        super().__init__(kind, about)
        self.kind, self.about = kind, about

    def __str__(self) -> str:
        return f"{self.kind}: {self.about}"


class Part(ABC):
    """One part of the soak."""

    name: str
    configs: tuple[str, ...] = ("tiny",)

    @abstractmethod
    def draw(self, rng: random.Random, config: Config) -> list[Operation]:
        """The operations of a new case."""

    @abstractmethod
    def play(self, case: Case) -> Counter[str]:
        """Carry out a case; returns what was met, and how often.

        Raises:
            Difference: at the first difference.
        """


def texture(size: tuple[int, int], seed: int) -> Image:
    """A picture of `size` (width, height), uint8 (height, width): noise of full or of highest contrast, one grey (all
    responses 0), patches, or a ramp."""
    width, height = size
    source = np.random.default_rng(seed)
    kind = seed % 5
    if kind == 0:
        return source.integers(0, 256, (height, width), dtype=np.uint8)
    if kind == 1:
        return (source.integers(0, 2, (height, width), dtype=np.uint8) * 255).astype(np.uint8)
    if kind == 2:
        return np.full((height, width), seed % 256, np.uint8)
    if kind == 3:
        patches = source.integers(0, 256, (-(-height // 6), -(-width // 6)), dtype=np.uint8)
        return np.ascontiguousarray(np.kron(patches, np.ones((6, 6), np.uint8))[:height, :width])
    y, x = np.mgrid[:height, :width]
    ramp: Image = ((x * source.integers(5) + y * source.integers(5)) % 256).astype(np.uint8)
    return ramp


def extreme(rng: random.Random, low: int, high: int) -> int:
    """A number from `low` to `high`, often one of the two."""
    return rng.choice((low, high, rng.randint(low, high), rng.randint(low, high), rng.randint(low, high)))


def seed(rng: random.Random) -> int:
    """A new seed for a texture or a pause."""
    return rng.getrandbits(24)


def config_of(case: Case) -> Config:
    """The case's configuration."""
    return CONFIGS[case.config]
