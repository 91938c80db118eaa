# SPDX-License-Identifier: Apache-2.0
"""Frame-level dense search: for every pixel the best of a row of offsets, bit for bit.

The window of a pixel (x, y) is the `window` x `window` square of which it is the last pixel, at the lower right. Offset
k lays the window of the left plane over that of the right plane `start` + k to its left and `down` above it:

    M(x, y, k) = sum over i, j < window of L(x - i, y - j) ^ R(x - start - k - i, y - down - j)

is the number of mismatches, 0 for equal windows. An offset counts at a pixel where both windows lie within their
planes. Of equal numbers the first offset is the best.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from golden.correlate import Plane
from golden.numbers import whole

WINDOWS = (2, 4, 8, 16, 32)
"""Sides of the windows that an engine may be built with, pixels; the configuration says which it has."""
ABSENT = -1
"""In a map: no offset counts at that place."""
START_RANGE = -512, 511
"""Range of the first offset, and of the rows between the planes."""
MAX_OFFSETS = 256
"""Most offsets of one pass on any engine."""
AGREEMENT = 1
"""Largest difference of the two planes' winners that agree, offsets."""

Counts = npt.NDArray[np.int16]
"""A value for each pixel, int16 (H, W)."""


@dataclass(frozen=True)
class DensePass:
    """What one pass of the engine searches for. Lengths in pixels.

    Attributes:
        window: side of the window.
        offsets: number of offsets, side by side.
        start: the first of them: how far to the left in the right plane; negative to the right.
        down: rows between the planes: how far up in the right plane; negative down.

    Raises:
        ValueError: if a number is not whole or out of range.
    """

    window: int
    offsets: int
    start: int = 0
    down: int = 0

    def __post_init__(self) -> None:
        if self.window not in WINDOWS:
            raise ValueError(f"window is {self.window!r}: must be one of {', '.join(map(str, WINDOWS))}")
        for name, low, top in (("window", 1, WINDOWS[-1]), ("offsets", 1, MAX_OFFSETS), ("start", *START_RANGE),
                               ("down", *START_RANGE)):
            object.__setattr__(self, name, whole(name, getattr(self, name), low, top))


@dataclass(frozen=True)
class DenseMap:
    """The winners of a pass, for every pixel of the left plane; int16 (H, W) each, ABSENT where there is none.

    Attributes:
        index: the best offset's number k.
        best: mismatches there, 0..window**2.
        lower, upper: mismatches at offsets k - 1 and k + 1.
        rest: least mismatches of the offsets that are neither.
        back: of the pixel of the right plane that the best offset leads to, the number of its own best offset.
    """

    index: Counts
    best: Counts
    lower: Counts
    upper: Counts
    rest: Counts
    back: Counts

    @property
    def agrees(self) -> npt.NDArray[np.bool_]:
        """Whether left and right winner agree within AGREEMENT, bool (H, W)."""
        return np.asarray((self.index != ABSENT) & (np.abs(self.back - self.index) <= AGREEMENT))


def counting(shape: tuple[int, int], one: DensePass, k: int) -> tuple[slice, slice]:
    """Rows and columns of the left plane's pixels at which offset `k` counts; planes are of `shape` (H, W)."""
    bounds = []
    for size, shift in zip(shape, (one.down, one.start + k), strict=True):
        first = one.window - 1 + max(shift, 0)
        bounds.append(slice(min(first, size), max(size + min(shift, 0), min(first, size))))
    return bounds[0], bounds[1]


def mismatches(left: Plane, right: Plane, one: DensePass, k: int) -> npt.NDArray[np.int32]:
    """Mismatches of offset `k` at the pixels where it counts, int32; see `counting` for which these are."""
    rows, columns = counting(left.shape, one, k)
    if rows.start == rows.stop or columns.start == columns.stop:
        return np.zeros((rows.stop - rows.start, columns.stop - columns.start), np.int32)
    side, shift = one.window, one.start + k
    over = left[rows.start - side + 1:rows.stop, columns.start - side + 1:columns.stop]
    under = right[rows.start - side + 1 - one.down:rows.stop - one.down,
                  columns.start - side + 1 - shift:columns.stop - shift]
    sums = cv2.boxFilter(over ^ under, cv2.CV_32S, (side, side), anchor=(side - 1, side - 1), normalize=False,
                         borderType=cv2.BORDER_CONSTANT)
    return np.asarray(sums[side - 1:, side - 1:], np.int32)


def volume(left: Plane, right: Plane, one: DensePass) -> Counts:
    """Mismatches of every pixel and offset, int16 (H, W, offsets); ABSENT where an offset does not count."""
    out = np.full((*left.shape, one.offsets), ABSENT, np.int16)
    for k in range(one.offsets):
        out[(*counting(left.shape, one, k), k)] = mismatches(left, right, one, k)
    return out


def dense(left: Plane, right: Plane, one: DensePass) -> DenseMap:
    """The winners of a pass.

    Args:
        left: plane whose pixels the map has, uint8 0/1, (H, W).
        right: plane that is searched, of the same size.
        one: what is searched for.

    Raises:
        ValueError: if the planes are not of one size.
    """
    if left.shape != right.shape:
        raise ValueError(f"planes of unequal sizes: {left.shape} and {right.shape}")
    far = one.window**2 + 1
    best, lower, upper, rest = (np.full(left.shape, far, np.int16) for _ in range(4))
    index = np.full(left.shape, ABSENT, np.int16)
    ours, theirs = np.full(left.shape, far, np.int16), np.full(left.shape, ABSENT, np.int16)
    last, earlier = np.full(left.shape, far, np.int16), np.full(left.shape, far, np.int16)
    for k in range(one.offsets):
        now = np.full(left.shape, far, np.int16)
        place = counting(left.shape, one, k)
        now[place] = mismatches(left, right, one, k)
        takes, fresh = now < best, index == k - 1
        fresh &= index != ABSENT
        upper[~takes & fresh] = now[~takes & fresh]
        np.minimum(rest, now, out=rest, where=~takes & ~fresh)
        lower[takes], upper[takes], rest[takes] = last[takes], far, earlier[takes]
        earlier, last = best.copy(), now
        best[takes], index[takes] = now[takes], k
        _take_right(ours, theirs, now[place], place, one, k)
    back = np.full(left.shape, ABSENT, np.int16)
    y, x = np.nonzero(index != ABSENT)
    back[y, x] = theirs[y - one.down, x - one.start - index[y, x]]
    for counts in (best, lower, upper, rest):
        counts[counts == far] = ABSENT
    return DenseMap(index, best, lower, upper, rest, back)


def _take_right(best: Counts, index: Counts, now: Counts, place: tuple[slice, slice], one: DensePass, k: int) -> None:
    """Let the right plane's pixels choose between their best offset so far and offset `k`."""
    rows, columns = place
    there = (slice(rows.start - one.down, rows.stop - one.down),
             slice(columns.start - one.start - k, columns.stop - one.start - k))
    if not now.size:
        return
    takes = now < best[there]
    best[there][takes] = now[takes]
    index[there][takes] = k
