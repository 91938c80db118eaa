# SPDX-License-Identifier: Apache-2.0
"""Registration of two overlapping pictures: rotation, scale and translation, from windows that must agree.

1. Coarse: both pictures are scaled to 160 pixels; a grid of windows, each searched for in the whole other picture,
   votes for a similarity (`geometry.similarity.vote`). With windows of a fifth of the picture, the offset between the
   pictures may be two thirds of a frame.
2. Fine: windows of the chosen size cover the predicted overlap of the pictures at the board's resolution. Each is
   searched for near its predicted place and validated by itself; a similarity is fitted to the valid ones by robust
   least squares.
3. Accepted is a similarity that enough windows agree on, and a good share of all windows that should have: a few wrong
   matches may agree by chance, many never do.

With a good guess (a video), the coarse step is left out. Between the two steps the board changes size: a measurer made
for one of them ends the one before, whose views are dropped with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.geometry.similarity import IDENTITY, Similarity, fit, vote
from signum.measure.measurer import Measurer, Query, View
from signum.measure.validity import Reason, Rules

COARSE_SIDE = 160
"""Longer side of the coarse picture, pixels, unless the shorter one would fall below COARSE_LEAST."""
COARSE_LEAST = 64
COARSE_WINDOW = 32
COARSE_SIGMA = 1.25
COARSE_GRID = (7, 6)
"""Number of coarse windows across and down."""
COARSE_REACH = 20
"""Search range of a second coarse vote around what the first one found, pixels of the coarse picture."""
ANYTHING = Rules(min_score=0.0, min_margin=-1.0, backward=False, texture=False)
"""Rules of the coarse search: every window may vote."""


@dataclass(frozen=True)
class RegistrationLimits:
    """What is searched for and what is accepted.

    Attributes:
        rot_deg: largest rotation between two pictures.
        zoom: largest scale between them.
        turns_deg: rotations of picture a tried in the coarse step, until `convinced` windows agree.
        convinced: number of agreeing coarse windows that ends the coarse step.
        straight_deg: up to this rotation, a is not warped for the next search.
        straight_zoom: up to this change of scale, the same.
        coarse_miss: largest distance of an agreeing window from its place by the similarity, pixels of the coarse
            picture.
        rival_votes: number of coarse windows from which another place is tried too; if both match, neither is accepted.
        rival_share: share of the winning number from which it is tried.
        fine_miss: as `coarse_miss`, of fine windows, as a fraction of their side: relief displaces them.
        windows: least number of agreeing fine windows.
        share: least share of the fine windows in the overlap that must agree. Relief displaces windows of right pairs
            by more than `fine_miss`, down to a share of 0.3; wrong pairs of real surveys stay below 0.15.
        reach: search range around a place predicted from the coarse step, pixels of the board.
        rules: of the fine measurements.
    """

    rot_deg: float = 15.0
    zoom: float = 1.2
    turns_deg: tuple[float, ...] = (0.0, -8.0, 8.0)
    convinced: int = 12
    straight_deg: float = 2.5
    straight_zoom: float = 0.05
    coarse_miss: float = 3.2
    rival_votes: int = 5
    rival_share: float = 0.4
    fine_miss: float = 0.08
    windows: int = 4
    share: float = 0.4
    reach: int = 18
    rules: Rules = field(default_factory=lambda: Rules(min_score=0.6, min_margin=0.01, max_return_px=2.0))


@dataclass(frozen=True)
class Registration:
    """The similarity between two pictures a and b.

    Attributes:
        similarity: pixels of a's original picture -> pixels of b's.
        shift: where a's centre lands in b, minus b's centre, original pixels.
        score: median matching fraction of the agreeing windows, 0 where there are none.
        margin: their median margin.
        agreed: number of fine windows that agree.
        tried: number of all in the predicted overlap.
        accepted: whether to use it.
        reason: why not, one phrase.
        turning: whether rotation and scale were measured, not only the translation.
        middle: centroid of the agreeing windows, original pixels of a; the picture's centre where there are none.
        spread_px: their root-mean-square distance from it, original pixels.
        rms_px: of their distances from their places by the similarity, original pixels.
    """

    similarity: Similarity
    shift: tuple[float, float]
    score: float = 0.0
    margin: float = 0.0
    agreed: int = 0
    tried: int = 0
    accepted: bool = False
    reason: str = ""
    turning: bool = False
    middle: tuple[float, float] = (0.0, 0.0)
    spread_px: float = 0.0
    rms_px: float = 0.0


@dataclass(frozen=True)
class Prepared:
    """A picture at the resolutions of both steps: grey uint8."""

    coarse: Image
    fine: Image

    @property
    def nbytes(self) -> int:
        """Its size in memory, bytes."""
        return self.coarse.nbytes + self.fine.nbytes


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
        """The fine step around a guess and, if it does not succeed, around its own result."""
        result = self._finely(a, b, guess, reach)
        if not result.accepted and result.agreed >= 3:  # with a better rotation, more windows may match
            again = self._finely(a, b, result.similarity, self.limits.reach)
            result = again if again.agreed > result.agreed else result
        return result

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
        side = [min(COARSE_WINDOW, n // 2) for n in self.coarse.board]
        tolerance = self.limits.coarse_miss * max(self.coarse.factor)
        apart = 0.5 * min(side) * max(self.coarse.factor)
        centres = [c for c in _grid(side, self.coarse.board, COARSE_GRID) if self._seen(self.coarse, turn, c, side)]
        at = np.array(centres, np.float64).reshape(-1, 2)
        ahead, reach = np.zeros_like(at), self.coarse.board
        if onward is not None:
            ahead, reach = self.coarse.to_board(onward(self.coarse.to_source(at))) - at, (COARSE_REACH, COARSE_REACH)
        view = measurer.view(_warp(a.coarse, self.coarse, turn))
        answers = measurer.measure([Query(view, live, x, y, side[0], side[1], (float(d[0]), float(d[1])), reach)
                                    for (x, y), d in zip(centres, ahead, strict=True)], ANYTHING)
        measurer.release(view)
        met = [i for i, m in enumerate(answers) if m.reason is not Reason.OUTSIDE]
        p = self.coarse.to_source(at[met].reshape(-1, 2))
        q = self.coarse.to_source(at[met].reshape(-1, 2)
                                  + np.array([[answers[i].dx_px, answers[i].dy_px] for i in met]).reshape(-1, 2))
        out = []
        for _ in range(2):
            if len(p) < 2:
                break
            found, agree = vote(p, q, tolerance, self.limits.rot_deg, self.limits.zoom, apart)
            out.append(_Vote(fit(p, q, found, tolerance).similarity @ turn, int(agree.sum())))
            p, q = p[~agree], q[~agree]
        return out

    def _seen(self, level: Fit, turn: Similarity, centre: tuple[int, int], side: Sequence[int]) -> bool:
        """Whether the window at `centre` of a picture warped by `turn` lies within the picture."""
        if turn == IDENTITY:
            return True
        corners = np.array(centre) + np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) * (np.array(side) / 2 + 1)
        back = level.to_board(turn.inverse(level.to_source(corners)))
        return bool(((back >= 0) & (back <= np.array(level.board) - 1)).all())

    def _finely(self, a: Prepared, b: Prepared, guess: Similarity, reach: int) -> Registration:
        measurer = self._measurer or self._make(self.fine.board, self.sigma)
        turn = self._turn(guess)
        reference = self._reference
        if self._measurer is None or reference is None or reference[0] is not a or reference[1] != turn:
            if reference is not None and self._measurer is not None:
                measurer.release(reference[2])
            reference = (a, turn, measurer.view(_warp(a.fine, self.fine, turn)))
        self._measurer, self._reference = measurer, reference
        onward = guess @ turn.inverse
        window, centres = self._overlap(onward, turn)
        if len(centres) < 2:
            return self._refused(guess, "hardly any overlap", tried=len(centres))
        live = measurer.view(b.fine)
        at = np.array(centres, np.float64)
        ahead = self.fine.to_board(onward(self.fine.to_source(at))) - at
        answers = measurer.measure(
            [Query(reference[2], live, x, y, window, window, (float(d[0]), float(d[1])), (reach, reach))
             for (x, y), d in zip(centres, ahead, strict=True)], self.limits.rules)
        measurer.release(live)
        tried = sum(m.reason is not Reason.TEXTURE for m in answers)
        keep = [i for i, m in enumerate(answers) if m.valid]
        if len(keep) < 2:
            return self._refused(guess, f"only {len(keep)} of {tried} windows match", len(keep), tried)
        p = self.fine.to_source(at[keep])
        q = self.fine.to_source(at[keep] + [[answers[i].dx_px, answers[i].dy_px] for i in keep])
        tolerance = self.limits.fine_miss * window * max(self.fine.factor)
        start, _ = vote(p, q, tolerance, self.limits.rot_deg, self.limits.zoom, 0.75 * window)
        result = fit(p, q, start, tolerance)
        agreeing = [answers[i] for i, good in zip(keep, result.agree, strict=True) if good]
        agreed, reason = len(agreeing), ""
        if agreed < self.limits.windows or agreed < self.limits.share * tried:
            reason = f"only {agreed} of {tried} windows agree"
        similarity = result.similarity @ turn
        back = turn.inverse(p[result.agree]) if agreed else self.centre[None, :]
        middle = back.mean(axis=0)
        return Registration(similarity, self._shift(similarity),
                            float(np.median([m.score for m in agreeing])) if agreeing else 0.0,
                            float(np.median([m.margin for m in agreeing])) if agreeing else 0.0,
                            agreed, tried, not reason, reason, result.turning, (float(middle[0]), float(middle[1])),
                            float(np.sqrt(((back - middle) ** 2).sum(axis=1).mean())), result.rms_px)

    def _overlap(self, guess: Similarity, turn: Similarity) -> tuple[int, list[tuple[int, int]]]:
        """The largest window side, not above the chosen one, of which enough fit the overlap; and their centres."""
        window = self.window
        while True:
            centres = self._inside(guess, turn, window)
            smaller = window * 3 // 4
            if len(centres) >= 6 or smaller < max(24, self.window // 3):
                return window, centres
            window = smaller

    def _inside(self, guess: Similarity, turn: Similarity, window: int) -> list[tuple[int, int]]:
        """Centres of windows that lie in a and, by the guess, in b; thinned to about two dozen."""
        width, height = self.fine.board
        across, down = (max(1, 1 + math.ceil(2 * (n - window) / window)) for n in (width, height))
        centres = _grid([window, window], [width, height], (across, down))
        at = np.array(centres, np.float64)
        ahead = self.fine.to_board(guess(self.fine.to_source(at)))
        room = window / 2 + 2
        inside = np.all((ahead >= room) & (ahead <= np.array([width, height]) - 1 - room), axis=1).tolist()
        kept = [c for c, good in zip(centres, inside, strict=True)
                if good and self._seen(self.fine, turn, c, (window, window))]
        step = max(1, len(kept) / 24)
        return [kept[int(i * step)] for i in range(int(len(kept) / step))]


def _grid(window: Sequence[int], size: Sequence[int], counts: tuple[int, int]) -> list[tuple[int, int]]:
    """Centres of a grid of windows that fills a picture, as `Query` takes them."""
    across, down = (np.unique(np.rint(np.linspace(w // 2, n - w + w // 2, k)).astype(int))
                    for w, n, k in zip(window, size, counts, strict=True))
    return [(int(x), int(y)) for y in down for x in across]


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
