# SPDX-License-Identifier: Apache-2.0
"""Surveys without pictures: a registrar that answers with the truth and some noise, so that all that is left of a
survey's cost is its bookkeeping."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from signum.applications.mosaic.simulate import back_and_forth
from signum.common.arrays import Image
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity, overlap
from signum.measure.registration import Registration

SIZE = 400, 300
CENTRE = np.array([(SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2])
SPREAD = 60.0


@dataclass(frozen=True)
class Numbered:
    """A frame's number, which stands for its prepared picture."""

    number: int
    nbytes: int = 4


def lanes(count: int, along: int, seed: int = 0) -> list[Similarity]:
    """Pixels -> plane of a survey's frames, half a frame apart, back and forth in lanes of `along` frames."""
    rng = np.random.default_rng(seed)
    out = []
    for row, column in back_and_forth(along, -(-count // along))[:count]:
        turn = Similarity.of(rng.normal(0, 1), float(np.exp(rng.normal(0, 0.01))))
        at = complex(SIZE[0] / 2 * column, -SIZE[1] / 2 * row) + complex(*rng.normal(0, 8, 2))
        out.append(Similarity(turn.factor, at - turn.factor * complex(*CENTRE)))
    return out


def ring(side: int, step: float = 0.5) -> list[Similarity]:
    """The same of a way round a square of four times `side` frames, to its beginning and a few frames on."""
    ways = [(1, 0)] * side + [(0, 1)] * side + [(-1, 0)] * side + [(0, -1)] * side + [(1, 0)] * 4
    at = np.cumsum([(0, 0), *ways], axis=0) * step * np.array(SIZE)
    return [Similarity(1 + 0j, complex(*p)) for p in at]


class TruthRegistrar:
    """Stands for a `Registrar`: pairs that overlap are found, with errors of `noise` pixels that depend on the pair
    alone.

    Attributes:
        asked: questions so far.
    """

    def __init__(self, truth: list[Similarity], noise: float = 0.5) -> None:
        self.truth, self._noise = truth, noise
        self.fine = SimpleNamespace(source=SIZE, factor=(1.0, 1.0))
        self.limits = SimpleNamespace(reach=18)
        self.centre, self.window, self.sigma = CENTRE, 48, 2.0
        self.asked = 0

    def prepare(self, picture: Image) -> Numbered:
        return Numbered(int.from_bytes(picture.tobytes(), "big"))

    def register(self, a: Numbered, b: Numbered, guess: object = None, reach: object = None) -> Registration:
        self.asked += 1
        true = self.truth[b.number].inverse @ self.truth[a.number]
        if overlap(true, SIZE) < 0.12:
            return Registration(Similarity(), (0.0, 0.0), reason="hardly any overlap")
        off = np.random.default_rng([a.number, b.number]).normal(0, self._noise, 4)
        middle = (CENTRE + true.inverse(CENTRE)) / 2
        factor = true.factor + complex(off[0], off[1]) / SPREAD
        there = complex(*true(middle)) + complex(off[2], off[3])
        found = Similarity(factor, there - factor * complex(*middle))
        dx, dy = found(CENTRE) - CENTRE
        fields: dict[str, Any] = {"score": 0.9, "margin": 0.1, "agreed": 16, "tried": 20, "accepted": True,
                                  "turning": True, "spread_px": SPREAD, "rms_px": 1.0, "evidence": 12.0}
        return Registration(found, (float(dx), float(dy)), middle=(float(middle[0]), float(middle[1])), **fields)


def imagined(number: int) -> Frame:
    """The frame of a number."""
    return Frame(f"{number:05d}", np.frombuffer(number.to_bytes(4, "big"), np.uint8).reshape(1, 4).copy())
