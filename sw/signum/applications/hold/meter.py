# SPDX-License-Identifier: Apache-2.0
"""The vehicle's offset from a reference view: the paper's equations 2 to 7 by least squares over many features.

A camera looking down sees ground point G (metres, right + i back, in the reference's frame) at reference pixel p =
f/Z0 G and at live pixel q = f/Z exp(-i yaw) (G - T), pixels from the image centre, after both have been levelled by
the vehicle's roll and pitch. So the similarity q = F p + t that most windows agree on gives

    zoom = |F| = Z0 / Z,   yaw = -arg F,   T = -t (Z / f) exp(i yaw).

With two features, small angles and Z = Z0 = R these are equations 4 to 7. The reference's picture never changes, so the
offset does not drift. It is warped by the predicted motion (`reference`), and every window of what is in sight of it is
searched for near its predicted place; a lost one is searched for in the whole view (`search`).

Windows are small where the floor's texture shows in them, as they then follow relief and fit into a narrow overlap. Of
a plain floor in murky water, a small window holds a few grey levels of noise and, maybe, a straight edge. Where too few
small windows agree, or those that do leave the rotation uncertain, windows of four times the area are searched for in
the same view. `matching` says when a reading is valid.
"""

from __future__ import annotations

import cmath
from dataclasses import replace

import numpy as np

from signum.applications.hold.level_camera import LevelCamera, inverse, moved
from signum.applications.hold.matching import HOLD_RULES, Match, Matcher
from signum.applications.hold.reading import UPRIGHT, Level, Reading
from signum.applications.hold.reference import Reference
from signum.applications.hold.search import WholeView
from signum.applications.hold.snow import without_snow
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.measurer import Measurer, View

WHOLE_SHARE = 0.8
"""Where the whole view was searched, least share that must agree of the windows that should, by the scores of those
that do: where a part of the floor recurs elsewhere, its windows match there as well as ever, and the others not at all.
"""
LARGER, LEAST_LARGER = 2, 1.5
"""Side of the larger windows over that of the small ones, and the least worth having, where board or picture allow no
more."""
TURN_ERROR = 0.001
"""Standard error of the rotation, radians, above which larger windows are searched for after the small ones."""
EXACT = 0.0025
"""Largest standard error, radians or a share of the range, of a match that only the comparison of small windows with
the reference's twins bears out: at a wrong place nearby, one joint off, say, some of the windows still match."""
QUICK, QUICK_SHARE, QUICK_TURN = 24, 0.9, 0.0005
"""Number of windows that are searched for first; if no less than this share of them agree, and the rotation's standard
error is below this, radians, the others are left out."""
SEEK_PX = 18
"""Half side of the search range around a place that the search of the whole view proposes, pixels."""
LOOKS = 2
"""Number of proposals that are looked at in a frame."""


class StationMeter:
    """Measures the offset of live frames from a reference frame.

    Args:
        measurer: at the frames' size. Two of its slots are used, the live view's included, one more for a moment where
            larger windows are first needed, two more while the reference is lost.
        focal: pixels.
        range_m: range of the seafloor in the reference frame, metres, from stereo or assumed; offsets are
            proportional to it.
        window: side of the feature windows, pixels; windows twice as large are searched for where these find too
            little texture.
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
        large = min(LARGER * window, measurer.window_range[1], min(measurer.size) // 3)
        self._sides = (window, large) if large >= LEAST_LARGER * window else (window,)
        self._matcher = Matcher(measurer, self.camera)
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
        return self.measurer.view(without_snow(picture))

    def anchor(self, view: View, level: Level = UPRIGHT) -> int:
        """Make a view the station's reference and keep it; returns its number of features.

        Any part of the image can be a feature; of a grid of candidates, those least similar to their own surroundings
        are kept.
        """
        self.release()
        self.changes += 1
        self._reference = Reference(self.measurer, self.camera, view, level, self._sides, self.features, HOLD_RULES)
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
        some = reference.turn_to(onto, self.window).first(QUICK)
        match = self._matcher.match(reference, some, onto, live, level, self.reach + wide)
        if not match.sure or match.agreed < QUICK_SHARE * match.tried or match.turn_error > QUICK_TURN:
            match = self._matched(reference, onto, live, level, self.reach + wide,
                                  self._sides if wide <= self.reach else self._sides[:1])
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
        match = Match(0)
        found: list[Match] = []
        for candidate in self._whole.look(live.picture)[:LOOKS]:
            about = Similarity(1, centre) @ candidate.similarity @ Similarity(1, -centre)
            onto = np.vstack([about.matrix, [0, 0, 1]])
            reference.warp(onto)
            match = self._matched(reference, onto, live, level, SEEK_PX, self._sides, WHOLE_SHARE)
            if match.sure:
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
        return self._tilted(self._last(self._reference.windows(self.window).anchors), level)

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

    def _matched(self, reference: Reference, onto: Floats, live: View, level: Level, reach: int,
                 sides: tuple[int, ...], share: float = 0.0) -> Match:
        """Search for windows where `onto` expects them in a live view, and again with what they agree on, where few do;
        for larger ones where the smaller are not sure, fewer of them agree than `share` of those due, or leave the
        rotation uncertain. After a search of the whole view, smaller ones are compared with the reference's twins, too,
        if nothing else is sure: they are less exact there than larger ones, but a narrow overlap holds few of those."""
        best, likely = Match(0), Match(0)
        for side in sides:
            twins = side == self._sides[-1]
            match = self._matcher.match(reference, reference.turn_to(onto, side), onto, live, level, reach, twins)
            if not match.sure and match.agreed >= 3:
                near = self.camera.onto(match.similarity, reference.level, level)
                turned = reference.turn_to(near, side)
                again = self._matcher.match(reference, turned, near, live, level, self.reach, twins)
                match = again if again.sure or again.agreed > match.agreed else match
            match = match if match.agreed >= share * match.due * match.tried else replace(match, sure=False)
            likely = match if match.likely and not twins else likely
            if not best.sure or (match.sure and match.turn_error < best.turn_error):
                best = match
            if best.sure and best.turn_error <= TURN_ERROR:
                break
        if share and likely.likely and not best.sure:
            near = self.camera.onto(likely.similarity, reference.level, level)
            match = self._matcher.match(reference, reference.turn_to(near, sides[0]), near, live, level, self.reach)
            exact = max(match.turn_error, match.shift_error / self.focal) <= EXACT
            best = match if match.sure and exact and match.agreed >= share * match.due * match.tried else best
        return best

    def _apart(self, one: Match, other: Match) -> bool:
        """Whether two matches are of different places."""
        far = np.abs(one.similarity(np.zeros((1, 2))) - other.similarity(np.zeros((1, 2)))).max()
        return bool(far > self.window / 2 or abs(one.similarity.factor - other.similarity.factor) > 0.1)

    def _found(self, match: Match) -> Reading:
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
