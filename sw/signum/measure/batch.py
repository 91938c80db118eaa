# SPDX-License-Identifier: Apache-2.0
"""Searches and their peaks as arrays, without an object for each: what `Measurer` works on inside.

Pixels are those of the board's picture; x to the right, y down.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.correlate import CHANCE_DEVIATION, Status
from golden.params import NO_SCORE
from golden.tables import JOB_FIELDS, SCORES, IntTable
from signum.common.arrays import Floats
from signum.measure.subpixel import CONE_FROM, PeakFit, line_offsets, peak_offsets

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
_FAR = 1 << 20
"""More than any picture's side: a guess beyond it is as good as this one."""


@dataclass(frozen=True, eq=False)
class Searches:
    """n windows and where each is searched for.

    Attributes:
        slots: (n, 2) slots of the reference and of the live view.
        centre: (n, 2) centre of the window in the reference, as `Query` takes it.
        size: (n, 2) width and height.
        guess: (n, 2) expected displacement, whole pixels.
        reach: (n, 2) range around it.
    """

    slots: Integers
    centre: Integers
    size: Integers
    guess: Integers
    reach: Integers

    @classmethod
    def of(cls, whole: Integers, guesses: Floats) -> Searches:
        """Searches from (n, 8) slots, centre, size, reach, and (n, 2) guesses.

        Raises:
            ValueError: if a guess is not a number.
        """
        if np.isnan(guesses).any():
            raise ValueError("a guessed displacement is not a number")
        guess = np.rint(np.clip(guesses, -_FAR, _FAR)).astype(np.int64)
        return cls(whole[:, :2], whole[:, 2:4], whole[:, 4:6], guess, whole[:, 6:8])

    def some(self, which: NDArray[np.intp]) -> Searches:
        """The searches of these numbers."""
        return Searches(self.slots[which], self.centre[which], self.size[which], self.guess[which], self.reach[which])

    @property
    def windows(self) -> list[tuple[int, ...]]:
        """Of each search: its window's centre, width, height; and 1 or 0, whether it is across and down."""
        return list(map(tuple, np.hstack([self.centre, self.size, self.reach > 0]).tolist()))

    def back(self, moved: Floats) -> Searches:
        """The searches from the places found, displaced by `moved` (n, 2), back to the start, over the same range."""
        whole = np.rint(moved).astype(np.int64)
        return Searches(self.slots[:, ::-1], self.centre + whole, self.size, -whole, self.reach)

    def jobs(self, picture: tuple[int, int]) -> tuple[IntTable, NDArray[np.intp]]:
        """Jobs with the search ranges clipped to the picture (width, height), and the numbers of the searches that they
        answer: nothing is left of the others."""
        room = np.array(picture)
        corner = self.centre - self.size // 2
        low = np.maximum(corner + self.guess - self.reach, 0)
        high = np.minimum(corner + self.guess + self.reach, room - self.size)
        inside = (corner >= 0).all(axis=1) & (corner + self.size <= room).all(axis=1)
        which = np.flatnonzero(inside & (low <= high).all(axis=1))
        parts = (self.slots[:, :1], corner, self.size, self.slots[:, 1:], low, high - low + 1)
        return np.hstack(parts)[which].astype(np.int32).reshape(-1, len(JOB_FIELDS)), which


@dataclass(frozen=True, eq=False)
class Peaks:
    """The peaks of n jobs: each array has the (n,) values of the attribute of `Peak` of its name.

    `status` has numbers of `Status`; where one is not OK, the rest is 0.
    """

    status: Integers
    dx: Floats
    dy: Floats
    score: Floats
    margin: Floats
    inside: Flags
    above_chance: Floats

    @classmethod
    def of(cls, jobs: IntTable, results: IntTable, sigma: float, fit: PeakFit = "auto") -> Peaks:
        """The peaks of a table of jobs from the table of their results; otherwise as `locate_peaks`."""
        status = results[:, 0].astype(np.int64)
        ok = status == Status.OK
        scores = results[:, SCORES:].astype(np.float64)
        area = jobs[:, 3].astype(np.float64) * jobs[:, 4]
        area[~ok] = 1.0
        score = scores[:, 0] / area
        runner_up = np.where(results[:, -1] == NO_SCORE, 0.5, scores[:, -1] / area)
        best, searched = results[:, 1:3], jobs[:, 8:10]
        inside = (((best > 0) & (best < searched - 1)) | (searched == 1)).all(axis=1)
        moved = jobs[:, 6:8] + best - jobs[:, 1:3] + _offsets(scores[:, :9], area, ok, fit)
        chance = (2 * score - 1) * np.sqrt(area) / (CHANCE_DEVIATION * sigma)
        dx, dy, score, margin, chance = (np.where(ok, values, 0.0) for values in (
            moved[:, 0], moved[:, 1], score, score - runner_up, chance))
        return cls(status, dx, dy, score, margin, inside & ok, chance)


def _offsets(scores: Floats, area: Floats, ok: Flags, fit: PeakFit) -> Floats:
    """Sub-pixel offsets (n, 2) from the best score and its neighbours, (n, 9); where some neighbours are absent, from
    those left and right, above and below."""
    patches = scores[:, [1, 2, 3, 4, 0, 5, 6, 7, 8]]
    whole = ok & (patches != NO_SCORE).all(axis=1)
    offsets = np.zeros((len(scores), 2))
    offsets[whole] = peak_offsets(patches[whole].reshape(-1, 3, 3), area[whole], fit)
    rest = np.flatnonzero(ok & ~whole)
    before, after = patches[rest][:, [3, 1]], patches[rest][:, [5, 7]]
    size = area[rest, None]
    best = np.broadcast_to(scores[rest, :1] / size, before.shape)
    sharp = np.full(best.shape, fit == "cone") if fit != "auto" else best >= CONE_FROM
    along = line_offsets(before / size, best, after / size, sharp)
    offsets[rest] = np.where((before != NO_SCORE) & (after != NO_SCORE), along, 0.0)
    return offsets
