# SPDX-License-Identifier: Apache-2.0
"""When a measurement is valid: the rules, the reasons for refusal, and the checks of a search's peak.

`Measurer.measure` makes the checks that need further searches, texture and return.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Status
from signum.common.arrays import Floats
from signum.measure.batch import Peaks
from signum.measure.subpixel import PeakFit


class Reason(StrEnum):
    """Why a measurement is not valid; of several, the first in this order."""

    NONE = ""
    OUTSIDE = "outside"
    """The window, or everything it was searched for in, lies outside the picture."""
    SCORE = "score"
    """The peak is too low."""
    MARGIN = "margin"
    """Another place matches nearly as well."""
    BORDER = "border"
    """The peak lies at the border of the search: the true one may lie beyond."""
    TEXTURE = "texture"
    """The window looks like itself elsewhere: too plain, or a bare edge."""
    RETURN = "return"
    """The search from the found place back did not return to the start."""
    PARTS = "parts"
    """The window and its inner part moved differently: perspective, relief, or chance."""


REASONS = tuple(Reason)
"""Reasons by number, for arrays."""
PASSED = REASONS.index(Reason.NONE)


@dataclass(frozen=True)
class Rules:
    """What makes a measurement valid. Scores are matching fractions.

    `min_score` alone does not separate right from wrong: on real seabed, wrong peaks score far above chance; most of
    them fail the other checks. `max_likeness` bounds how well a window may match itself two pixels or more away, from 0
    (as white texture under the same filter) to 1 (identical). `max_return_px` is the largest distance between the start
    and the end of the backward search.
    """

    min_score: float = 0.62
    min_margin: float = 0.02
    max_likeness: float = 0.6
    max_return_px: float = 1.0
    backward: bool = True
    texture: bool = True
    fit: PeakFit = "auto"


@dataclass(frozen=True, eq=False)
class Answers:
    """n measurements as arrays, (n,) each, of the attributes of `Measurement` of their names.

    `reasons` has numbers in REASONS; PASSED for those that are valid.
    """

    dx: Floats
    dy: Floats
    score: Floats
    margin: Floats
    above_chance: Floats
    reasons: NDArray[np.int64]

    @property
    def moved(self) -> Floats:
        """(n, 2) displacements."""
        return np.stack([self.dx, self.dy], axis=1)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which are valid."""
        return np.asarray(self.reasons == PASSED)


def judge_peaks(peaks: Peaks, rules: Rules) -> NDArray[np.int64]:
    """For each search the number in REASONS of the first reason to refuse the peak that it found; PASSED if none."""
    checks = {Reason.OUTSIDE: peaks.status == Status.OK, Reason.SCORE: peaks.score >= rules.min_score,
              Reason.MARGIN: peaks.margin >= rules.min_margin, Reason.BORDER: peaks.inside}
    return np.select([~good for good in checks.values()], [REASONS.index(reason) for reason in checks], PASSED)
