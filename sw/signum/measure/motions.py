# SPDX-License-Identifier: Apache-2.0
"""The motions that many windows side by side have, where the background rests.

Under snow and on outlines a window may be found anywhere, but hardly where those beside it are. Windows that move by
themselves are joined with neighbours that move alike. The largest such group gives a similarity; what agrees with it is
set aside, and the next group is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from signum.common.arrays import Floats
from signum.geometry.similarity import Similarity, fit

Flags = NDArray[np.bool_]
ROUNDS = 2
"""Times that a motion is fitted again to all windows that agree with it, wherever they are."""


@dataclass(frozen=True, eq=False)
class Residuals:
    """Windows on a grid (ny, nx), and their displacements against the background, pixels.

    Attributes:
        at: (ny, nx, 2) x and y of their middles, whole pixels.
        moved: (ny, nx, 2) displacements right and down; NaN where not known.
        own: (ny, nx) which of them surely move by themselves.
    """

    at: NDArray[np.intp]
    moved: Floats
    own: Flags

    def like(self, motion: Similarity, like_px: float) -> Flags:
        """Which windows have a motion, within `like_px`."""
        return np.asarray(np.linalg.norm(motion(self.at.astype(np.float64)) - self.at - self.moved, axis=-1) <= like_px)

    def pairs(self, which: Flags) -> tuple[Floats, Floats]:
        """Where some of the windows are and where they move to, (n, 2) each."""
        return self.at[which].astype(np.float64), self.at[which] + self.moved[which]

    def groups(self, like_px: float) -> NDArray[np.intp]:
        """Number of each window's group: windows that move by themselves are in one with those to the left and right,
        above and below that move alike, within `like_px`."""
        number, ends = np.arange(self.own.size).reshape(self.own.shape), []
        for one, other in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
            apart = np.linalg.norm(self.moved[one] - self.moved[other], axis=-1)
            alike = self.own[one] & self.own[other] & (apart <= like_px)
            ends.append((number[one][alike], number[other][alike]))
        rows, columns = (np.concatenate(of) for of in zip(*ends, strict=True))
        graph = coo_array((np.ones(rows.size, bool), (rows, columns)), shape=(self.own.size, self.own.size))
        return np.asarray(connected_components(graph, directed=False)[1].reshape(self.own.shape), np.intp)


def find_motions(windows: Residuals, fewest: int, like_px: float, most: int, known: Sequence[Similarity] = ()
                 ) -> list[Similarity]:
    """The motions of their own that windows have, that of the largest group first.

    Args:
        windows: what was measured.
        fewest: windows of a group that counts.
        like_px: largest difference of neighbours that move alike; motions twice as far apart are the same.
        most: motions that are told apart.
        known: motions that are not looked for again.

    Returns:
        Similarities, from where something is to where it is against the background; translations where the windows are
        too few to show a rotation.
    """
    left = windows.own.copy()
    for motion in known:
        left &= ~windows.like(motion, 2 * like_px)
    found: list[Similarity] = []
    groups = windows.groups(like_px)
    while len(found) < most and left.any():
        sizes = np.bincount(groups[left])
        if sizes.max() < fewest:
            break
        mine = left & (groups == sizes.argmax())
        p, q = windows.pairs(mine)
        motion = Similarity(shift=complex(*np.median(q - p, 0)))
        for among in (mine, *(None,) * ROUNDS):
            pairs = windows.pairs(windows.own & windows.like(motion, 2 * like_px) if among is None else among)
            motion = fit(*pairs, motion, 3 * like_px).similarity
        found.append(motion)
        left &= ~mine & ~windows.like(motion, 2 * like_px)
    return found
