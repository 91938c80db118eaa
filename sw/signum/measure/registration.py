# SPDX-License-Identifier: Apache-2.0
"""What a registration of two pictures gives, and what is accepted as one."""

from __future__ import annotations

from dataclasses import dataclass, field

from signum.common.arrays import Image
from signum.geometry.similarity import Similarity
from signum.measure.validity import Rules

UNKNOWN = 1e9
"""Standard error of a shear that was not measured."""


@dataclass(frozen=True)
class RegistrationLimits:
    """What is searched for and what is accepted.

    Attributes:
        rot_deg: largest rotation between two pictures.
        zoom: largest scale between them.
        turns_deg: rotations of picture a tried in the coarse step, until `convinced` windows agree.
        convinced: number of agreeing coarse windows that ends the coarse step.
        straight_deg: up to this rotation, a is not warped for the next search.
        straight_zoom: up to this change of scale, the same.
        coarse_miss: largest distance of an agreeing window from its place by the similarity, pixels of the coarse
            picture.
        rival_votes: number of coarse windows from which another place is tried too; if both match, neither is accepted.
        rival_share: share of the winning number from which it is tried.
        fine_miss: half the distance, as a fraction of the fine windows' side, at which two places are different ones.
        windows: least number of agreeing fine windows.
        evidence: least evidence for a similarity, decades; see `likelihood`. One link in a thousand may be chance.
        sure: evidence from which no smaller windows are asked as witnesses.
        reach: search range around a place predicted from the coarse step, pixels of the board.
        rules: of the fine measurements.
    """

    rot_deg: float = 15.0
    zoom: float = 1.2
    turns_deg: tuple[float, ...] = (0.0, -8.0, 8.0)
    convinced: int = 12
    straight_deg: float = 2.5
    straight_zoom: float = 0.05
    coarse_miss: float = 3.2
    rival_votes: int = 5
    rival_share: float = 0.4
    fine_miss: float = 0.08
    windows: int = 4
    evidence: float = 3.0
    sure: float = 6.0
    reach: int = 18
    rules: Rules = field(default_factory=lambda: Rules(min_score=0.6, min_margin=0.01, max_return_px=2.0))


@dataclass(frozen=True)
class Rival:
    """Another motion between two pictures; the attributes are those of `Registration`."""

    similarity: Similarity
    score: float
    margin: float
    agreed: int
    turning: bool
    middle: tuple[float, float]
    spread_px: float
    rms_px: float
    evidence: float


@dataclass(frozen=True)
class Registration:
    """The similarity between two pictures a and b.

    Attributes:
        similarity: pixels of a's original picture -> pixels of b's.
        shift: where a's centre lands in b, minus b's centre, original pixels.
        score: median matching fraction of the agreeing windows, 0 where there are none.
        margin: their median margin.
        agreed: number of fine windows that agree.
        tried: number of all in the predicted overlap.
        accepted: whether to use it.
        reason: why not, one phrase.
        turning: whether rotation and scale were measured, not only the translation.
        middle: centroid of the agreeing windows, original pixels of a; the picture's centre where there are none.
        spread_px: their root-mean-square distance from it, original pixels.
        rms_px: of their distances from their places by the similarity, original pixels.
        evidence: that they agree for another reason than chance, decades, low peaks doubted and, where it was in doubt,
            with that of smaller windows; below 0 if chance explains them better.
        rivals: other motions that enough windows agree on, the best first.
        shear: real and imaginary part of the shear beside the similarity; see `refine`.
        shear_error: standard error of each, `UNKNOWN` where they were not measured.
        sloping: whether the slope of the floor was taken out of the similarity; see `surface`.
    """

    similarity: Similarity
    shift: tuple[float, float]
    score: float = 0.0
    margin: float = 0.0
    agreed: int = 0
    tried: int = 0
    accepted: bool = False
    reason: str = ""
    turning: bool = False
    middle: tuple[float, float] = (0.0, 0.0)
    spread_px: float = 0.0
    rms_px: float = 0.0
    evidence: float = 0.0
    rivals: tuple[Rival, ...] = ()
    shear: tuple[float, float] = (0.0, 0.0)
    shear_error: float = UNKNOWN
    sloping: bool = False


@dataclass(frozen=True)
class Prepared:
    """A picture at the resolutions of both steps: grey uint8."""

    coarse: Image
    fine: Image

    @property
    def nbytes(self) -> int:
        """Its size in memory, bytes."""
        return self.coarse.nbytes + self.fine.nbytes
