# SPDX-License-Identifier: Apache-2.0
"""A reference view as the present camera should see it: warped by the predicted motion, with the windows in sight.

Windows match while they are turned and scaled by little, so the reference's picture is warped and captured again
whenever the motion leaves the last warp by more than the windows bear. Its windows then lie in the live view nearly
where they lie in the warped one, and all of them in the part of the reference that is in sight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.hold.level_camera import LevelCamera, inverse, moved
from signum.applications.hold.reading import Level
from signum.common.arrays import Floats, Image
from signum.measure.measurer import Measurer, Query, View
from signum.measure.validity import Rules

Integers = NDArray[np.int64]
STRAY = 0.03
"""Largest difference in rotation (radians) and scale between the motion and the warp."""
STRAY_PX = 64.0
"""Largest difference in translation, pixels: beyond it, the warp leaves out too much of what is in sight."""
CELL = 8
"""Side of the cells by which overlapping windows are counted, pixels."""
LEAST_PASSING = 0.01
"""Lower bound of the probability of a score elsewhere: no more than a hundred places of a reference are tried."""
LEAST_DEVIATION = 0.01
"""Lower bound of the deviation of scores elsewhere: that of a few windows may be small by chance."""
FEW = 20
"""Number of windows below which they are laid closer, so that they overlap."""


@dataclass(frozen=True, eq=False)
class Warped:
    """A warped reference view.

    Attributes:
        view: on the board.
        onto: homography (3, 3) from the reference's pixels to the view's.
        centres: (n, 2) int, of the windows.
        anchors: (n, 2) level pixels of the reference that they show.
        share: of the windows that are independent, as they overlap where few fit.
    """

    view: View
    onto: Floats
    centres: Integers
    anchors: Floats
    share: float

    def first(self, count: int) -> Warped:
        """With the first `count` of its windows only; they are spread over what is in sight."""
        return replace(self, centres=self.centres[:count], anchors=self.anchors[:count])


class Rivals(NamedTuple):
    """What the reference's own windows score at other places of it: what a wrong place of such a floor scores.

    Attributes:
        valid: share of the windows whose measurement there is valid.
        mean: over the windows, of the best score of each; deviation: their standard deviation.
    """

    valid: float
    mean: float
    deviation: float

    def passing(self, score: float) -> float:
        """Probability that a window's measurement elsewhere is valid and scores as well, as far as these show."""
        deviations = (score - self.mean) / self.deviation
        return self.valid * max(LEAST_PASSING, 0.5 * math.erfc(deviations / math.sqrt(2)))

    def exceeded_by(self, scores: Floats, deviations: float) -> bool:
        """Whether scores (n,) of windows at one place exceed these by as many standard errors of their mean."""
        return bool(scores.mean() - self.mean > deviations * self.deviation / math.sqrt(len(scores)))


class Reference:
    """A picture that live views are measured against.

    Args:
        measurer: at the pictures' size.
        camera: of the pictures.
        view: of the reference; released here, when its warps no longer need it.
        level: of its camera.
        window: side of the windows, pixels.
        most: largest number of windows.
        rules: of the windows: their likeness to themselves.

    Attributes:
        picture: the reference's own copy.
        offered: number of windows in the whole reference.
        rivals: of the whole reference.
    """

    def __init__(self, measurer: Measurer, camera: LevelCamera, view: View, level: Level, window: int, most: int,
                 rules: Rules) -> None:
        self._measurer, self._camera, self._rules = measurer, camera, rules
        self.picture: Image = view.picture.copy()
        self.level, self.window, self.most = level, window, most
        self._levelling = camera.levelling(level)
        self.warped = self._prepared(view, np.eye(3))
        self.offered = len(self.warped.centres)
        self.rivals = self._rivals()

    def release(self) -> None:
        """Release the view."""
        self._measurer.release(self.warped.view)

    def turn_to(self, onto: Floats) -> Warped:
        """The view warped about as by `onto` (3, 3): the present one where that is near enough."""
        if self._strays(onto):
            self.warp(onto)
        return self.warped

    def warp(self, onto: Floats) -> Warped:
        """The view warped by `onto` (3, 3), reference pixels -> live pixels."""
        self._measurer.release(self.warped.view)
        picture = cv2.warpPerspective(self.picture, onto, self._camera.size, flags=cv2.INTER_LINEAR,
                                      borderMode=cv2.BORDER_REPLICATE)
        self.warped = self._prepared(self._measurer.view(np.asarray(picture, np.uint8)), onto)
        return self.warped

    def _rivals(self) -> Rivals:
        """Each window is searched for around itself, left, right, above and below, half a window off and more."""
        side, view = self.window, self.warped.view
        reach = side // 2
        answers = self._measurer.measure([Query(view, view, x, y, side, side, (dx, dy), (reach, reach))
                                          for x, y in self.warped.centres.tolist()
                                          for dx, dy in ((side, 0), (-side, 0), (0, side), (0, -side))], self._rules)
        valid = (1 + sum(m.valid for m in answers)) / (2 + len(answers))
        best = np.array([m.score for m in answers]).reshape(-1, 4).max(axis=1, initial=0.5)
        return Rivals(valid, float(best.mean()) if best.size else 0.5,
                      max(float(best.std()), LEAST_DEVIATION) if best.size else LEAST_DEVIATION)

    def _strays(self, onto: Floats) -> bool:
        size = np.array(self._camera.size, np.float64)
        probe = self._camera.centre + 0.4 * size * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
        try:
            there = moved(inverse(self.warped.onto), probe)
        except np.linalg.LinAlgError:
            return True
        off = moved(onto, there) - probe
        arm = 0.4 * size[[0, 0, 1, 1]]
        return bool(np.hypot(*off[0]) > STRAY_PX or (np.hypot(*(off[1:] - off[0]).T) > STRAY * arm).any())

    def _prepared(self, view: View, onto: Floats) -> Warped:
        for step in range(self.window, self.window // 2 - 1, -max(1, self.window // 16)):
            centres = self._places(onto, step)
            if len(centres) >= FEW:
                break
        if len(centres):
            side = self.window
            likeness = np.array(self._measurer.likeness(view, [(x, y, side, side) for x, y in centres.tolist()]))
            order = np.argsort(likeness, kind="stable")
            order = order[likeness[order] <= self._rules.max_likeness]
            centres = centres[_spread(order, centres, self.most)]
        back = moved(inverse(onto), centres.astype(np.float64).reshape(-1, 2))
        return Warped(view, onto, centres, moved(self._levelling, back), self._independent(centres))

    def _independent(self, centres: Integers) -> float:
        """Area that windows cover together, over the sum of their areas."""
        cover = np.zeros(-(-np.array(self._camera.size[::-1]) // CELL), np.bool_)
        side = max(1, self.window // CELL)
        for x, y in ((centres - self.window // 2) // CELL).tolist():
            cover[y:y + side, x:x + side] = True
        return float(cover.sum()) / max(1, len(centres) * side * side)

    def _places(self, onto: Floats, step: int) -> Integers:
        """Centres (n, 2) of a grid of windows, `step` pixels apart or more, that lie wholly in what the warped view
        has of the reference."""
        width, height = self._camera.size
        margin = width // 160  # the filter's own reach makes signs at the reference's border uncertain
        frame = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]], np.float64)
        seen = moved(onto, frame)
        low = np.maximum(np.floor(seen.min(axis=0)), 0).astype(int)
        high = np.minimum(np.ceil(seen.max(axis=0)), [width - 1, height - 1]).astype(int)
        half, lines = self.window // 2, []
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

