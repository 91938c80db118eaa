# SPDX-License-Identifier: Apache-2.0
"""The vehicle's offset from a reference view: the paper's equations 2 to 7 by least squares over many features.

A camera looking down sees ground point G (metres, right + i back, in the reference's frame) at reference pixel p =
f/Z0 G and at live pixel q = f/Z exp(-i yaw) (G - T), pixels from the image centre, after both have been levelled by
the vehicle's roll and pitch. So the similarity q = F p + t that most windows agree on gives

    zoom = |F| = Z0 / Z,   yaw = -arg F,   T = -t (Z / f) exp(i yaw).

With two features, small angles and Z = Z0 = R these are equations 4 to 7. The reference's picture never changes, so the
offset does not drift. It is warped by the predicted motion (`reference`), and every window of what is in sight of it is
searched for near its predicted place; a lost one is searched for in the whole view (`search`).

A reading is valid if chance does not explain that so many windows agree so closely (`evidence`), if they match better
than they match other places of this very reference, and if their spread fixes the similarity well enough.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import cv2
import numpy as np

from signum.applications.hold.evidence import log_false_alarms
from signum.applications.hold.ground_fit import fit_ground
from signum.applications.hold.level_camera import LevelCamera, inverse, moved
from signum.applications.hold.reading import UPRIGHT, Level, Reading
from signum.applications.hold.reference import Reference, Warped
from signum.applications.hold.search import WholeView
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import IDENTITY, Similarity, least_squares, vote
from signum.measure.measurer import Measurer, Query, View
from signum.measure.validity import Rules

HOLD_RULES = Rules(min_score=0.56, min_margin=0.0, max_return_px=2.0, max_likeness=0.8)
"""Of a window. They are loose: how often they let a wrong place pass is measured on the reference and reckoned with."""
FLAKE = 5
"""Side of the median filter that takes marine snow out of a picture, pixels."""
TOLERANCE_PX = 4.0
"""Largest residual of a window that agrees with the common similarity, pixels; relief and viewing angle cause it."""
MOST_TURN_DEG, MOST_ZOOM = 8.0, 1.15
"""Largest rotation and scale between the predicted motion and the common similarity."""
FALSE_ALARMS = -7.0
"""Logarithm to base 10 of the number of false alarms above which a reading is refused: at ten views a second that show
nothing of the reference, chance is believed once in 12 days."""
RIVAL_DEVIATIONS = 5.0
"""Standard errors by which the agreeing windows' mean score must exceed that of other places."""
MAX_TURN_ERROR = 0.01
"""Standard error of the fitted rotation, radians, above which a reading has no confidence."""
MAX_SHIFT_ERROR = 0.008
"""Standard error of the fitted offset, as a share of the range, above which a reading has no confidence."""
LEAST_NOISE_PX = 1.0
"""Lower bound of the windows' residual in that error, pixels: the residual of a few windows may be small by chance."""
LEAST_FIT_PX = 0.1
"""Lower bound of the residual in the errors that a reading states, pixels: what a single window is good for."""
LEAST_SHARE = 0.5
"""Least share that must agree of the windows that are found anywhere."""
WHOLE_SHARE = 0.8
"""Where the whole view was searched, least share that must agree of the windows that should, by the scores of those
that do: where a part of the floor recurs elsewhere, its windows match there as well as ever, and the others not at all.
"""
LEAST_SPREAD = 0.03
"""Lower bound of the standard deviation of agreeing windows' scores."""
QUICK, QUICK_SHARE, QUICK_TURN = 24, 0.9, 0.0005
"""Number of windows that are searched for first; if no less than this share of them agree, and the rotation's standard
error is below this, radians, the others are left out."""
SEEK_PX = 18
"""Half side of the search range around a place that the search of the whole view proposes, pixels."""
LOOKS = 2
"""Number of proposals that are looked at in a frame."""


@dataclass(frozen=True, eq=False)
class _Match:
    """Windows that were searched for in a live view, and the similarity on which most of them agree: level pixels of
    the reference -> of the view."""

    tried: int
    agreed: int = 0
    similarity: Similarity = IDENTITY
    score: float = 0.0
    sure: bool = False
    due: float = 1.0
    turn_error: float = 0.0
    shift_error: float = 0.0


class StationMeter:
    """Measures the offset of live frames from a reference frame.

    Args:
        measurer: at the frames' size. Two of its slots are used, the live view's included, two more while the reference
            is lost.
        focal: pixels.
        range_m: range of the seafloor in the reference frame, metres, from stereo or assumed; offsets are
            proportional to it.
        window: side of the feature windows, pixels.
        features: largest number of features.
        reach: half side of the search range around a predicted position, pixels.

    Attributes:
        changes: of the reference view or its range since the first view.
    """

    def __init__(self, measurer: Measurer, focal: float, range_m: float, window: int = 64, features: int = 48,
                 reach: int = 14) -> None:
        self.measurer, self.focal, self.range_m = measurer, focal, range_m
        self.window, self.features, self.reach = window, features, reach
        self.least = 4
        self.changes = -1
        self.camera = LevelCamera(measurer.size, focal)
        self._reference: Reference | None = None
        self._whole: WholeView | None = None
        self._last: Similarity = IDENTITY
        self._drift = 0j

    @property
    def centre(self) -> Floats:
        """Of the picture, pixels (2,)."""
        return self.camera.centre

    @property
    def offered(self) -> int:
        """Number of features in the reference."""
        return self._reference.offered if self._reference is not None else 0

    def release(self) -> None:
        """Release the reference view."""
        self._stop_search()
        if self._reference is not None:
            self._reference.release()
            self._reference = None

    def view(self, picture: Image) -> View:
        """Take a picture, without its marine snow, for the other calls; the caller releases what is not kept.

        Args:
            picture: uint8 (height, width) of the measurer's size.
        """
        return self.measurer.view(np.asarray(cv2.medianBlur(picture, FLAKE), np.uint8))

    def anchor(self, view: View, level: Level = UPRIGHT) -> int:
        """Make a view the station's reference and keep it; returns its number of features.

        Any part of the image can be a feature; of a grid of candidates, those least similar to their own surroundings
        are kept.
        """
        self.release()
        self.changes += 1
        self._reference = Reference(self.measurer, self.camera, view, level, self.window, self.features, HOLD_RULES)
        self._last, self._drift = IDENTITY, 0j
        return self.offered

    def expect(self, offset: Reading) -> None:
        """Set the offset at which the next search is centred."""
        zoom = self.range_m / offset.range_m
        moved = complex(offset.right, -offset.forward)
        turn = cmath.exp(-1j * offset.heading)
        self._last = Similarity(zoom * turn, -moved * (self.focal / offset.range_m) * turn)
        self._drift = 0j

    def turn(self, heading: float) -> None:
        """Expect the vehicle to have turned on the spot since the last reading, radians, clockwise seen from above."""
        back = cmath.exp(-1j * heading)
        self._last = Similarity(self._last.factor * back, self._last.shift * back)

    def rescale(self, ratio: float) -> None:
        """Take all ranges to be `ratio` times as large; offsets in metres change with them."""
        self.range_m *= ratio
        self.changes += 1

    def read(self, live: View, level: Level = UPRIGHT, wide: int = 0) -> Reading:
        """Measure a live view near the predicted offset.

        Args:
            live: of this meter.
            level: roll and pitch at the moment of the view.
            wide: pixels added to the search range, after readings have failed.

        Returns:
            A reading; confidence 0 where it is not certain.
        """
        reference = self._anchored()
        predicted = Similarity(self._last.factor, self._last.shift + self._drift)
        onto = self.camera.onto(predicted, reference.level, level)
        warped = reference.turn_to(onto)
        match = self._match(reference, warped.first(QUICK), onto, live, level, self.reach + wide)
        if not match.sure or match.agreed < QUICK_SHARE * match.tried or match.turn_error > QUICK_TURN:
            match = self._matched(reference, warped, onto, live, level, self.reach + wide)
        if not match.sure:
            self._drift = 0j
            return Reading(agreed=match.agreed, tried=match.tried)
        step = match.similarity.shift - self._last.shift
        self._drift = step if abs(step) < 2 * self.reach else 0j
        return self._found(match)

    def seek(self, live: View, level: Level = UPRIGHT) -> Reading:
        """Measure a live view in which the reference may be anywhere, turned and scaled.

        A call tries some rotations and scales, the next one others. Otherwise as `read`; four slots are in use.
        """
        reference = self._anchored()
        if self._whole is None:
            self._whole = WholeView(self.measurer, reference.picture, self._last.factor)
        centre = complex(*self.centre)
        match = _Match(0)
        found: list[_Match] = []
        for candidate in self._whole.look(live.picture)[:LOOKS]:
            about = Similarity(1, centre) @ candidate.similarity @ Similarity(1, -centre)
            onto = np.vstack([about.matrix, [0, 0, 1]])
            match = self._matched(reference, reference.warp(onto), onto, live, level, SEEK_PX)
            if match.sure and match.agreed >= WHOLE_SHARE * match.due * match.tried:
                found.append(match)
        if not found or any(self._apart(found[0], other) for other in found[1:]):
            return Reading(agreed=match.agreed, tried=match.tried)
        self._drift = 0j
        return self._found(found[0])

    def in_sight(self) -> float:
        """Share of the reference that is in view by the last reading or `expect`, 0 to 1, as if both were level."""
        width, height = self.measurer.size
        at = np.stack(np.meshgrid(*(np.linspace(-0.5, 0.5, 9) * n for n in (width, height))), axis=-1).reshape(-1, 2)
        seen = self._last(at)
        return float((np.abs(seen) <= np.array([width, height]) / 2).all(axis=1).mean())

    def features_at(self, level: Level = UPRIGHT) -> Floats:
        """Positions of the features by the last reading or `expect`: pixels (n, 2) of the frame."""
        if self._reference is None:
            return np.zeros((0, 2))
        return self._tilted(self._last(self._reference.warped.anchors), level)

    def middle_at(self, level: Level = UPRIGHT) -> Floats:
        """Position of the ground point below the station, in the same form: pixel (2,) of the frame."""
        return np.asarray(self._tilted(self._last(np.zeros((1, 2))), level)[0])

    def _anchored(self) -> Reference:
        if self._reference is None:
            raise RuntimeError("no reference view: call anchor first")
        return self._reference

    def _stop_search(self) -> None:
        if self._whole is not None:
            self._whole.release()
            self._whole = None

    def _matched(self, reference: Reference, warped: Warped, onto: Floats, live: View, level: Level, reach: int
                 ) -> _Match:
        """Search for the windows of a warped reference where `onto` expects them in a live view, and again with what
        they agree on, where few do."""
        match = self._match(reference, warped, onto, live, level, reach)
        if not match.sure and match.agreed >= 3:
            onto = self.camera.onto(match.similarity, reference.level, level)
            again = self._match(reference, reference.turn_to(onto), onto, live, level, self.reach)
            match = again if again.sure or again.agreed > match.agreed else match
        return match

    def _match(self, reference: Reference, warped: Warped, onto: Floats, live: View, level: Level, reach: int
               ) -> _Match:
        centres, window = warped.centres.astype(np.float64), self.window
        ahead = moved(onto @ inverse(warped.onto), centres)
        answers = self.measurer.measure(
            [Query(warped.view, live, x, y, window, window, (float(d[0]), float(d[1])), (reach, reach))
             for (x, y), d in zip(warped.centres.tolist(), ahead - centres, strict=True)], HOLD_RULES)
        keep = [i for i, m in enumerate(answers) if m.valid]
        tried = int(self._visible(ahead).sum())
        if len(keep) < 3:
            return _Match(tried)
        levelling = self.camera.levelling(level)
        found = moved(levelling, centres[keep] + [[answers[i].dx_px, answers[i].dy_px] for i in keep])
        anchors, expected = warped.anchors[keep], moved(levelling, ahead[keep])
        _, agree = vote(expected, found, TOLERANCE_PX, MOST_TURN_DEG, MOST_ZOOM, 1.5 * window)
        if agree.sum() < 3:
            return _Match(tried)
        result = fit_ground(anchors, found, least_squares(anchors[agree], found[agree]), self.focal, TOLERANCE_PX)
        agreed = int(result.agree.sum())
        tried = max(tried, agreed)
        if agreed < 3:
            return _Match(tried, agreed)
        scores = np.array([answers[i].score for i in keep])[result.agree]
        chance = log_false_alarms(result.misses, len(answers), (2 * reach + 1) ** 2,
                                  reference.rivals.passing(float(np.quantile(scores, 0.25))), warped.share,
                                  3 if result.sloping(self.focal) else 2)
        turn, shift = result.errors(LEAST_NOISE_PX)
        sure = (chance <= FALSE_ALARMS and agreed >= LEAST_SHARE * len(keep) and turn <= MAX_TURN_ERROR
                and shift <= MAX_SHIFT_ERROR * self.focal and reference.rivals.exceeded_by(scores, RIVAL_DEVIATIONS))
        due = _above(max(reference.rivals.mean, HOLD_RULES.min_score), scores)
        return _Match(tried, agreed, result.similarity, float(np.median(scores)), sure, due,
                      *result.errors(LEAST_FIT_PX))

    def _apart(self, one: _Match, other: _Match) -> bool:
        """Whether two matches are of different places."""
        far = np.abs(one.similarity(np.zeros((1, 2))) - other.similarity(np.zeros((1, 2)))).max()
        return bool(far > self.window / 2 or abs(one.similarity.factor - other.similarity.factor) > 0.1)

    def _found(self, match: _Match) -> Reading:
        """Equations 4 to 7 without the small-angle approximation."""
        self._stop_search()
        self._last = similarity = match.similarity
        zoom, heading = similarity.scale, -cmath.phase(similarity.factor)
        range_m = self.range_m / zoom
        shift = -similarity.shift * (range_m / self.focal) * cmath.exp(1j * heading)
        share = match.agreed / match.tried
        confidence = round(100 * min(1.0, share * min(1.0, (match.score - 0.5) / 0.25)))
        return Reading(-shift.imag, shift.real, heading, zoom, range_m, max(confidence, 1), match.agreed, match.tried,
                       match.shift_error * range_m / self.focal, match.turn_error, match.turn_error * range_m,
                       self.changes)

    def _tilted(self, points: Floats, level: Level) -> Floats:
        """Pixels of the frame, of level pixels."""
        return moved(inverse(self.camera.levelling(level)), points)

    def _visible(self, points: Floats) -> Floats:
        half = self.window / 2
        return np.asarray(((points >= half) & (points <= np.array(self.measurer.size) - half)).all(axis=1))


def _above(floor: float, scores: Floats) -> float:
    """Share of a normal distribution with the mean and deviation of scores (n,) that lies above `floor`."""
    deviations = (float(scores.mean()) - floor) / max(float(scores.std()), LEAST_SPREAD)
    return 0.5 * (1 + math.erf(deviations / math.sqrt(2)))
