# SPDX-License-Identifier: Apache-2.0
"""An edge of the pose graph, measured between two frames, and its row in `edges.csv`."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from signum.geometry.similarity import Similarity
from signum.measure.registration import UNKNOWN, Registration, Rival

SEQUENCE = "sequence"
"""Kind of an edge to the frame stored last, or one of the few before it."""
LIVE = "live"
"""Kind of an edge to the frame stored last from a frame of a stream that is placed but not stored."""
LOOP = "loop"
"""Kind of an edge proposed from the predicted overlap."""
JOIN = "join"
"""Kind of an edge between two components."""


@dataclass(frozen=True)
class Edge:
    """Where frame b shows what frame a shows; the figures of a refused edge are for the record only.

    Attributes:
        similarity: original pixels of a -> of b.
        centre: of the frames, original pixels; `shift` of the table is measured there.
        middle, spread_px, rms_px, score, margin, agreed, tried, accepted, reason, evidence: see `Registration`.
        shear: see `Registration`; shear_error, rivals, sloping: the same.
        spread_px: 0 where rotation and scale were not measured.
    """

    frame_a: str
    frame_b: str
    kind: str
    similarity: Similarity
    centre: tuple[float, float]
    score: float = 0.0
    margin: float = 0.0
    accepted: bool = True
    middle: tuple[float, float] = (0.0, 0.0)
    spread_px: float = 0.0
    rms_px: float = 0.0
    agreed: int = 0
    tried: int = 0
    reason: str = ""
    evidence: float = 0.0
    shear: tuple[float, float] = (0.0, 0.0)
    shear_error: float = UNKNOWN
    rivals: tuple[Rival, ...] = ()
    sloping: bool = False

    @classmethod
    def of(cls, a: str, b: str, kind: str, centre: tuple[float, float], r: Registration, reason: str = "") -> Edge:
        """From a registration of frame `a` in frame `b`; a `reason` refuses what the registrar accepted."""
        return cls(a, b, kind, r.similarity, centre, r.score, r.margin, r.accepted and not reason, r.middle,
                   r.spread_px if r.turning else 0.0, r.rms_px, r.agreed, r.tried, reason or r.reason, r.evidence,
                   r.shear, r.shear_error if r.turning else UNKNOWN, r.rivals, r.sloping)

    @property
    def sheared(self) -> bool:
        """Whether the shear was measured."""
        return self.shear_error < UNKNOWN

    def switched(self, number: int) -> Edge:
        """The edge by the rival of this number, from 1, which has this edge's motion as its own rival; itself for 0."""
        if number == 0:
            return self
        r = self.rivals[number - 1]
        own = Rival(self.similarity, self.score, self.margin, self.agreed, self.spread_px > 0, self.middle,
                    self.spread_px, self.rms_px, self.evidence)
        others = (own, *(other for other in self.rivals if other is not r))
        return replace(self, similarity=r.similarity, score=r.score, margin=r.margin, agreed=r.agreed, middle=r.middle,
                       spread_px=r.spread_px if r.turning else 0.0, rms_px=r.rms_px, evidence=r.evidence,
                       shear=(0.0, 0.0), shear_error=UNKNOWN, rivals=others, sloping=False)

    @property
    def shift(self) -> tuple[float, float]:
        """Where a's centre lands in b, minus b's centre, pixels."""
        dx, dy = self.similarity(np.array(self.centre)) - np.array(self.centre)
        return float(dx), float(dy)

    @property
    def row(self) -> list[object]:
        """The row of the table."""
        return [self.frame_a, self.frame_b, *map(_whole, (*self.shift, self.score, self.margin)), int(self.accepted),
                self.kind, *map(_whole, (self.similarity.rot_deg, self.similarity.scale, *self.middle, self.spread_px,
                                         self.rms_px)), self.agreed, self.tried, self.reason]


def _whole(value: float) -> str:
    """A number with all its bits."""
    return repr(float(value))
