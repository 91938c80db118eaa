# SPDX-License-Identifier: Apache-2.0
"""The vehicle's offset from a reference view: the paper's equations 2 to 7 by least squares over many features.

A camera looking down sees ground point G (metres, right + i back, in the reference's frame) at reference pixel p =
f/Z0 G and at live pixel q = f/Z exp(-i yaw) (G - T), pixels from the image centre, after both have been levelled by
the vehicle's roll and pitch. So the similarity q = F p + t that most windows agree on gives

    zoom = |F| = Z0 / Z,   yaw = -arg F,   T = -t (Z / f) exp(i yaw).

With two features, small angles and Z = Z0 = R these are equations 4 to 7. Every window of the reference view is
searched for in the live view; the reference never changes, so the offset does not drift.
"""

from __future__ import annotations

import cmath

import numpy as np
from numpy.typing import NDArray

from signum.applications.hold.fit_error import FitError
from signum.applications.hold.reading import UPRIGHT, Level, Reading
from signum.common.arrays import Floats
from signum.geometry.similarity import IDENTITY, Similarity, fit, vote
from signum.measure.measurer import Measurer, Query, View
from signum.measure.validity import Rules

HOLD_RULES = Rules(min_score=0.6, min_margin=0.02, max_return_px=1.5)
TOLERANCE_PX = 4.0
"""Largest residual of a window that agrees with the common similarity, pixels; relief and viewing angle cause it."""
MAX_TURN_ERROR = 0.01
"""Standard error of the fitted rotation, radians, above which a reading has no confidence."""
LEAST_NOISE_PX = 1.0
"""Lower bound of the windows' residual in that error, pixels: the residual of a few windows may be small by chance."""
LEAST_FIT_PX = 0.1
"""Lower bound of the residual in the errors that a reading states, pixels: what a single window is good for."""


class StationMeter:
    """Measures the offset of live frames from a reference frame.

    Args:
        measurer: at the frames' size.
        focal: pixels.
        range_m: range of the seafloor in the reference frame, metres, from stereo or assumed; offsets are
            proportional to it.
        window: side of the feature windows, pixels.
        features: largest number of features.
        reach: half side of the search range around a predicted position, pixels.

    Attributes:
        changes: of the reference view or its range since the first view.
    """

    def __init__(self, measurer: Measurer, focal: float, range_m: float, window: int = 64, features: int = 12,
                 reach: int = 14) -> None:
        self.measurer, self.focal, self.range_m = measurer, focal, range_m
        self.window, self.features, self.reach = window, features, reach
        self.least = max(3, features // 3)
        self.changes = -1
        self._reference: View | None = None
        self._centres: list[tuple[int, int]] = []
        self._anchors: Floats = np.zeros((0, 2))
        self._last: Similarity = IDENTITY
        self._drift = 0j
        self.centre = (np.array(measurer.size, np.float64) - 1) / 2

    @property
    def offered(self) -> int:
        """Number of features in the reference."""
        return len(self._centres)

    def release(self) -> None:
        """Release the reference view."""
        if self._reference is not None:
            self.measurer.release(self._reference)
            self._reference = None

    def anchor(self, view: View, level: Level = UPRIGHT) -> int:
        """Make a view the station's reference and keep it; returns its number of features.

        Any part of the image can be a feature; of a grid of candidates, those least similar to their own surroundings
        are kept.
        """
        self.release()
        self.changes += 1
        self._reference = view
        width, height = self.measurer.size
        half = self.window // 2
        across, down = (np.unique(np.linspace(half + n // 12, n - half - n // 12, 5).astype(int))
                        for n in (width, height))
        candidates = [(int(x), int(y)) for y in down for x in across]
        likeness = self.measurer.likeness(self._reference, [(x, y, self.window, self.window) for x, y in candidates])
        order = [i for i in np.argsort(likeness) if likeness[i] <= HOLD_RULES.max_likeness]
        self._centres = [candidates[i] for i in _spread(order, candidates, self.features)]
        self._anchors = self._levelled(np.array(self._centres, np.float64).reshape(-1, 2), level)
        self._last, self._drift = IDENTITY, 0j
        return len(self._centres)

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
        """Measure a live view.

        Args:
            live: of the same measurer.
            level: roll and pitch at the moment of the view.
            wide: pixels added to the search range, after readings have failed.

        Returns:
            A reading; confidence 0 where too few features agree.
        """
        if self._reference is None:
            raise RuntimeError("no reference view: call anchor first")
        predicted = Similarity(self._last.factor, self._last.shift + self._drift)
        at = np.array(self._centres, np.float64).reshape(-1, 2)
        ahead = self._tilted(predicted(self._anchors), level)
        reach = self.reach + wide
        answers = self.measurer.measure(
            [Query(self._reference, live, x, y, self.window, self.window, (float(q[0] - x), float(q[1] - y)),
                   (reach, reach))
             for (x, y), q in zip(self._centres, ahead, strict=True)], HOLD_RULES)
        keep = [i for i, m in enumerate(answers) if m.valid]
        visible = int(self._visible(ahead).sum())
        if len(keep) < self.least:
            self._drift = 0j
            return Reading(tried=visible)
        found = self._levelled(at[keep] + [[answers[i].dx_px, answers[i].dy_px] for i in keep], level)
        anchors = self._anchors[keep]
        start, _ = vote(anchors, found, TOLERANCE_PX, 45.0, 1.6, 1.5 * self.window)
        result = fit(anchors, found, start, TOLERANCE_PX)
        agreed = int(result.agree.sum())
        agreeing, seen = anchors[result.agree], found[result.agree]
        if (agreed < self.least or 2 * agreed < len(keep) or not result.turning
                or FitError.of(agreeing, seen, result.similarity, LEAST_NOISE_PX).turn > MAX_TURN_ERROR):
            self._drift = 0j
            return Reading(agreed=agreed, tried=visible)
        similarity = result.similarity
        step = similarity.shift - self._last.shift
        self._drift = step if abs(step) < self.reach else 0j
        self._last = similarity
        score = float(np.median([answers[i].score for i, good in zip(keep, result.agree, strict=True) if good]))
        return self._reading(similarity, agreed, max(visible, agreed), score,
                             FitError.of(agreeing, seen, similarity, LEAST_FIT_PX))

    def features_at(self, level: Level = UPRIGHT) -> Floats:
        """Positions of the features by the last reading or `expect`: pixels (n, 2) of the frame."""
        return self._tilted(self._last(self._anchors), level)

    def middle_at(self, level: Level = UPRIGHT) -> Floats:
        """Position of the ground point below the station, in the same form: pixel (2,) of the frame."""
        return np.asarray(self._tilted(self._last(np.zeros((1, 2))), level)[0])

    def _reading(self, similarity: Similarity, agreed: int, tried: int, score: float, error: FitError) -> Reading:
        """Equations 4 to 7 without the small-angle approximation."""
        zoom, heading = similarity.scale, -cmath.phase(similarity.factor)
        range_m = self.range_m / zoom
        moved = -similarity.shift * (range_m / self.focal) * cmath.exp(1j * heading)
        share = agreed / tried
        confidence = round(100 * min(1.0, share * min(1.0, (score - 0.5) / 0.25)))
        return Reading(-moved.imag, moved.real, heading, zoom, range_m, max(confidence, 1), agreed, tried,
                       error.shift_px * range_m / self.focal, error.turn, error.turn * range_m, self.changes)

    def _levelled(self, points: Floats, level: Level) -> Floats:
        """Pixels from the image centre in a level camera of what this camera sees at `points`."""
        return self._turned(points - self.centre, level.turn)

    def _tilted(self, points: Floats, level: Level) -> Floats:
        """The inverse of `_levelled`: pixels of the frame."""
        return self._turned(points, level.turn.T) + self.centre

    def _turned(self, points: Floats, turn: Floats) -> Floats:
        rays = np.hstack([points / self.focal, np.ones((len(points), 1))])
        seen = rays @ turn.T
        return np.asarray(seen[:, :2] / seen[:, 2:] * self.focal)

    def _visible(self, points: Floats) -> NDArray[np.bool_]:
        half = self.window / 2
        return np.asarray(((points >= half) & (points <= np.array(self.measurer.size) - half)).all(axis=1))


def _spread(order: list[int], places: list[tuple[int, int]], count: int) -> list[int]:
    """The first of `order`, then repeatedly the candidate of the better three quarters farthest from those chosen."""
    pool = list(order[:max(count, (len(order) * 3) // 4)])
    chosen: list[int] = pool[:1]
    while pool and len(chosen) < min(count, len(pool)):
        rest = [i for i in pool if i not in chosen]
        chosen.append(max(rest, key=lambda i: min(np.hypot(places[i][0] - places[j][0], places[i][1] - places[j][1])
                                                  for j in chosen)))
    return chosen
