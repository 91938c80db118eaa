# SPDX-License-Identifier: Apache-2.0
"""Registration of two overlapping pictures: rotation, scale and translation, from windows that must agree.

1. Coarse: both pictures are scaled to 160 pixels; a grid of windows, each searched for in the whole other picture,
   votes for a similarity (`geometry.similarity.vote`). With windows of a fifth of the picture, the offset between the
   pictures may be two thirds of a frame.
2. Fine: windows of the chosen size cover the predicted overlap of the pictures at the board's resolution. Each is
   searched for near its predicted place and validated by itself; a similarity is fitted to the valid ones by robust
   least squares.
3. Accepted is a similarity for which there is enough evidence: that windows which agree would agree by chance must be
   unlikely, given how many were tried, over which areas, within which distance (`likelihood`). Where that is doubtful,
   other windows are asked in a second look. A pair that shows several depths, or a scene that repeats itself, has
   several such motions: the others are its rivals, between which only other pairs can decide.

With a good guess (a video), the coarse step is left out. Between the two steps the board changes size: a measurer made
for one of them ends the one before, whose views are dropped with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from golden.correlate import above_chance
from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.geometry.similarity import IDENTITY, Similarity, fit, vote
from signum.measure.agree import Found, Motion, motions
from signum.measure.likelihood import nearby
from signum.measure.measurer import Measurer, View
from signum.measure.refine import refine
from signum.measure.registration import UNKNOWN, Prepared, Registration, RegistrationLimits, Rival
from signum.measure.surface import settle
from signum.measure.validity import REASONS, Answers, Reason, Rules

COARSE_SIDE = 160
"""Longer side of the coarse picture, pixels, unless the shorter one would fall below COARSE_LEAST."""
COARSE_LEAST = 64
COARSE_WINDOW = 32
COARSE_SIGMA = 1.25
COARSE_GRID = (7, 6)
"""Number of coarse windows across and down."""
COARSE_REACH = 20
"""Search range of a second coarse vote around what the first one found, pixels of the coarse picture."""
WITNESS = 0.75, 192, 8
"""Windows of which a doubtful registration is asked: side, of that of the first look's; most of them; search range,
pixels of the board."""
DETAIL = 0.5, 400, 12
"""The same of those that tell the motion of an accepted one; the depths of an overlap may lie further apart."""
FEWEST = 8
"""Least number of these that tell it."""
SMALL_RULES = Rules(min_score=0.6, min_margin=0.0, backward=False, texture=False)
"""Rules of both, since windows are where they are known to be."""
ANYTHING = Rules(min_score=0.0, min_margin=-1.0, backward=False, texture=False)
"""Rules of the coarse search: every window may vote."""

Centres = NDArray[np.int64]
"""(n, 2) centres of windows, as those of `Query`."""


@dataclass(frozen=True)
class _Vote:
    """A similarity of the coarse step, original pixels, and the number of windows that vote for it."""

    similarity: Similarity
    count: int


class Registrar:
    """Registers pictures of one size.

    Args:
        measurer: makes a measurer for a picture size (width, height) and a sigma, which ends earlier ones of its board.
        fine: scales the original pictures for the board.
        coarse: scales them for the coarse step.
        window: side of the fine windows, pixels of the board.
        sigma: of the fine step, pixels of the board.
        limits: see `RegistrationLimits`.
    """

    def __init__(self, measurer: Callable[[tuple[int, int], float], Measurer], fine: Fit, coarse: Fit, window: int = 64,
                 sigma: float = 2.5, limits: RegistrationLimits | None = None) -> None:
        self._make = measurer
        self.fine, self.coarse = fine, coarse
        self.window, self.sigma = window, sigma
        self.limits = limits or RegistrationLimits()
        self._measurer: Measurer | None = None
        self._reference: tuple[Prepared, Similarity, View] | None = None
        size = np.array(fine.source, np.float64)
        self.centre: Floats = (size - 1) / 2

    @classmethod
    def on(cls, measurer: Callable[[tuple[int, int], float], Measurer], fine: Fit, window: int,
           sigma: float) -> Registrar:
        """A registrar with the coarse step at its usual size.

        Raises:
            SourceError: if the pictures are too narrow for it.
        """
        longest = max(COARSE_SIDE, math.ceil(COARSE_LEAST * max(fine.source) / min(fine.source)))
        return cls(measurer, fine, fine.coarser(longest), window, sigma)

    def prepare(self, picture: Image) -> Prepared:
        """A picture for `register`."""
        return Prepared(self.coarse.show(picture), self.fine.show(picture))

    def register(
        self, a: Prepared, b: Prepared, guess: Similarity | None = None, reach: int | None = None
    ) -> Registration:
        """Find a in b.

        Args:
            a: the picture to be found.
            b: the picture in which it is searched for.
            guess: original pixels of a -> of b; None searches everywhere.
            reach: search range around the guess, pixels of the board.
        """
        if guess is not None:
            return self._around(a, b, guess, reach or self.limits.reach)
        result = self._refused(IDENTITY, "no two windows agree")
        for guess in self._coarsely(a, b):
            found = self._around(a, b, guess, self.limits.reach)
            if result.accepted and found.accepted and self._apart(result, found):
                return replace(result, accepted=False, reason="two places match: the scene repeats itself")
            if found.accepted > result.accepted or (found.accepted == result.accepted
                                                    and found.agreed >= result.agreed):
                result = found
        return result

    def _apart(self, one: Registration, other: Registration) -> bool:
        """Whether two registrations are of different places, rather than of one place with different errors."""
        return math.dist(one.shift, other.shift) > self.limits.fine_miss * 2 * self.window * max(self.fine.factor)

    def _around(self, a: Prepared, b: Prepared, guess: Similarity, reach: int) -> Registration:
        """The fine step around a guess and, if it does not succeed, around its own result; then a closer look."""
        result = self._finely(a, b, guess, reach)
        if not result.accepted and result.agreed >= 3:  # with a better rotation, more windows may match
            again = self._finely(a, b, result.similarity, self.limits.reach)
            result = again if again.evidence > result.evidence else result
        return self._closer(a, b, result) if result.agreed >= self.limits.windows else result

    def _closer(self, a: Prepared, b: Prepared, seen: Registration) -> Registration:
        """The registration after two more looks: where it is in doubt, at many smaller windows, which are witnesses of
        their own, because few of them agree by chance; where it is accepted, at yet smaller ones, which tell the motion
        of the surface that most of the overlap shows."""
        if seen.evidence < self.limits.sure:
            seen = self._doubted(a, b, seen)
        return self._settled(a, b, seen) if seen.accepted else seen

    def _doubted(self, a: Prepared, b: Prepared, seen: Registration) -> Registration:
        window, at, p, q = self._small(a, b, seen.similarity, *WITNESS)
        if len(at) < 4:
            return seen
        if len(p) < 4:
            return self._witnessed(seen, at[:0], at, window)
        found = refine(p, q, seen.similarity, max(self.fine.factor), self.fine.source)
        return self._witnessed(seen, at[: len(p)][found.agree], at, window)

    def _settled(self, a: Prepared, b: Prepared, seen: Registration) -> Registration:
        _, _, p, q = self._small(a, b, seen.similarity, *DETAIL)
        if len(p) < FEWEST:
            return seen
        found, sloping = settle(p, q, seen.similarity, max(self.fine.factor), self.fine.source)
        if found.agree.sum() < FEWEST:
            return seen
        middle = p[found.agree].mean(axis=0)
        spread = float(np.sqrt(((p[found.agree] - middle) ** 2).sum(axis=1).mean()))
        return replace(seen, similarity=found.similarity, shift=self._shift(found.similarity),
                       middle=(float(middle[0]), float(middle[1])), spread_px=spread, rms_px=found.rms_px,
                       shear=(found.shear.real, found.shear.imag), shear_error=min(UNKNOWN, found.shear_error),
                       sloping=sloping)

    def _small(self, a: Prepared, b: Prepared, about: Similarity, share: float, most: int, reach: int
               ) -> tuple[int, Floats, Floats, Floats]:
        """Windows of a share of the side of the first look's around a motion: their side; the centres of all that were
        tried, those found first; and where these are in both pictures, original pixels."""
        measurer, (view, turn) = self._warped(a, self._turn(about))
        onward = about @ turn.inverse
        window = max(24, round(share * self._overlap(onward, turn)[0]))
        centres = self._inside(onward, turn, window, most)
        if len(centres) < 4:
            none = np.zeros((0, 2))
            return window, none, none, none
        live = measurer.view(b.fine)
        at, answers = self._search(measurer, view, live, centres, onward, window, reach, SMALL_RULES)
        measurer.release(live)
        found = answers.valid
        p = turn.inverse(self.fine.to_source(at[found]))
        q = self.fine.to_source(at[found] + answers.moved[found])
        return window, np.concatenate([at[found], at[~found]]), p, q

    def _witnessed(self, seen: Registration, agreeing: Floats, tried: Floats, window: int) -> Registration:
        """A doubtful registration with the evidence of the closer look's windows. Where it has rivals, which have none,
        they only count against it."""
        if seen.evidence >= self.limits.sure:
            return seen
        near = nearby(agreeing, tried, window)
        proof = seen.evidence + (min(near, 0.0) if seen.rivals else near)
        enough = proof >= self.limits.evidence and seen.agreed >= self.limits.windows
        reason = "" if enough else (f"only {seen.agreed} of {seen.tried} windows agree" if near >= 0 else
                                    f"only {len(agreeing)} of {len(tried)} small windows agree")
        return replace(seen, evidence=proof, accepted=enough, reason=reason)

    def _refused(self, similarity: Similarity, reason: str, agreed: int = 0, tried: int = 0) -> Registration:
        return Registration(similarity, self._shift(similarity), agreed=agreed, tried=tried, reason=reason)

    def _shift(self, similarity: Similarity) -> tuple[float, float]:
        dx, dy = similarity(self.centre) - self.centre
        return float(dx), float(dy)

    def _turn(self, like: Similarity) -> Similarity:
        """The rotation and scale of `like` about the picture's centre; none if windows match well enough without."""
        if abs(like.rot_deg) < self.limits.straight_deg and abs(like.scale - 1) < self.limits.straight_zoom:
            return IDENTITY
        centre = complex(*self.centre)
        return Similarity(like.factor, centre - like.factor * centre)

    def _coarsely(self, a: Prepared, b: Prepared) -> list[Similarity]:
        """Guesses, original pixels, the better first.

        The first is what most windows vote for with a rotated by one of `turns_deg`. If fewer than `convinced` do, the
        second is the result of another vote with a rotated and scaled by the first, so that more windows match. The
        others are rivals that a good number of windows vote for, as where the scene repeats itself.
        """
        self._measurer = self._reference = None
        measurer = self._make(self.coarse.board, COARSE_SIGMA)
        live = measurer.view(b.coarse)
        best: list[_Vote] = [_Vote(IDENTITY, 1)]
        for rot in self.limits.turns_deg:
            votes = self._ballot(measurer, a, live, self._turn(Similarity.of(rot)))
            if votes and votes[0].count > best[0].count:
                best = votes
            if best[0].count >= self.limits.convinced:
                break
        if best[0].count < 2:
            return []
        guesses = [best[0].similarity]
        if best[0].count < self.limits.convinced:
            turn = self._turn(best[0].similarity)
            again = self._ballot(measurer, a, live, turn, best[0].similarity @ turn.inverse)
            guesses += [v.similarity for v in again[:1] if v.count > best[0].count]
        least = max(self.limits.rival_votes, self.limits.rival_share * best[0].count)
        return guesses + [rival.similarity for rival in best[1:] if rival.count >= least]

    def _ballot(self, measurer: Measurer, a: Prepared, live: View, turn: Similarity,
                onward: Similarity | None = None) -> list[_Vote]:
        """The similarity that most windows of a, warped by `turn`, vote for, and the one that most others vote for; the
        search is everywhere, or around the places that `onward` predicts."""
        width, height = self.coarse.board
        side = min(COARSE_WINDOW, width // 2), min(COARSE_WINDOW, height // 2)
        tolerance = self.limits.coarse_miss * max(self.coarse.factor)
        apart = 0.5 * min(side) * max(self.coarse.factor)
        centres = self._seen(self.coarse, turn, _grid(side, self.coarse.board, COARSE_GRID), side)
        at = centres.astype(np.float64)
        ahead, reach = np.zeros_like(at), self.coarse.board
        if onward is not None:
            ahead, reach = self.coarse.to_board(onward(self.coarse.to_source(at))) - at, (COARSE_REACH, COARSE_REACH)
        view = measurer.view(_warp(a.coarse, self.coarse, turn))
        answers = measurer.measure_windows(view, live, centres, side, ahead, reach, ANYTHING)
        measurer.release(view)
        met = answers.reasons != REASONS.index(Reason.OUTSIDE)
        p = self.coarse.to_source(at[met])
        q = self.coarse.to_source(at[met] + answers.moved[met])
        out = []
        for _ in range(2):
            if len(p) < 2:
                break
            found, agree = vote(p, q, tolerance, self.limits.rot_deg, self.limits.zoom, apart)
            out.append(_Vote(fit(p, q, found, tolerance).similarity @ turn, int(agree.sum())))
            p, q = p[~agree], q[~agree]
        return out

    def _seen(self, level: Fit, turn: Similarity, centres: Centres, side: tuple[int, int]) -> Centres:
        """The centres of those windows of a picture warped by `turn` that lie within the picture."""
        if turn == IDENTITY:
            return centres
        corners = centres[:, None] + np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) * (np.array(side) / 2 + 1)
        back = level.to_board(turn.inverse(level.to_source(corners)))
        return centres[((back >= 0) & (back <= np.array(level.board) - 1)).all(axis=(1, 2))]

    def _warped(self, a: Prepared, turn: Similarity) -> tuple[Measurer, tuple[View, Similarity]]:
        """The measurer of the fine step, and its view of a picture warped by `turn`."""
        measurer, reference = self._measurer or self._make(self.fine.board, self.sigma), self._reference
        if self._measurer is None or reference is None or reference[0] is not a or reference[1] != turn:
            if reference is not None and self._measurer is not None:
                measurer.release(reference[2])
            reference = (a, turn, measurer.view(_warp(a.fine, self.fine, turn)))
        self._measurer, self._reference = measurer, reference
        return measurer, (reference[2], turn)

    def _search(self, measurer: Measurer, view: View, live: View, centres: Centres, onward: Similarity, window: int,
                reach: int, rules: Rules) -> tuple[Floats, Answers]:
        """Centres of windows, and where each is found around the place that `onward` predicts."""
        at = centres.astype(np.float64)
        ahead = self.fine.to_board(onward(self.fine.to_source(at))) - at
        return at, measurer.measure_windows(view, live, centres, (window, window), ahead, (reach, reach), rules)

    def _finely(self, a: Prepared, b: Prepared, guess: Similarity, reach: int) -> Registration:
        measurer, (view, turn) = self._warped(a, self._turn(guess))
        onward = guess @ turn.inverse
        window, centres = self._overlap(onward, turn)
        if len(centres) < 2:
            return self._refused(guess, "hardly any overlap", tried=len(centres))
        live = measurer.view(b.fine)
        at, answers = self._search(measurer, view, live, centres, onward, window, reach, self.limits.rules)
        measurer.release(live)
        tried, keep = (np.flatnonzero(which) for which in (
            answers.reasons != REASONS.index(Reason.TEXTURE), answers.valid))
        if len(keep) < 2:
            return self._refused(guess, f"only {len(keep)} of {len(tried)} windows match", len(keep), len(tried))
        p = self.fine.to_source(at[keep])
        q = self.fine.to_source(at[keep] + answers.moved[keep])
        found = Found(p, q, at[keep], answers.above_chance[keep], above_chance(1.0, window**2, self.sigma), at[tried],
                      window, reach, max(self.fine.factor))
        best, *others = [self._rival(motion, p, answers.score[keep], answers.margin[keep], turn) for motion in
                         motions(found, self.limits.rot_deg, self.limits.zoom, self.limits.evidence)]
        return self._judged(best, len(tried), tuple(others))

    def _judged(self, best: Rival, tried: int, others: tuple[Rival, ...] = ()) -> Registration:
        """A motion as a registration, accepted if there is enough evidence for it."""
        enough = best.agreed >= self.limits.windows and best.evidence >= self.limits.evidence
        reason = "" if enough else f"only {best.agreed} of {tried} windows agree"
        return Registration(best.similarity, self._shift(best.similarity), best.score, best.margin, best.agreed, tried,
                            enough, reason, best.turning, best.middle, best.spread_px, best.rms_px, best.evidence,
                            others)

    def _rival(self, motion: Motion, p: Floats, scores: Floats, margins: Floats, turn: Similarity) -> Rival:
        """A motion of windows at `p` of a picture warped by `turn`, in pixels of the picture itself."""
        agreed = int(motion.agree.sum())
        back = turn.inverse(p[motion.agree]) if agreed else self.centre[None, :]
        middle = back.mean(axis=0)
        return Rival(motion.similarity @ turn, float(np.median(scores[motion.agree])) if agreed else 0.0,
                     float(np.median(margins[motion.agree])) if agreed else 0.0, agreed, motion.turning,
                     (float(middle[0]), float(middle[1])),
                     float(np.sqrt(((back - middle) ** 2).sum(axis=1).mean())), motion.rms_px, motion.evidence)

    def _overlap(self, guess: Similarity, turn: Similarity) -> tuple[int, Centres]:
        """The largest window side, not above the chosen one, of which enough fit the overlap; and their centres."""
        window = self.window
        while True:
            centres = self._inside(guess, turn, window)
            smaller = window * 3 // 4
            if len(centres) >= 6 or smaller < max(24, self.window // 3):
                return window, centres
            window = smaller

    def _inside(self, guess: Similarity, turn: Similarity, window: int, most: int = 24) -> Centres:
        """Centres of windows that lie in a and, by the guess, in b; thinned to about `most`."""
        width, height = self.fine.board
        across, down = (max(1, 1 + math.ceil(2 * (n - window) / window)) for n in (width, height))
        centres = _grid((window, window), (width, height), (across, down))
        ahead = self.fine.to_board(guess(self.fine.to_source(centres.astype(np.float64))))
        room = window / 2 + 2
        inside = np.all((ahead >= room) & (ahead <= np.array([width, height]) - 1 - room), axis=1)
        kept = self._seen(self.fine, turn, centres[inside], (window, window))
        step = max(1, len(kept) / most)
        return kept[[int(i * step) for i in range(int(len(kept) / step))]]


@lru_cache(maxsize=64)
def _grid(window: tuple[int, int], size: tuple[int, int], counts: tuple[int, int]) -> Centres:
    """Centres of a grid of windows that fills a picture, as `Query` takes them; not to be written to."""
    across, down = (np.unique(np.rint(np.linspace(w // 2, n - w + w // 2, k)).astype(np.int64))
                    for w, n, k in zip(window, size, counts, strict=True))
    return np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)


def _warp(picture: Image, level: Fit, turn: Similarity) -> Image:
    """A board's picture warped by a similarity given in original pixels."""
    if turn == IDENTITY:
        return picture
    matrix = turn.matrix
    k = np.array(level.factor)
    corner = (0.5 * k - 0.5)[:, None]
    matrix = np.hstack([matrix[:, :2] * k / k[:, None], (matrix[:, :2] @ corner + matrix[:, 2:] - corner) / k[:, None]])
    return np.asarray(cv2.warpAffine(picture, matrix, level.board, flags=cv2.INTER_LINEAR,
                                     borderMode=cv2.BORDER_REPLICATE), np.uint8)
