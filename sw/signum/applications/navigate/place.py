# SPDX-License-Identifier: Apache-2.0
"""What localisation accepts, and what it returns."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from signum.geometry.similarity import Similarity
from signum.measure.validity import Rules


@dataclass(frozen=True)
class LocaliseLimits:
    """What is searched for and what is accepted.

    Attributes:
        turns_deg: rotations of the frame against the mosaic that are tried without a prior, in order.
        convinced: votes at which no further rotation is tried.
        candidates: number of candidate places that are compared closely.
        rot_deg: largest rotation beyond those tried.
        zoom: largest scale.
        miss: largest residual of an agreeing window, as a fraction of its side: a mosaic is flat, the scene is not.
        windows: least number of agreeing windows, with a prior.
        share: least share of those on the mosaic, with a prior.
        sure_windows: least number without a prior.
        sure_share: least share without a prior.
        rival: share of the best place's windows from which another place is as good as it.
        rival_score: share of its median score, above chance, from which it is, in addition.
        reach: half side of the search range around a predicted position, pixels of the board.
        rules: of the measurements.
    """

    turns_deg: tuple[float, ...] = (0.0, -9.0, 9.0)
    convinced: int = 9
    candidates: int = 4
    rot_deg: float = 12.0
    zoom: float = 1.25
    miss: float = 0.09
    windows: int = 6
    share: float = 0.2
    sure_windows: int = 8
    sure_share: float = 0.25
    rival: float = 0.6
    rival_score: float = 0.85
    reach: int = 24
    rules: Rules = field(default_factory=lambda: Rules(min_score=0.6, min_margin=0.01, max_return_px=2.0))


ANY_HEADING = (0.0, *(s * t for t in range(9, 180, 9) for s in (-1.0, 1.0)), 180.0)
"""Rotations to try for a frame of any heading, degrees."""


@dataclass(frozen=True)
class Place:
    """Where a frame is.

    Attributes:
        similarity: pixels of the original frame -> pixels of mosaic.png; None where not known.
        centre: of the frame, pixels of mosaic.png; NaN where not known.
        score: median matching fraction of the agreeing windows.
        confidence: 0 to 100; where it is 0, similarity, centre and score are not valid.
        agreed: windows that agree.
        tried: windows that lie on the mosaic and have texture.
        reason: why it is not known, one phrase.
    """

    similarity: Similarity | None = None
    centre: tuple[float, float] = (math.nan, math.nan)
    score: float = 0.0
    confidence: int = 0
    agreed: int = 0
    tried: int = 0
    reason: str = ""

    @property
    def known(self) -> bool:
        """Whether the frame was found."""
        return self.similarity is not None
