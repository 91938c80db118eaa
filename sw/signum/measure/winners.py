# SPDX-License-Identifier: Apache-2.0
"""The best displacement around every pixel, from as many passes of the dense engine as a rectangle of them takes.

Rows of displacements are searched one after another; of equally good ones the first in raster order is the best. A row
that is longer than the engine is searched in parts that share two displacements, so that each but the ends of the whole
row lies between two others in one of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from golden.dense import ABSENT, AGREEMENT, START_RANGE, DensePass
from signum.common.arrays import Floats
from signum.measure.measurer import Measurer, View
from signum.measure.subpixel import leaning_offsets

Whole = NDArray[np.int32]
"""A count or a displacement for each answered pixel, (ny, nx)."""
Flags = NDArray[np.bool_]
NONE = 1 << 20
"""In place of a count that is absent: more than any."""
REACH = START_RANGE[1]
"""Largest displacement across that can be searched for, either way, pixels."""
OVERLAP = 2
"""Displacements that two parts of a row share."""


@dataclass(frozen=True, eq=False)
class Places:
    """The best displacements, at every `step`-th pixel: entry (j, i) is of the window whose last pixel, at the lower
    right, is (i * step, j * step).

    Attributes:
        step: pixels from one entry to the next.
        found: whether any displacement counts.
        dx, dy: the best one, from the first view to the second, pixels right and down; 0 where none counts.
    """

    step: int
    found: Flags
    dx: Whole
    dy: Whole

    def agreeing(self, back: Places) -> Flags:
        """Whether the way back from where each window was found leads to its start, within AGREEMENT pixels each way.

        Args:
            back: the places of the second view's windows in the first, at every pixel.
        """
        y, x = np.indices(self.dx.shape) * self.step
        y, x = (np.clip(at, 0, size - 1) for at, size in zip((y + self.dy, x + self.dx), back.dx.shape, strict=True))
        near = [np.abs(there[y, x] + here) <= AGREEMENT for here, there in ((self.dx, back.dx), (self.dy, back.dy))]
        return np.asarray(self.found & back.found[y, x] & near[0] & near[1])


@dataclass(frozen=True, eq=False)
class Winners(Places):
    """The best displacements, and how the windows match there and nearby. Counts are mismatches; NONE where a
    displacement was not searched or does not count.

    Attributes:
        lean: (3, ny, nx) of the rows above, of, and below the best displacement: how far to the right of it the best of
            that row lies, pixels.
        around: (3, 3, ny, nx) mismatches in these rows, at their best and one pixel to its left and right.
        rest: least mismatches of all others.
        checked: whether the second view's windows find the same, of a search in one pass; None of others.
    """

    lean: Whole
    around: Whole
    rest: Whole
    checked: Flags | None = None

    @property
    def best(self) -> Whole:
        """Mismatches at the best displacement."""
        return np.asarray(self.around[1, 1])

    @property
    def whole(self) -> Flags:
        """Where all that lies around the best displacement was searched."""
        return np.asarray(self.found & (self.around < NONE).all((0, 1)))

    def returned(self, back: Callable[[], Places]) -> Flags:
        """Whether the second view's windows find the same: as the engine found it, or by the places that `back`
        searches for, see `agreeing`."""
        return self.agreeing(back()) if self.checked is None else self.checked

    def fine(self, known: Flags, area: float) -> tuple[Floats, Floats]:
        """The best displacements to a fraction of a pixel, (ny, nx) each, whole where not `known`.

        Args:
            known: some of `whole`.
            area: pixels of a window.
        """
        dx, dy = self.dx.astype(np.float64), self.dy.astype(np.float64)
        offsets = leaning_offsets(area - self.around[:, :, known].transpose(2, 0, 1), self.lean[:, known].T, area)
        dx[known] += offsets[:, 0]
        dy[known] += offsets[:, 1]
        return dx, dy


@dataclass(frozen=True, eq=False)
class _Row:
    """The best of a row of displacements; counts as in `Winners`."""

    dx: Whole
    best: Whole
    left: Whole
    right: Whole
    rest: Whole
    checked: Flags | None

    @classmethod
    def searched(cls, measurer: Measurer, views: tuple[View, View], search: DensePass, step: int) -> _Row:
        found = measurer.dense(*views, search, (step, step))
        best, left, right, rest = (  # the next offset lies to the left
            np.where(c == ABSENT, NONE, c.astype(np.int32)).astype(np.int32)
            for c in (found.best, found.upper, found.lower, found.rest))
        dx = np.where(found.found, -search.start - found.index.astype(np.int32), 0)
        return cls(dx.astype(np.int32), best, left, right, rest, found.agrees)

    def beside(self, dx: Whole) -> Whole:
        """Least mismatches that are known more than a pixel from a displacement."""
        return np.where(np.abs(dx - self.dx) > 1, self.best, self.rest)

    def joined(self, other: _Row) -> _Row:
        """The best of two parts of a row; this one's displacements are to the right of the other's."""
        same = (self.dx == other.dx) & (self.best == other.best)
        takes = np.where(same, self.left == NONE, other.best < self.best)
        dx = np.where(takes, other.dx, self.dx)
        rest = np.minimum(self.beside(dx), other.beside(dx))
        best, left, right = (np.where(takes, b, a) for a, b in (
            (self.best, other.best), (self.left, other.left), (self.right, other.right)))
        return _Row(dx, best, left, right, rest, None)


def search_winners(measurer: Measurer, views: tuple[View, View], window: int, across: tuple[int, int],
                   down: tuple[int, int] = (0, 0), step: int = 1) -> Winners:
    """Find the best displacement of every window of one view in another.

    Args:
        measurer: took both views.
        views: the one whose windows are looked for, and the one that is searched.
        window: side of the windows, pixels, one that the board's engine has.
        across: least and largest displacement to the right, pixels.
        down: least and largest displacement down, pixels.
        step: pixels from one window to the next, across and down.

    Raises:
        BoardError: if the board has no dense engine, or not of this window.
        ValueError: if a displacement across is beyond REACH either way, or no engine has such windows.
    """
    rows = [_search_row(measurer, views, window, across, dy, step) for dy in range(down[0], down[1] + 1)]
    which = np.argmin(np.stack([row.best for row in rows]), 0)
    dx = np.take_along_axis(np.stack([row.dx for row in rows]), which[None], 0)[0]
    lean, rest = np.zeros((3, *which.shape), np.int32), np.full(which.shape, NONE, np.int32)
    around = np.full((3, 3, *which.shape), NONE, np.int32)
    for n, row in enumerate(rows):
        for k in (-1, 0, 1):
            here = which == n - k
            lean[1 + k][here] = (row.dx - dx)[here]
            around[1 + k][:, here] = np.stack([row.left, row.best, row.right])[:, here]
        np.minimum(rest, np.where(np.abs(which - n) <= 1, row.beside(dx), row.best), out=rest)
    found = around[1, 1] < NONE
    return Winners(step, found, np.where(found, dx, 0).astype(np.int32),
                   np.where(found, which + down[0], 0).astype(np.int32), lean, around, rest,
                   rows[0].checked if len(rows) == 1 else None)


def search_places(measurer: Measurer, views: tuple[View, View], window: int, across: tuple[int, int],
                  down: tuple[int, int] = (0, 0), step: int = 1) -> Places:
    """As `search_winners`, without what lies beside the best displacements, which takes less time and memory."""
    best, dx, dy = (np.zeros((1, 1), np.int32) for _ in range(3))
    for k in range(down[0], down[1] + 1):
        row = _search_row(measurer, views, window, across, k, step)
        if k == down[0]:
            best, dx, dy = row.best, row.dx, np.full_like(row.dx, k)
        takes = row.best < best
        best, dx, dy = np.where(takes, row.best, best), np.where(takes, row.dx, dx), np.where(takes, k, dy)
    found = best < NONE
    return Places(step, found, np.where(found, dx, 0), np.where(found, dy, 0).astype(np.int32))


def _search_row(measurer: Measurer, views: tuple[View, View], window: int, across: tuple[int, int], dy: int, step: int
                ) -> _Row:
    start, most = -across[1], max(measurer.dense_offsets, OVERLAP + 1)
    row = None
    while row is None or start <= -across[0] - OVERLAP:
        count = min(most, -across[0] - start + 1)
        part = _Row.searched(measurer, views, DensePass(window, count, start, -dy), step)
        row = part if row is None else row.joined(part)
        start += count - OVERLAP
    return row
