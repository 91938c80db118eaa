# SPDX-License-Identifier: Apache-2.0
"""Searches for the windows of a warped reference in a live view, and judges the similarity on which most of them agree.

It is sure if chance does not explain that so many windows agree so closely (`evidence`), if they match better than they
match other places of this very reference (`rivals`), and if their spread fixes the similarity well enough.

On a wall, the reference's other places match nearly as well as the true one: the joints do, only the bricks' faint
faces do not. The windows' scores then differ more from one window to another, by how much of a joint they show, than
from place to place. So each window's score is compared with its own at the places of the same live view where the
station would be if it were one of its twins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.applications.hold.evidence import log_false_alarms
from signum.applications.hold.ground_fit import fit_ground
from signum.applications.hold.level_camera import LevelCamera, inverse, moved
from signum.applications.hold.reading import Level
from signum.applications.hold.reference import Reference
from signum.applications.hold.rivals import beats, enough, twin_reach
from signum.applications.hold.windows import Windows
from signum.common.arrays import Floats
from signum.geometry.similarity import IDENTITY, Similarity, least_squares, vote
from signum.measure.measurer import Measurement, Measurer, Query, View
from signum.measure.register import ANYTHING
from signum.measure.validity import Reason, Rules

HOLD_RULES = Rules(min_score=0.56, min_margin=0.0, max_return_px=2.0, max_likeness=0.8)
"""Of a window. They are loose: how often they let a wrong place pass is measured on the reference and reckoned with."""
TOLERANCE_PX = 4.0
"""Largest residual of a window that agrees with the common similarity, pixels; relief and viewing angle cause it."""
MOST_TURN_DEG, MOST_ZOOM = 8.0, 1.15
"""Largest rotation and scale between the predicted motion and the common similarity."""
FALSE_ALARMS = -7.0
"""Logarithm to base 10 of the number of false alarms above which a match is not sure: at ten views a second that show
nothing of the reference, chance is believed once in 12 days."""
RIVAL_DEVIATIONS = 5.0
"""Standard errors by which the agreeing windows' mean score must exceed that of other places."""
TWIN_DEVIATIONS = 3.0
"""The same for the mean of the windows' differences from each twin: fewer are enough, as at a wrong place of a view
that shows the true one this mean is negative, and all twins must be beaten."""
MAX_TURN_ERROR = 0.01
"""Standard error of the fitted rotation, radians, above which a match is not sure."""
MAX_SHIFT_ERROR = 0.008
"""Standard error of the fitted offset, as a share of the range, above which a match is not sure."""
LEAST_NOISE_PX, NOISE_WIDTH = 1.0, 640
"""Lower bound of the windows' residual in that error, pixels of a picture as wide: the residual of a few windows may be
small by chance. What relief and viewing angle leave is in proportion to the width; half a pixel it is at least."""
LEAST_FIT_PX = 0.1
"""Lower bound of the residual in the errors that a match states, pixels: what a single window is good for."""
LEAST_SHARE = 0.5
"""Least share that must agree of the windows that are found anywhere."""
LEAST_SPREAD = 0.03
"""Lower bound of the standard deviation of agreeing windows' scores."""


@dataclass(frozen=True, eq=False)
class Match:
    """Windows that were searched for in a live view, and the similarity on which most of them agree.

    Attributes:
        tried: windows that should be in view; agreed: of these, those that agree.
        similarity: level pixels of the reference -> of the view.
        score: median of the agreeing windows.
        sure: whether it is what it seems.
        due: share of the windows that should agree, by the scores of those that do.
        turn_error, shift_error: standard errors, radians and pixels.
        likely: not sure, for the only reason that windows score no more than at other places of the reference.
    """

    tried: int
    agreed: int = 0
    similarity: Similarity = IDENTITY
    score: float = 0.0
    sure: bool = False
    due: float = 1.0
    turn_error: float = 0.0
    shift_error: float = 0.0
    likely: bool = False


@dataclass(frozen=True, eq=False)
class Matcher:
    """Of views of one measurer, taken by one camera."""

    measurer: Measurer
    camera: LevelCamera

    @property
    def _least_noise(self) -> float:
        return LEAST_NOISE_PX * min(1.0, max(0.5, self.measurer.size[0] / NOISE_WIDTH))

    def match(self, reference: Reference, windows: Windows, onto: Floats, live: View, level: Level, reach: int,
              twins: bool = True) -> Match:
        """Search for windows of a warped reference where `onto` expects them in a live view.

        Args:
            onto: homography (3, 3) from the reference's pixels to the live view's.
            level: of the live view.
            reach: half side of the search range, pixels.
            twins: whether to compare with the reference's twins where windows score no more than at other places of it.
        """
        centres, side = windows.centres.astype(np.float64), windows.side
        ahead = moved(onto @ inverse(windows.onto), centres)
        answers = self.measurer.measure(
            [Query(windows.view, live, x, y, side, side, (float(d[0]), float(d[1])), (reach, reach))
             for (x, y), d in zip(windows.centres.tolist(), ahead - centres, strict=True)], HOLD_RULES)
        keep = [i for i, m in enumerate(answers) if m.valid]
        tried = int(self._visible(ahead, side).sum())
        if len(keep) < 3:
            return Match(tried)
        levelling = self.camera.levelling(level)
        found = moved(levelling, centres[keep] + [[answers[i].dx_px, answers[i].dy_px] for i in keep])
        anchors, expected = windows.anchors[keep], moved(levelling, ahead[keep])
        _, agree = vote(expected, found, TOLERANCE_PX, MOST_TURN_DEG, MOST_ZOOM, 1.5 * side)
        if agree.sum() < 3:
            return Match(tried)
        result = fit_ground(anchors, found, least_squares(anchors[agree], found[agree]), self.camera.focal,
                            TOLERANCE_PX)
        agreed = int(result.agree.sum())
        tried = max(tried, agreed)
        if agreed < 3:
            return Match(tried, agreed)
        scores = np.array([answers[i].score for i in keep])[result.agree]
        rivals, share = reference.rivals(side), windows.share
        chance = log_false_alarms(result.misses, len(answers), (2 * reach + 1) ** 2,
                                  rivals.passing(float(np.quantile(scores, 0.25))), share,
                                  3 if result.sloping(self.camera.focal) else 2)
        turn, shift = (e / math.sqrt(share) for e in result.errors(self._least_noise))
        likely = False
        sure = (chance <= FALSE_ALARMS and agreed >= LEAST_SHARE * len(keep) and turn <= MAX_TURN_ERROR
                and shift <= MAX_SHIFT_ERROR * self.camera.focal)
        if sure and not rivals.exceeded_by(scores, share, RIVAL_DEVIATIONS):
            chosen = windows.some(np.array(keep)[result.agree])
            likely = sure
            sure = twins and self._beats_twins(reference, chosen, result.similarity, live, level, scores)
        due = share_above(max(rivals.mean, HOLD_RULES.min_score), HOLD_RULES.min_score, scores)
        turn, shift = (e / math.sqrt(share) for e in result.errors(LEAST_FIT_PX))
        return Match(tried, agreed, result.similarity, float(np.median(scores)), sure, due, turn, shift,
                     likely and not sure)

    def _beats_twins(self, reference: Reference, windows: Windows, similarity: Similarity, live: View, level: Level,
                     scores: Floats) -> bool:
        """Whether windows match better where they were found than they together would if the reference were at one of
        its twins in the same view; at least one of these must be in view."""
        levelling = self.camera.levelling(level)
        expected = [similarity(windows.anchors + twin) for twin in reference.twins()]
        first = self._searched(windows, live, levelling, expected, twin_reach(windows.side))
        places, met = [], 0
        for ahead, answers in zip(expected, first, strict=True):
            seen = [i for i, m in enumerate(answers) if m.reason is not Reason.OUTSIDE]
            if not enough(len(seen), len(scores)):
                continue
            met += 1
            found = moved(levelling, windows.centres[seen] + [[answers[i].dx_px, answers[i].dy_px] for i in seen])
            _, agree = vote(ahead[seen], found, TOLERANCE_PX, MOST_TURN_DEG, MOST_ZOOM, 1.5 * windows.side)
            if agree.sum() >= 3:  # else they have no common place there
                places.append(least_squares(ahead[seen][agree], found[agree])(ahead))
        again = self._searched(windows, live, levelling, places, math.ceil(TOLERANCE_PX))
        others = np.array([[np.nan if m.reason is Reason.OUTSIDE else m.score for m in answers] for answers in again])
        return met > 0 and beats(scores, others, windows.share, TWIN_DEVIATIONS)

    def _searched(self, windows: Windows, live: View, levelling: Floats, places: list[Floats], reach: int
                  ) -> list[list[Measurement]]:
        """The windows' measurements around each of some places, level pixels (n, 2)."""
        side, back = windows.side, inverse(levelling)
        answers = iter(self.measurer.measure(
            [Query(windows.view, live, x, y, side, side, (float(d[0]), float(d[1])), (reach, reach))
             for place in places
             for (x, y), d in zip(windows.centres.tolist(), moved(back, place) - windows.centres, strict=True)],
            ANYTHING))
        return [[next(answers) for _ in windows.centres] for _ in places]

    def _visible(self, points: Floats, side: int) -> NDArray[np.bool_]:
        half = side / 2
        return np.asarray(((points >= half) & (points <= np.array(self.measurer.size) - half)).all(axis=1))


def share_above(floor: float, least: float, scores: Floats) -> float:
    """Share of all windows at a right place that score more than `floor`, by those that score enough to be found.

    Scores are taken as normal. Only those above `least` are known, so their mean is larger than that of all: where
    texture is faint, half of the windows may lie below. The mean of what is known determines that of all (the mean of a
    truncated normal distribution: Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1, 13.10). The
    deviation is that of what is known, which is less than that of all, so the share is rather too large.

    Args:
        floor: from which a score counts; `least` or more.
        least: that is found.
        scores: (n,) of windows at the place, all above `least`.
    """
    deviation = max(float(scores.std()), LEAST_SPREAD)
    mean = deviation * float(np.interp((float(scores.mean()) - least) / deviation, *_MEANS))
    return 0.5 * (1 + math.erf((least + mean - floor) / deviation / math.sqrt(2)))


def _means() -> tuple[Floats, Floats]:
    """Means of what lies above 0 of a normal distribution of deviation 1, rising, and of all of it."""
    mean = np.linspace(-4.0, 6.0, 201)
    above = np.array([0.5 * math.erfc(-m / math.sqrt(2)) for m in mean])
    return mean + np.exp(-mean**2 / 2) / math.sqrt(2 * math.pi) / above, mean


_MEANS = _means()
