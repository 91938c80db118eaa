# SPDX-License-Identifier: Apache-2.0
"""The best displacements of rectangles against every count of every displacement, in one pass a row and in parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from golden.correlate import Plane
from golden.dense import ABSENT, DensePass, volume
from golden.params import TINY_DENSE
from signum.boards.golden import GoldenBoard
from signum.measure.measurer import Measurer, View
from signum.measure.winners import NONE, search_places, search_winners

SIZE = (40, 30)
ACROSS, DOWN = (-9, 7), (-2, 3)


def _taken(offsets: int) -> tuple[Measurer, tuple[View, View]]:
    """A measurer of an engine with so many offsets, with two frames, of which the second is moved by (-4, 2) px."""
    scene = np.random.default_rng(2).integers(0, 256, SIZE[::-1], dtype=np.uint8)
    measurer = Measurer(GoldenBoard(replace(TINY_DENSE, dense_offsets=offsets)), SIZE, 1.0)
    return measurer, measurer.pair(scene, np.roll(scene, (2, -4), (0, 1)))


def _counts(first: Plane, second: Plane) -> np.ndarray:
    """Mismatches of every displacement, (down, across, H, W), across from the largest to the least: raster order of the
    engine's offsets; NONE where one does not count."""
    rows = [volume(first, second, DensePass(8, ACROSS[1] - ACROSS[0] + 1, -ACROSS[1], -dy))
            for dy in range(DOWN[0], DOWN[1] + 1)]
    counts = np.stack(rows).astype(int).transpose(0, 3, 1, 2)
    return np.where(counts == ABSENT, NONE, counts)


@pytest.mark.parametrize("offsets", [24, 8])
@pytest.mark.parametrize("step", [1, 3])
def test_every_window_as_counted(offsets: int, step: int) -> None:
    measurer, views = _taken(offsets)
    found = search_winners(measurer, views, 8, ACROSS, DOWN, step)
    counts = _counts(*(measurer.signs(view) for view in views))[:, :, ::step, ::step]
    places = search_places(measurer, views, 8, ACROSS, DOWN, step)
    for name in ("found", "dx", "dy"):
        assert np.array_equal(getattr(places, name), getattr(found, name))
    for y, x in np.ndindex(found.dx.shape):
        here = counts[:, :, y, x]
        row, column = divmod(int(np.argmin(here)), here.shape[1])
        assert found.found[y, x] == (here.min() < NONE)
        if not found.found[y, x]:
            continue
        assert (found.dx[y, x], found.dy[y, x]) == (ACROSS[1] - column, DOWN[0] + row)
        assert found.best[y, x] == here.min()
        around = found.around[1, :, y, x]
        assert around[0] == (here[row, column + 1] if column + 1 < here.shape[1] else NONE)
        assert around[2] == (here[row, column - 1] if column else NONE)
        for k in (-1, 1):
            if 0 <= row + k < len(here) and (here[row + k] < NONE).any():
                best = int(np.argmin(here[row + k]))
                assert (found.lean[1 + k, y, x], found.around[1 + k, 1, y, x]) == (column - best, here[row + k, best])
            else:
                assert found.around[1 + k, 1, y, x] == NONE


def test_rest_of_a_row_and_the_engines_own_check() -> None:
    measurer, views = _taken(24)
    found = search_winners(measurer, views, 8, ACROSS, (2, 2))
    counts = _counts(*(measurer.signs(view) for view in views))[4]
    for y, x in np.argwhere(found.found):
        others = np.abs(ACROSS[1] - np.arange(len(counts)) - found.dx[y, x]) > 1
        assert found.rest[y, x] == counts[others, y, x].min()
    back = search_places(measurer, views[::-1], 8, (-ACROSS[1], -ACROSS[0]), (-2, -2))
    agreed = found.returned(lambda: pytest.fail("the engine has checked"))
    assert (agreed == found.agreeing(back)).mean() > 0.99  # of equals each view takes the first
    assert (found.dx[agreed] == -4).mean() > 0.9


def test_rows_in_parts_are_checked_by_the_way_back() -> None:
    measurer, views = _taken(8)
    found = search_winners(measurer, views, 8, ACROSS, DOWN)
    back = search_places(measurer, views[::-1], 8, (-ACROSS[1], -ACROSS[0]), (-DOWN[1], -DOWN[0]))
    agreed = found.returned(lambda: back)
    assert agreed.mean() > 0.3 and (found.dx[agreed] == -4).mean() > 0.95 and (found.dy[agreed] == 2).mean() > 0.95
