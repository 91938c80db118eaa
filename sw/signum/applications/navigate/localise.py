"""Where a live frame is in a mosaic.

Without a prior the coarse search proposes places; with one there is only the prior. Each says what of the mosaic the
frame should show: that is cut out, turned and scaled as the frame is, and compared with it window by window, each
validated by itself, within a few pixels. A place is accepted if enough windows, and a good share of those on the
mosaic, agree on it; if two are, none is: a mosaic that shows the same thing twice cannot tell.

Found without a prior, most windows with texture about the frame's middle must agree, too: where a mosaic is torn, a
frame fits one bank of the tear, and its middle may lie on the other.

How many must agree is set by chance: on floors the mosaic does not show, the best of all candidates gathered 7 of 48
windows at most (40 frames); on the mosaic, 22 in the middle and never fewer than 15, for perspective and seams cost
the others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from signum.applications.navigate.chart import Chart, filled
from signum.applications.navigate.coarse import HALF, CoarseSearch, spread, whole
from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity, fit, vote
from signum.measure.measurer import Measurement, Measurer, Query, Reason, Rules

MOST_WINDOWS = (9, 7)
"""Across and down."""
STRAIGHT_DEG, STRAIGHT_ZOOM = 2.0, 0.03
"""Up to this much a guess may be turned or scaled wrongly: windows match well enough."""


@dataclass(frozen=True)
class Limits:
    """What is looked for and what is accepted.

    Attributes:
        turns_deg: rotations of the frame against the mosaic that are tried without a prior, in order.
        convinced: votes at which no further rotation is tried.
        candidates: places looked at closely.
        rot_deg, zoom: largest rotation and zoom beyond what was tried.
        miss: by how much an agreeing window may miss, as a fraction of its side: a mosaic is flat, the scene is not.
        windows, share: least number of agreeing windows, and least share of those on the mosaic, with a prior.
        sure_windows, sure_share: the same without one.
        reach: pixels of the board searched around a predicted place.
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
    reach: int = 24
    rules: Rules = field(default_factory=lambda: Rules(min_score=0.6, min_margin=0.01, max_return_px=2.0))


ANY_HEADING = (0.0, *(s * t for t in range(9, 180, 9) for s in (-1.0, 1.0)), 180.0)
"""Turns for a frame of any heading."""


@dataclass(frozen=True)
class Place:
    """Where a frame is.

    Attributes:
        similarity: pixels of the original frame -> pixels of mosaic.png; None where it is not known.
        centre: of the frame, pixels of mosaic.png; NaN where not known.
        score: median matching fraction of the windows that agree.
        confidence: 0 to 100; 0 means that nothing else here is valid.
        agreed, tried: windows that agree; that lie on the mosaic and have texture.
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
        """Whether it is."""
        return self.similarity is not None


@dataclass(frozen=True)
class _Look:
    """A comparison, in the board's pixels: frame -> chart, and how many windows bear it out."""

    similarity: Similarity
    agreed: int = 0
    tried: int = 0
    score: float = 0.0


class Localiser:
    """Finds frames of one size in a mosaic.

    Args:
        measurer: makes a measurer for a picture size (width, height) and a sigma; earlier ones are not used any more.
        largest: (width, height) of the largest picture the board takes.
        shown: how the frames are shown to the board.
        chart: the mosaic; its pixels are about as large as the frames' own.
        window: side of the windows, pixels of the board.
        sigma: pixels of the board.
        limits: see `Limits`.
    """

    def __init__(self, measurer: Callable[[tuple[int, int], float], Measurer], largest: tuple[int, int], shown: Fit,
                 chart: Chart, window: int = 64, sigma: float = 2.0, limits: Limits | None = None) -> None:
        self._make, self.chart, self.shown = measurer, chart, shown
        self.window = min(window, min(shown.board) // 3)
        self.sigma, self.limits = sigma, limits or Limits()
        factor = max(shown.factor)
        self._fine = chart.shrunk(factor)
        self._picture = filled(self._fine)
        self._original = Similarity(factor + 0j, HALF * factor - HALF)
        """Board's pixels -> original ones, of frame and mosaic alike."""
        self._coarse = CoarseSearch(measurer, largest, shown.board, self._fine)
        self._measurer: Measurer | None = None

    def locate(self, picture: Image, prior: Similarity | None = None) -> Place:
        """Find a frame.

        Args:
            picture: as the source gives it.
            prior: pixels of the original frame -> pixels of mosaic.png, within about `Limits.reach` board pixels; None
                searches everywhere.
        """
        live = self.shown.show(picture)
        if prior is not None:
            return self._said(self._look(live, self._original.inverse @ prior @ self._original), False)
        limits = self.limits
        self._measurer = None
        guesses = self._coarse.candidates(live, limits.turns_deg, limits.convinced, limits.rot_deg, limits.zoom,
                                          limits.candidates)
        found = sorted((self._look(live, guess, True) for guess in guesses), key=lambda f: -f.agreed)
        good = [f for f in found if self._good(f, True)]
        if any(self._apart(good[0], other) for other in good[1:]):
            return Place(agreed=good[0].agreed, tried=good[0].tried, reason="two places answer")
        if good and not self._held(live, good[0]):
            return Place(agreed=good[0].agreed, tried=good[0].tried, reason="the mosaic does not hold about the middle")
        return self._said(found[0], True) if found else Place(reason="no windows agree")

    def pinpoint(self, picture: Image, prior: Similarity, target: tuple[float, float]) -> Floats | None:
        """Where a place of the mosaic is in a frame, from the windows about it alone: a mosaic is true only nearby.

        Args:
            picture: as the source gives it.
            prior: pixels of the original frame -> pixels of mosaic.png, as `locate` found it for this frame.
            target: pixels of mosaic.png.

        Returns:
            (2,) pixels of the original frame; None where it is not in sight, or too few windows agree.
        """
        guess = self._original.inverse @ prior @ self._original
        at = self._original.inverse(np.array(target, np.float64))
        seen = guess.inverse(at)
        live, size = self.shown.show(picture), np.array(self.shown.board)
        # Where little about it has texture, windows farther off must do.
        for step in (self.window // 2, self.window):
            edge = step + self.window // 2
            middle = np.clip(np.rint(seen), edge, size - edge - 1)
            if (np.abs(middle - seen) > self.window // 2).any():
                return None
            p, q, _ = self._about(live, guess, middle, step)
            shift = np.median(q - p, axis=0) if len(p) >= 3 else np.zeros(2)
            agree = np.hypot(*(q - p - shift).T) <= self.limits.miss * self.window
            if agree.sum() >= 3:
                # `seen` is where the chart's place lies in what was cut out; that lies `shift` further on in the frame.
                weight = np.exp(-np.sum((p[agree] - seen) ** 2, axis=1) / (2 * self.window**2))
                return self._original(seen + np.average((q - p)[agree], axis=0, weights=weight))
        return None

    def _about(self, live: Image, guess: Similarity, middle: Floats, step: int
               ) -> tuple[Floats, Floats, list[Measurement]]:
        """Nine windows, `step` pixels apart, about a point of the frame, as `_measure` gives them."""
        x, y = (int(v) for v in middle)
        centres = [(x + i * step, y + j * step) for j in (-1, 0, 1) for i in (-1, 0, 1)]
        return self._measure(live, guess, centres, self.limits.reach // 2)

    def _held(self, live: Image, look: _Look) -> bool:
        """Whether most windows about the frame's middle, those without texture aside, are where a comparison says."""
        p, q, answers = self._about(live, look.similarity, np.array(self.shown.board) // 2, self.window // 2)
        agreed = int((np.hypot(*(q - p).T) <= self.limits.miss * self.window).sum())
        return 2 * agreed > sum(m.reason is not Reason.TEXTURE for m in answers)

    def _good(self, look: _Look, anywhere: bool) -> bool:
        limits = self.limits
        windows, share = (limits.sure_windows, limits.sure_share) if anywhere else (limits.windows, limits.share)
        return look.agreed >= windows and look.agreed >= share * look.tried

    def _apart(self, a: _Look, b: _Look) -> bool:
        centre = (np.array(self.shown.board, np.float64) - 1) / 2
        return float(np.hypot(*(a.similarity(centre) - b.similarity(centre)))) > self.window / 2

    def _said(self, look: _Look, anywhere: bool) -> Place:
        """The answer in original pixels."""
        if not self._good(look, anywhere):
            return Place(agreed=look.agreed, tried=look.tried,
                         reason=f"only {look.agreed} of {look.tried} windows agree" if look.tried else "off the mosaic")
        found = self._original @ look.similarity @ self._original.inverse
        x, y = found((np.array(self.shown.source, np.float64) - 1) / 2)
        share = min(1.0, look.agreed / max(look.tried, 1) / 0.5)
        confidence = max(1, round(100 * share * min(1.0, (look.score - 0.5) / 0.25)))
        return Place(found, (float(x), float(y)), look.score, confidence, look.agreed, look.tried)

    def _look(self, live: Image, guess: Similarity, twice: bool = False) -> _Look:
        """Compare a frame with what it should show; where that turns out to be turned or scaled, once more: and `twice`
        in any case where the guess is a rough one, whose searches may have ended short of half the windows."""
        look = self._compare(live, guess)
        change = guess.inverse @ look.similarity
        if look.agreed >= 3 and (twice or abs(change.rot_deg) > STRAIGHT_DEG or abs(change.scale - 1) > STRAIGHT_ZOOM
                                 or not self._good(look, True)):
            again = self._compare(live, look.similarity)
            look = again if again.agreed >= look.agreed else look
        return look

    def _compare(self, live: Image, guess: Similarity) -> _Look:
        across, down = (min(most, max(2, math.ceil(1.5 * (n - self.window) / self.window)))
                        for most, n in zip(MOST_WINDOWS, self.shown.board, strict=True))
        centres = spread(self.window, self.shown.board, (across, down))
        p, q, answers = self._measure(live, guess, centres, self.limits.reach)
        tried = sum(m.reason is not Reason.TEXTURE for m in answers)
        if len(p) < 3:
            return _Look(guess, len(p), tried)
        tolerance = self.limits.miss * self.window
        start, _ = vote(p, q, tolerance, self.limits.rot_deg, self.limits.zoom, 0.75 * self.window)
        result = fit(p, q, start, tolerance)
        scores = np.array([m.score for m in answers if m.valid])[result.agree]
        if not scores.size:
            return _Look(guess, 0, tried)
        return _Look(guess @ result.similarity.inverse, scores.size, tried, float(np.median(scores)))

    def _measure(self, live: Image, guess: Similarity, centres: Sequence[tuple[int, int]], reach: int
                 ) -> tuple[Floats, Floats, list[Measurement]]:
        """Windows of what the frame should show, searched for in it: centres (n, 2) of the valid ones, where they are
        (n, 2), and all answers; windows not on the mosaic are left out."""
        size, flags = self.shown.board, cv2.WARP_INVERSE_MAP
        expected = cv2.warpAffine(self._picture, guess.matrix, size, flags=flags | cv2.INTER_LINEAR,
                                  borderMode=cv2.BORDER_REPLICATE)
        covered = cv2.warpAffine(self._fine.covered, guess.matrix, size, flags=flags | cv2.INTER_NEAREST)
        inside = cv2.integral(np.asarray(covered > 0, np.uint8))
        kept = [c for c in centres if whole(inside, c, self.window)]
        if not kept:
            return np.zeros((0, 2)), np.zeros((0, 2)), []
        if self._measurer is None:
            self._measurer = self._make(size, self.sigma)
        measurer = self._measurer
        reference, view = measurer.view(np.asarray(expected, np.uint8)), measurer.view(live)
        answers = measurer.measure([Query(reference, view, x, y, self.window, self.window, reach=(reach, reach))
                                    for x, y in kept], self.limits.rules)
        measurer.release(reference)
        measurer.release(view)
        good = [i for i, m in enumerate(answers) if m.valid]
        p = np.array([kept[i] for i in good], np.float64).reshape(-1, 2)
        moved = np.array([[answers[i].dx_px, answers[i].dy_px] for i in good], np.float64).reshape(-1, 2)
        return p, p + moved, answers
