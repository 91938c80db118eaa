# SPDX-License-Identifier: Apache-2.0
"""A reference view as the present camera should see it: warped by the predicted motion, with the windows in sight.

Windows match while they are turned and scaled by little, so the reference's picture is warped and captured again
whenever the motion leaves the last warp by more than the windows bear. Its windows then lie in the live view nearly
where they lie in the warped one, and all of them in the part of the reference that is in sight.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.hold.level_camera import LevelCamera, inverse, moved
from signum.applications.hold.reading import Level
from signum.applications.hold.rivals import Rivals, measure_rivals, measure_twins
from signum.applications.hold.windows import Integers, Windows
from signum.common.arrays import Floats, Image
from signum.measure.measurer import Measurer, View
from signum.measure.validity import Rules

STRAY = 0.03
"""Largest difference in rotation (radians) and scale between the motion and the warp, for the smallest windows; larger
ones bear less, as their corners lie farther out."""
STRAY_PX = 64.0
"""Largest difference in translation, pixels: beyond it, the warp leaves out too much of what is in sight."""
CELL = 8
"""Side of the cells by which overlapping windows are counted, pixels."""
FEW = 20
"""Number of windows below which they are laid closer, so that they overlap."""


class Reference:
    """A picture that live views are measured against.

    Args:
        measurer: at the pictures' size.
        camera: of the pictures.
        view: of the reference; released here, when its warps no longer need it.
        level: of its camera.
        sides: of the windows, pixels; the first is that of `offered`.
        most: largest number of windows of a size.
        rules: of the windows: their likeness to themselves.

    Attributes:
        picture: the reference's own copy.
        offered: number of windows in the whole reference.
    """

    def __init__(self, measurer: Measurer, camera: LevelCamera, view: View, level: Level, sides: tuple[int, ...],
                 most: int, rules: Rules) -> None:
        self._measurer, self._camera, self._rules = measurer, camera, rules
        self.picture: Image = view.picture.copy()
        self.level, self.sides, self.most = level, sides, most
        self._levelling = camera.levelling(level)
        self._view, self._onto = view, np.eye(3)
        self._windows: dict[int, Windows] = {}
        self._rivals: dict[int, Rivals] = {}
        self._twins: Floats | None = None
        whole = self.windows(sides[0])
        self.offered = len(whole.centres)
        self._rivals[sides[0]] = measure_rivals(measurer, whole, rules)

    def release(self) -> None:
        """Release the view."""
        self._measurer.release(self._view)

    def turn_to(self, onto: Floats, side: int) -> Windows:
        """Windows of a view warped about as by `onto` (3, 3): the present view where that is near enough for them."""
        if self._strays(onto, STRAY * self.sides[0] / side):
            self.warp(onto)
        return self.windows(side)

    def warp(self, onto: Floats) -> None:
        """Warp the view by `onto` (3, 3), reference pixels -> live pixels."""
        self._measurer.release(self._view)
        picture = cv2.warpPerspective(self.picture, onto, self._camera.size, flags=cv2.INTER_LINEAR,
                                      borderMode=cv2.BORDER_REPLICATE)
        self._view, self._onto = self._measurer.view(np.asarray(picture, np.uint8)), onto
        self._windows = {}

    def windows(self, side: int) -> Windows:
        """Windows of the present view."""
        if side not in self._windows:
            self._windows[side] = self._laid(self._view, self._onto, side)
        return self._windows[side]

    def rivals(self, side: int) -> Rivals:
        """Of the windows of a size in the whole reference; a free slot is needed at the first call for a size."""
        if side not in self._rivals:
            with self._whole(side) as whole:
                self._rivals[side] = measure_rivals(self._measurer, whole, self._rules)
        return self._rivals[side]

    def twins(self) -> Floats:
        """The displacements (k, 2), pixels, at which the reference looks most like itself, by its largest windows; a
        free slot is needed at the first call."""
        if self._twins is None:
            with self._whole(self.sides[-1]) as whole:
                self._twins = measure_twins(self._measurer, whole)
        return self._twins

    @contextmanager
    def _whole(self, side: int) -> Iterator[Windows]:
        """The windows of the unwarped reference."""
        view = self._measurer.view(self.picture)
        try:
            yield self._laid(view, np.eye(3), side)
        finally:
            self._measurer.release(view)

    def _strays(self, onto: Floats, most: float) -> bool:
        size = np.array(self._camera.size, np.float64)
        probe = self._camera.centre + 0.4 * size * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
        try:
            there = moved(inverse(self._onto), probe)
        except np.linalg.LinAlgError:
            return True
        off = moved(onto, there) - probe
        arm = 0.4 * size[[0, 0, 1, 1]]
        return bool(np.hypot(*off[0]) > STRAY_PX or (np.hypot(*(off[1:] - off[0]).T) > most * arm).any())

    def _laid(self, view: View, onto: Floats, side: int) -> Windows:
        for step in range(side, side // 2 - 1, -max(1, side // 16)):
            centres = self._places(onto, side, step)
            if len(centres) >= FEW:
                break
        if len(centres):
            likeness = np.array(self._measurer.likeness(view, [(x, y, side, side) for x, y in centres.tolist()]))
            order = np.argsort(likeness, kind="stable")
            order = order[likeness[order] <= self._rules.max_likeness]
            centres = centres[_spread(order, centres, self.most)]
        back = moved(inverse(onto), centres.astype(np.float64).reshape(-1, 2))
        return Windows(view, onto, side, centres, moved(self._levelling, back), self._independent(centres, side))

    def _independent(self, centres: Integers, side: int) -> float:
        """Area that windows cover together, over the sum of their areas."""
        cover = np.zeros(-(-np.array(self._camera.size[::-1]) // CELL), np.bool_)
        cells = max(1, side // CELL)
        for x, y in ((centres - side // 2) // CELL).tolist():
            cover[y:y + cells, x:x + cells] = True
        return float(cover.sum()) / max(1, len(centres) * cells * cells)

    def _places(self, onto: Floats, side: int, step: int) -> Integers:
        """Centres (n, 2) of a grid of windows, `step` pixels apart or more, that lie wholly in what the warped view
        has of the reference."""
        width, height = self._camera.size
        margin = width // 160  # the filter's own reach makes signs at the reference's border uncertain
        frame = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]], np.float64)
        seen = moved(onto, frame)
        low = np.maximum(np.floor(seen.min(axis=0)), 0).astype(int)
        high = np.minimum(np.ceil(seen.max(axis=0)), [width - 1, height - 1]).astype(int)
        half, lines = side // 2, []
        for a, b in zip(low.tolist(), high.tolist(), strict=True):
            first, last = a + half + margin, b - half - margin + 1
            if last < first:
                return np.zeros((0, 2), np.int64)
            count = 1 + (last - first) // step
            lines.append(np.unique(np.rint(np.linspace(first, last, count)).astype(int)) if count > 1
                         else np.array([(first + last) // 2]))
        x, y = np.meshgrid(*lines)
        centres = np.stack([x.reshape(-1), y.reshape(-1)], axis=1)
        corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (half + margin / 2)
        back = moved(inverse(onto), (centres[:, None, :] + corner).reshape(-1, 2)).reshape(-1, 4, 2)
        inside = ((back >= -0.5) & (back <= np.array([width, height]) - 0.5)).all(axis=(1, 2))
        return centres[inside]


def _spread(order: NDArray[np.intp], places: Integers, count: int) -> NDArray[np.intp]:
    """The first of `order`, then repeatedly that of the better three quarters farthest from those chosen."""
    pool = order[:max(count, (len(order) * 3) // 4)]
    if not len(pool):
        return pool
    at = places[pool].astype(np.float64)
    chosen, nearest = [0], np.hypot(*(at - at[0]).T)
    while len(chosen) < min(count, len(pool)):
        chosen.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, np.hypot(*(at - at[chosen[-1]]).T))
    return pool[chosen]

