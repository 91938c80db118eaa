# SPDX-License-Identifier: Apache-2.0
"""Where a live frame is in a mosaic.

Without a prior the coarse search proposes places; with a prior only that is tried. Each predicts the part of the mosaic
the frame shows, which is cut out, rotated and scaled as the frame is, and compared with it window by window, each
validated on its own, within a few pixels. A place is accepted if enough windows, and a good share of those on the
mosaic, agree on it. If another place matches nearly as well, neither is returned: the mosaic shows the same thing
twice. A place that shares a part with the right one, or something like it, matches in fewer windows, and worse.

Without a prior, most windows with texture around the frame's middle must agree as well: where a mosaic is torn, a frame
matches one side of the tear while its middle may lie on the other.

The number of windows that must agree is set by chance: on floors the mosaic does not show, the best of all candidates
had 7 of 48 windows at most (40 frames); on the mosaic, the median was 22 and the least 15, as perspective and seams
reject the others.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from signum.applications.navigate.chart import Chart
from signum.applications.navigate.coarse import HALF, CoarseSearch
from signum.applications.navigate.compare import Comparer, Comparison
from signum.applications.navigate.place import LocaliseLimits, Place
from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.measure.validity import Reason

STRAIGHT_DEG, STRAIGHT_ZOOM = 2.0, 0.03
"""Largest error of a guess, in rotation (degrees) and scale, at which windows match well enough without a second
comparison."""


class Localiser:
    """Finds frames of one size in a mosaic.

    Args:
        measurer: makes a measurer for a picture size (width, height) and a sigma; earlier ones are not used again.
        largest: (width, height) of the largest picture the board takes.
        shown: how the frames are scaled for the board.
        chart: the mosaic; its pixels are about as large as the frames' own.
        window: side of the windows, pixels of the board.
        sigma: pixels of the board.
        limits: see `LocaliseLimits`.
    """

    def __init__(self, measurer: Callable[[tuple[int, int], float], Measurer], largest: tuple[int, int], shown: Fit,
                 chart: Chart, window: int = 64, sigma: float = 2.0, limits: LocaliseLimits | None = None) -> None:
        self.chart, self.shown = chart, shown
        self.window = min(window, min(shown.board) // 3)
        self.limits = limits or LocaliseLimits()
        factor = max(shown.factor)
        fine = chart.shrunk(factor)
        self._original = Similarity(factor + 0j, HALF * factor - HALF)
        """Board's pixels -> original ones, of frame and mosaic alike."""
        self._coarse = CoarseSearch(measurer, largest, shown.board, fine)
        self._comparer = Comparer(measurer, shown.board, fine, self.window, sigma, self.limits)

    def locate(self, picture: Image, prior: Similarity | None = None) -> Place:
        """Find a frame.

        Args:
            picture: as the source gives it.
            prior: pixels of the original frame -> pixels of mosaic.png, within about `LocaliseLimits.reach` board
                pixels; None searches the whole mosaic.
        """
        live = self.shown.show(picture)
        if prior is not None:
            return self._place(self._look(live, self._original.inverse @ prior @ self._original), False)
        limits = self.limits
        found: list[Comparison] = []
        for calm in (True, False):
            self._comparer.forget()
            guesses = self._coarse.candidates(live, limits.turns_deg, limits.convinced, limits.rot_deg, limits.zoom,
                                              limits.candidates, calm)
            found = sorted([*found, *(self._look(live, guess, True) for guess in guesses)], key=lambda f: -f.agreed)
            good = [f for f in found if self._good(f, True)]
            if good:
                break
        if any(self._apart(good[0], other) and self._rivals(good[0], other) for other in good[1:]):
            return Place(agreed=good[0].agreed, tried=good[0].tried, reason="two places match")
        if good and not self._agrees_in_middle(live, good[0]):
            return Place(agreed=good[0].agreed, tried=good[0].tried,
                         reason="the mosaic does not match around the frame's middle")
        return self._place(found[0], True) if found else Place(reason="no windows agree")

    def pinpoint(self, picture: Image, prior: Similarity, target: tuple[float, float]) -> Floats | None:
        """Where a place of the mosaic is in a frame, from the windows around it alone: a mosaic is only locally exact.

        Args:
            picture: as the source gives it.
            prior: pixels of the original frame -> pixels of mosaic.png, as `locate` found it for this frame.
            target: pixels of mosaic.png.

        Returns:
            (2,) pixels of the original frame; None where it is not in view, or too few windows agree.
        """
        guess = self._original.inverse @ prior @ self._original
        at = self._original.inverse(np.array(target, np.float64))
        seen = guess.inverse(at)
        live, size = self.shown.show(picture), np.array(self.shown.board)
        # Where the windows next to it have too little texture, those further off are used.
        for step in (self.window // 2, self.window):
            edge = step + self.window // 2
            middle = np.clip(np.rint(seen), edge, size - edge - 1)
            if (np.abs(middle - seen) > self.window // 2).any():
                return None
            p, q, _ = self._comparer.around(live, guess, middle, step)
            shift = np.median(q - p, axis=0) if len(p) >= 3 else np.zeros(2)
            agree = np.hypot(*(q - p - shift).T) <= self.limits.miss * self.window
            if agree.sum() >= 3:
                # `seen` is the target in the predicted picture; the frame is displaced from that by the weighted shift.
                weight = np.exp(-np.sum((p[agree] - seen) ** 2, axis=1) / (2 * self.window**2))
                return self._original(seen + np.average((q - p)[agree], axis=0, weights=weight))
        return None

    def _agrees_in_middle(self, live: Image, look: Comparison) -> bool:
        """Whether most windows with texture around the frame's middle agree with a comparison."""
        p, q, answers = self._comparer.around(live, look.similarity, np.array(self.shown.board) // 2, self.window // 2)
        agreed = int((np.hypot(*(q - p).T) <= self.limits.miss * self.window).sum())
        return 2 * agreed > sum(m.reason is not Reason.TEXTURE for m in answers)

    def _good(self, look: Comparison, anywhere: bool) -> bool:
        limits = self.limits
        windows, share = (limits.sure_windows, limits.sure_share) if anywhere else (limits.windows, limits.share)
        return look.agreed >= windows and look.agreed >= share * look.tried

    def _apart(self, a: Comparison, b: Comparison) -> bool:
        centre = (np.array(self.shown.board, np.float64) - 1) / 2
        return float(np.hypot(*(a.similarity(centre) - b.similarity(centre)))) > self.window / 2

    def _rivals(self, best: Comparison, other: Comparison) -> bool:
        """Whether another place matches nearly as well as the best one, in windows and in score."""
        return (other.agreed >= self.limits.rival * best.agreed
                and other.score - 0.5 >= self.limits.rival_score * (best.score - 0.5))

    def _place(self, look: Comparison, anywhere: bool) -> Place:
        """The comparison as a place in original pixels, or the reason why it is refused."""
        if not self._good(look, anywhere):
            return Place(agreed=look.agreed, tried=look.tried,
                         reason=f"only {look.agreed} of {look.tried} windows agree" if look.tried else "off the mosaic")
        found = self._original @ look.similarity @ self._original.inverse
        x, y = found((np.array(self.shown.source, np.float64) - 1) / 2)
        share = min(1.0, look.agreed / max(look.tried, 1) / 0.5)
        confidence = max(1, round(100 * share * min(1.0, (look.score - 0.5) / 0.25)))
        return Place(found, (float(x), float(y)), look.score, confidence, look.agreed, look.tried)

    def _look(self, live: Image, guess: Similarity, twice: bool = False) -> Comparison:
        """Compare a frame with what it should show by `guess`, a second time by the result where the guess was wrong in
        rotation or scale or the result is poor; `twice` in any case, for a coarse guess whose search ranges may have
        excluded half the windows."""
        look = self._comparer.compare(live, guess)
        change = guess.inverse @ look.similarity
        if look.agreed >= 3 and (twice or abs(change.rot_deg) > STRAIGHT_DEG or abs(change.scale - 1) > STRAIGHT_ZOOM
                                 or not self._good(look, True)):
            again = self._comparer.compare(live, look.similarity)
            look = again if again.agreed >= look.agreed else look
        return look
