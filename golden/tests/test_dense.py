# SPDX-License-Identifier: Apache-2.0
"""The dense search against counting by hand, and the properties that follow from its definition."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from golden.correlate import Plane
from golden.dense import ABSENT, DenseMap, DensePass, dense, volume

SIZE = (21, 30)
"""(height, width) of the planes."""


def planes(seed: int, density: float = 0.5, shape: tuple[int, int] = SIZE) -> tuple[Plane, Plane]:
    """Two random planes with long equal parts, so that small numbers of mismatches and ties occur."""
    rng = np.random.default_rng(seed)
    left = (rng.random(shape) < density).astype(np.uint8)
    noise = (rng.random(shape) < 0.1).astype(np.uint8)
    return left, np.roll(left, (int(rng.integers(-2, 3)), int(rng.integers(-4, 5))), (0, 1)) ^ noise


def by_hand(left: Plane, right: Plane, one: DensePass) -> DenseMap:
    """The map, pixel by pixel from the definition."""
    shape, side = left.shape, one.window
    out = {name: np.full(shape, ABSENT, np.int16) for name in ("index", "best", "lower", "upper", "rest", "back")}
    found: dict[tuple[int, int], dict[int, int]] = {}
    back: dict[tuple[int, int], dict[int, int]] = {}
    for y, x in itertools.product(range(side - 1, shape[0]), range(side - 1, shape[1])):
        for k in range(one.offsets):
            v, u = y - one.down, x - one.start - k
            if side - 1 <= v < shape[0] and side - 1 <= u < shape[1]:
                count = int((left[y - side + 1:y + 1, x - side + 1:x + 1]
                             ^ right[v - side + 1:v + 1, u - side + 1:u + 1]).sum())
                found.setdefault((y, x), {})[k] = back.setdefault((v, u), {})[k] = count
    for (y, x), counts in found.items():
        k = min(counts, key=lambda n: (counts[n], n))
        theirs = back[y - one.down, x - one.start - k]
        rest = [m for n, m in counts.items() if abs(n - k) > 1]
        values = (k, counts[k], counts.get(k - 1, ABSENT), counts.get(k + 1, ABSENT), min(rest, default=ABSENT),
                  min(theirs, key=lambda n: (theirs[n], n)))
        for name, value in zip(out, values, strict=True):
            out[name][y, x] = value
    return DenseMap(**out)


def same(one: DenseMap, other: DenseMap) -> None:
    """Both maps are equal, field by field."""
    for name in vars(one):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


@pytest.mark.parametrize("density", [0.5, 0.02])
@pytest.mark.parametrize(("window", "offsets", "start", "down"), [
    (8, 9, 0, 0), (8, 1, 0, 0), (8, 2, -1, 0), (8, 9, -4, 2), (8, 5, 3, -3), (16, 7, -3, 1), (8, 12, 11, 0),
    (8, 6, -20, 0), (8, 4, 0, 13), (8, 4, 0, -14), (16, 3, 30, 0), (32, 4, 0, 0)])
def test_every_field_as_counted_by_hand(window: int, offsets: int, start: int, down: int, density: float) -> None:
    one = DensePass(window, offsets, start, down)
    left, right = planes(offsets, density)
    same(dense(left, right, one), by_hand(left, right, one))


@given(st.integers(0, 1000), st.integers(1, 10), st.integers(-6, 6), st.integers(-4, 4))
@settings(max_examples=25, deadline=None)
def test_properties(seed: int, offsets: int, start: int, down: int) -> None:
    """Negating both planes changes nothing; negating one turns every count round; a crop keeps what lies inside."""
    one = DensePass(8, offsets, start, down)
    left, right = planes(seed)
    same(dense(1 - left, 1 - right, one), dense(left, right, one))
    counts, turned = volume(left, right, one), volume(1 - left, right, one)
    assert np.array_equal(turned[counts != ABSENT], one.window**2 - counts[counts != ABSENT])
    cropped = volume(left[2:], right[2:], one)
    assert np.array_equal(cropped[cropped != ABSENT], counts[2:][cropped != ABSENT])


@given(st.integers(0, 1000), st.integers(1, 10), st.integers(-6, 6), st.integers(-4, 4))
@settings(max_examples=25, deadline=None)
def test_swapped_planes_mirror_the_offsets(seed: int, offsets: int, start: int, down: int) -> None:
    """With the planes exchanged, offset k of one pass is offset -k of the other, at the pixel it leads to."""
    left, right = planes(seed)
    one = DensePass(8, offsets, start, down)
    other = DensePass(8, offsets, -(start + offsets - 1), -down)
    there, back = volume(left, right, one), volume(right, left, other)
    for y, x, k in np.argwhere(there != ABSENT):
        assert back[y - down, x - start - k, offsets - 1 - k] == there[y, x, k]


@pytest.mark.parametrize("shift", [0, 3, 8])
def test_a_shifted_picture_is_found(shift: int) -> None:
    """Where the right plane is the left one moved to the left by `shift`, the winner is `shift`, with no mismatch."""
    left = (np.random.default_rng(shift).random(SIZE) < 0.5).astype(np.uint8)
    found = dense(left, np.roll(left, -shift, 1), DensePass(8, 9))
    seen = found.index[7:, 7 + 8:]
    assert (seen == shift).all() and not found.best[7:, 15:].any() and found.agrees[7:, 15:].all()


def test_the_first_of_equals_wins() -> None:
    """On plain planes every offset has no mismatch: the first that counts wins, and all others equal it."""
    plain = np.zeros(SIZE, np.uint8)
    found = dense(plain, plain, DensePass(8, 6, -2))
    inside = found.index[7:, 7:]
    assert (inside[:, :-2] == 0).all() and (inside[:, -2] == 1).all() and (inside[:, -1] == 2).all()
    assert not found.rest[7:, 12:-3].any() and (found.lower[7:, 7:-2] == ABSENT).all()


@pytest.mark.parametrize(("values", "message"), [
    ((12, 4), "window is 12"), ((8, 0), "offsets is 0"), ((8, 257), "offsets is 257"), ((8, 4, 512), "start is 512"),
    ((8, 4, 0, -513), "down is -513"), ((8, 7.5), "offsets is 7.5: must be a whole number"),
    ((8, 4, -2.5), "start is -2.5")])
def test_what_no_engine_takes_is_refused(values: tuple[float, ...], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DensePass(*values)  # type: ignore[arg-type]


def test_planes_of_unequal_sizes_are_refused() -> None:
    with pytest.raises(ValueError, match="unequal sizes"):
        dense(np.zeros((9, 9), np.uint8), np.zeros((9, 10), np.uint8), DensePass(8, 1))
