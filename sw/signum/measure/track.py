# SPDX-License-Identifier: Apache-2.0
"""Feature tracking against the initial image.

A feature is a window of the picture in which it was chosen. In every further frame it is measured from the frame
before, which gives a prediction, and from its anchors, which give its position. Its first anchor is its initial
picture: as long as the feature is measured well from that one, its position cannot drift. When some features can no
longer be measured from their anchors, the frame before becomes an anchor for all features at once, with the positions
that the older anchors gave them there: one more link in the chain. The anchor with the smallest expected error is used,
so the chain is as short as the pictures allow, and becomes shorter again when an old view returns.

Every link's error is estimated from its peak (`chain`): a random part, and a part, due to perspective, that has the
same direction in link after link. A position is valid while 98 % of such positions are within the wanted precision;
after that the feature is flagged, and a new one, with an initial picture of its own, takes its place.

The board's slots bound the number of anchor pictures; if there are too many, the one that the fewest features are
measured from is released, but never the first: a camera that returns to where it began finds its features again. A
feature that is not found is moved along with the others and searched for again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.measure.chain import Fix, Pin, pin, pin_by_corners
from signum.measure.measurer import Measurement, Measurer, Query, View, white_match
from signum.measure.predict import SearchPredictor
from signum.measure.validity import Reason, Rules

PRECISE_PX = 1.8
"""Error allowed in original pixels: 2 px, less the error of the reference that tracks are compared with."""

TURNED_PX = 0.05
"""Expected error due to a turned or scaled picture from which on the corners of a window are measured, pixels."""


@dataclass(frozen=True)
class TrackSettings:
    """How to track; lengths in pixels of the board's picture."""

    window: int = 64
    features: int = 30
    """Number of features wanted in view; those that leave it or drift are replaced, several at a time."""
    precise_px: float = PRECISE_PX
    """Error that 98 % of the valid positions shall not exceed: PRECISE_PX, converted to pixels of the board."""
    healthy_score: float = 0.78
    """Least score of a measurement from an anchor; below it the two pictures are too unlike."""
    agree_px: float = 1.0
    """Largest distance between a feature's positions by an anchor and by the frame before, and between the
    displacements of a window and of its inner quarter."""
    neighbours_px: float = 2.0
    """Largest difference between a feature's motion and the common motion at its place, on flat ground."""
    relief: float = 0.25
    """Share of the common motion by which relief may add to that difference."""
    anchor_reach: int = 6
    """Search range around the prediction in a measurement from an anchor."""
    widest_reach: int = 32
    """Largest search range of all."""
    patience: int = 100
    """Number of frames after which a flagged feature is dropped, unless it was chosen in the first picture."""
    rules: Rules = field(default_factory=Rules)


@dataclass(frozen=True)
class TrackPoint:
    """A feature in a frame: its position, and the displacement from where it was first seen; pixels of the board's
    picture.

    `links` is the number of measurements chained up to the position: 1 while it is measured from its initial image.
    `error_px` is the distance from the truth that 98 % of such positions are within. `reason` is why it is not valid.
    """

    feature: int
    x: float
    y: float
    dx: float
    dy: float
    score: float
    margin: float
    valid: bool
    links: int
    error_px: float
    reason: str


@dataclass(eq=False)
class _Anchor:
    """A picture kept to measure features from, and the fix of each feature in it, by number."""

    view: View
    fixes: dict[int, Fix] = field(default_factory=dict)


@dataclass(eq=False)
class _Feature:
    number: int
    home: Floats
    first: View
    """Its initial picture."""
    fix: Fix
    velocity: Floats
    found: bool = True
    """Whether its last position was measured."""
    flagged: int = 0
    """Number of frames since it was last valid."""
    anchor: _Anchor | None = None
    """The anchor its last position was measured from."""


@dataclass(frozen=True)
class _Motion:
    """A feature's motion since the last frame, measured or, failing that, the common motion at its place. `pin` is the
    measurement."""

    step: Floats
    measured: bool
    pin: Pin


class Tracker:
    """Tracks windows through frames of one size, which are given to `step` in order."""

    def __init__(self, measurer: Measurer, settings: TrackSettings | None = None) -> None:
        self._measurer = measurer
        self._settings = settings or TrackSettings()
        self._features: list[_Feature] = []
        self._anchors: list[_Anchor] = []
        self._most_anchors = max(1, measurer.free_views - 2)
        self._last: View | None = None
        self._born = 0
        self._search = SearchPredictor(widest=self._settings.widest_reach)

    def step(self, frame: Image) -> list[TrackPoint]:
        """Track into the next frame.

        Args:
            frame: uint8 (height, width) of the measurer's size.

        Returns:
            One point for each feature not dropped, in order of their numbers; new ones have displacement 0.
        """
        live = self._measurer.view(frame)
        points = [] if self._last is None else self._follow(self._last, live)
        if self._last is not None and all(a.view is not self._last for a in self._anchors):
            self._measurer.release(self._last)
        self._last = live
        return points + self._renew(live)

    def _follow(self, last: View, live: View) -> list[TrackPoint]:
        motions = self._motions(last, live)
        answers = self._ask_anchors(live, motions)
        missing = [f for f in self._features if f.number not in answers and f.found and motions[f.number].measured]
        if missing:
            kept = self._keep(last)
            for f in missing:
                motion = motions[f.number]
                f.anchor = kept
                answers[f.number] = motion.pin.whole, f.fix.linked(motion.pin)
        points = [self._settle(f, motions[f.number], answers.get(f.number)) for f in self._features]
        first = self._anchors[0].view if self._anchors else None
        self._features = [f for f in self._features if f.flagged <= self._settings.patience or f.first is first]
        return points

    def _settle(self, f: _Feature, motion: _Motion, answer: tuple[Measurement, Fix] | None) -> TrackPoint:
        """Move a feature to its new position, and judge it."""
        before, found_before = f.fix.position, f.found
        if answer is None:
            f.fix = replace(f.fix, position=before + motion.step)
            whole = motion.pin.whole
            reason = str(whole.reason) or ("anchor" if motion.measured else "neighbours")
        else:
            whole, f.fix = answer
            reason = "" if f.fix.error <= self._settings.precise_px else "drift"
        f.found = answer is not None
        f.velocity = f.fix.position - before if f.found and found_before else motion.step
        f.flagged = f.flagged + 1 if reason else 0
        return _point(f, whole, reason)

    def _watched(self) -> list[_Feature]:
        """Features to measure: those valid lately, and those whose initial picture is still kept."""
        kept = {id(a.view) for a in self._anchors}
        return [f for f in self._features if id(f.first) in kept or not f.flagged or (f.found and f.flagged < 3)]

    def _motions(self, last: View, live: View) -> dict[int, _Motion]:
        """Motion of every feature since the last frame, by number."""
        s = self._settings
        watched = self._watched()
        starts = np.array([f.fix.position for f in watched]).reshape(-1, 2)
        guesses = [f.velocity for f in watched]
        answers = self._pinpoint([_query(last, live, p, s.window, g, self._search.reach)
                                  for p, g in zip(starts, guesses, strict=True)], s.rules)
        in_view = sum(a.whole.reason is not Reason.OUTSIDE for a in answers)
        if 2 * sum(a.whole.valid for a in answers) < in_view and self._search.reach < s.widest_reach:
            still = np.zeros(2)
            answers = self._pinpoint([_query(last, live, p, s.window, still, s.widest_reach) for p in starts], s.rules)
        steps = np.array([a.step for a in answers]).reshape(-1, 2)
        everywhere = np.array([f.fix.position for f in self._features]).reshape(-1, 2)
        common = dict(zip((f.number for f in self._features), _common_motion(
            starts, steps, np.array([a.whole.valid for a in answers], bool), everywhere), strict=True))
        unseen = Pin(Measurement(0.0, 0.0, 0.0, 0.0, False, Reason.OUTSIDE))
        motions = {number: _Motion(step, False, unseen) for number, step in common.items()}
        errors = []
        for f, answer, step, guess in zip(watched, answers, steps, guesses, strict=True):
            expected = common[f.number]
            near = float(np.hypot(*(step - expected))) <= s.neighbours_px + s.relief * float(np.hypot(*expected))
            measured = answer.whole.valid and near
            if measured:
                errors.append(float(np.abs(step - guess).max()))
            motions[f.number] = _Motion(step if measured else expected, measured, answer)
        self._search.learn(np.array(errors), in_view)
        return motions

    def _ask_anchors(self, live: View, motions: dict[int, _Motion]) -> dict[int, tuple[Measurement, Fix]]:
        """Per feature measured well from an anchor: the measurement and fix with the smallest expected error."""
        s = self._settings
        asked: list[tuple[_Anchor, _Feature, int]] = []
        queries = []
        watched = self._watched()
        for anchor in self._anchors:
            for f in watched:
                if f.number not in anchor.fixes:
                    continue
                sure = f.found and motions[f.number].measured
                reach = s.anchor_reach if sure else min(s.anchor_reach + 3 * (1 + f.flagged), s.widest_reach)
                origin = anchor.fixes[f.number].position
                asked.append((anchor, f, reach))
                guess = f.fix.position + motions[f.number].step - origin
                queries.append(_query(anchor.view, live, origin, s.window, guess, reach))
        best: dict[int, tuple[Measurement, Fix]] = {}
        rules = replace(s.rules, min_score=max(s.healthy_score, s.rules.min_score))
        for (anchor, f, reach), answer in zip(asked, self._pinpoint(queries, rules), strict=True):
            if not answer.whole.valid:
                continue
            fix = anchor.fixes[f.number].linked(answer)
            motion = motions[f.number]
            tolerance = s.agree_px if f.found and motion.measured else reach
            if np.hypot(*(fix.position - f.fix.position - motion.step)) > tolerance:
                continue
            if f.number not in best or fix.error < best[f.number][1].error:
                best[f.number] = answer.whole, fix
                f.anchor = anchor
        return best

    def _keep(self, last: View) -> _Anchor:
        """Make the last frame an anchor of every feature found in it; if need be, release an older anchor."""
        anchor = next((a for a in self._anchors if a.view is last), None)
        if anchor is None:
            if len(self._anchors) >= self._most_anchors:
                kept = 1 if self._most_anchors > 1 else 0  # the first picture stays
                users = [sum(not f.flagged and f.anchor is a for f in self._features) for a in self._anchors[kept:]]
                self._measurer.release(self._anchors.pop(kept + int(np.argmin(users))).view)
            anchor = _Anchor(last)
            self._anchors.append(anchor)
        anchor.fixes.update({f.number: f.fix for f in self._features if f.found})
        return anchor

    def _pinpoint(self, queries: Sequence[Query], rules: Rules) -> list[Pin]:
        """Measure windows, then the inner quarter of each one found, whose displacement is taken as that of the centre.

        A whole window follows the best-matching part of what it shows, which under perspective and relief is not its
        centre; the inner quarter alone is too small for a reliable match.
        """
        rules = replace(rules, texture=False)  # checked when the feature was chosen
        pins = [Pin(m) for m in self._measurer.measure(queries, rules)]
        found = [i for i, p in enumerate(pins) if p.whole.valid]
        least = self._measurer.window_range[0]
        inner = [replace(queries[i], width=max(queries[i].width // 2, least), height=max(queries[i].height // 2, least),
                         guess=(pins[i].whole.dx_px, pins[i].whole.dy_px), reach=(3, 3)) for i in found]
        loose = replace(rules, min_score=min(rules.min_score, 0.62), min_margin=0.0, backward=False)
        for i, part in zip(found, self._measurer.measure(inner, loose), strict=True):
            pins[i] = pin(pins[i].whole, part, self._measurer.sigma, self._settings.window, self._settings.agree_px)
        turned = [i for i in found if pins[i].turned > TURNED_PX]
        half = self._settings.window // 2
        corners = [replace(queries[i], x=queries[i].x + dx * half // 2, y=queries[i].y + dy * half // 2, width=half,
                           height=half, guess=tuple(pins[i].step), reach=(5, 5))
                   for i in turned for dx in (-1, 1) for dy in (-1, 1)]
        answers = self._measurer.measure(corners, loose)
        for k, i in enumerate(turned):
            pins[i] = pin_by_corners(pins[i], answers[4 * k:4 * k + 4], self._measurer.sigma, self._settings.window)
        return pins

    def _renew(self, live: View) -> list[TrackPoint]:
        """Choose new features in the free parts of the picture, once three tenths of those wanted are missing."""
        s = self._settings
        width, height = self._measurer.size
        half = s.window // 2
        present = [f.fix.position for f in self._features if not f.flagged
                   and half <= f.fix.position[0] < width - half and half <= f.fix.position[1] < height - half]
        if len(present) > 0.7 * s.features:
            return []
        places = [p for p in _grid(self._measurer.size, s.window, s.features)
                  if all(np.hypot(*(p - q)) >= 0.7 * s.window for q in present)]
        likeness = self._measurer.likeness(live, [(int(x), int(y), s.window, s.window) for x, y in places])
        base = white_match(2.0, self._measurer.sigma)
        moving = [f.velocity for f in self._features if f.found]
        velocity = np.median(moving, axis=0) if moving else np.zeros(2)
        points: list[TrackPoint] = []
        for place, alike in zip(places, likeness, strict=True):
            if alike <= s.rules.max_likeness and len(present) + len(points) < s.features:
                f = _Feature(self._born, place, live, Fix(place), velocity)
                self._born += 1
                points.append(_point(f, Measurement(0.0, 0.0, 1.0, (1 - alike) * (1 - base), True), ""))
                self._features.append(f)
        return points


def _query(reference: View, live: View, position: Floats, window: int, guess: Floats, reach: int) -> Query:
    x, y = (round(float(v)) for v in position)
    return Query(reference, live, x, y, window, window, (float(guess[0]), float(guess[1])), (reach, reach))


def _point(f: _Feature, answer: Measurement, reason: str) -> TrackPoint:
    position, moved = f.fix.position, f.fix.position - f.home
    return TrackPoint(f.number, float(position[0]), float(position[1]), float(moved[0]), float(moved[1]), answer.score,
                      answer.margin, not reason, f.fix.links, f.fix.error, reason)


def _common_motion(places: Floats, steps: Floats, valid: NDArray[np.bool_], everywhere: Floats) -> Floats:
    """The common motion at `everywhere`, (n, 2), by the valid steps at `places`: an affine field that most of them fit,
    else their median."""
    known = int(valid.sum())
    if known == 0:
        return np.zeros_like(everywhere)
    if known >= 8:
        model, inliers = cv2.estimateAffine2D(places[valid], places[valid] + steps[valid], ransacReprojThreshold=3.0)
        if model is not None and 2 * int(inliers.sum()) >= known:
            return np.asarray(everywhere @ model[:, :2].T + model[:, 2] - everywhere, np.float64)
    return np.broadcast_to(np.median(steps[valid], axis=0), everywhere.shape).astype(np.float64)


def _grid(size: tuple[int, int], window: int, wanted: int) -> Floats:
    """About `wanted` centres (n, 2) of whole windows, evenly over the picture, 4 pixels or more from its border."""
    spans = [max(n - window - 8, 0) for n in size]
    pitch = max(window / 4, np.sqrt(max(spans[0], 1) * max(spans[1], 1) / max(wanted, 1)))
    axes = []
    for n, span in zip(size, spans, strict=True):
        count = int(span // pitch) + 1
        axes.append(np.rint((n - 1) / 2 + (np.arange(count) - (count - 1) / 2) * (span / max(count - 1, 1))))
    return np.array([(x, y) for y in axes[1] for x in axes[0]], np.float64)
