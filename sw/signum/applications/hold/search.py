# SPDX-License-Identifier: Apache-2.0
"""Where a lost reference is: a search over the whole view, rotations and scales, some of them in each frame.

Both pictures, without their marine snow, as a flake is as large as the texture there, are scaled to 160 pixels. The
reference is drawn many times on a sheet of the board's size, each time turned and scaled differently, so that one
capture serves up to 16 variants and the board keeps its picture size. Each of a grid of a variant's windows is searched
for in the whole live view; the similarity that most of them agree on is a candidate, unless chance explains it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import cv2
import numpy as np

from signum.applications.hold.evidence import log_false_alarms
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, fit, vote
from signum.measure.measurer import Measurer, Query, View
from signum.measure.register import ANYTHING

SIDE, LEAST_SIDE = 160, 64
"""Longer side of the small pictures, pixels, and the least shorter one."""
WINDOW = 32
"""Side of the windows, small pixels, at most a third of the picture."""
GRID = 7, 6
"""Windows across and down."""
SLOW = 16.0
"""Deviation of the Gaussian, small pixels, above which brightness changes slowly: many times that of the board's
filter, which does not see it anyway."""
DEVIATION, LEAST_CONTRAST = 40.0, 0.05
"""Grey levels to which a small picture's deviation is stretched, and the least that it is taken to have."""
STEP_DEG, STEP_SCALE = 8.0, 1.15
"""Steps of the variants; a variant's windows are still found half of both away from it."""
NEAR = 3, 1
"""Steps of rotation and of scale, from those last known, of the variants that are tried again and again."""
FAR = 11, 2
"""The same of all variants; those that are not near take turns, half as many as the near ones each time."""
BUDGET = 8
"""Variants tried in a frame: about 3 ms each on the golden board."""
TOLERANCE = 3.2
"""Largest miss of a window that agrees, small pixels."""
MAYBE = -1.0
"""Logarithm of the number of false alarms below which a candidate is worth a closer look."""


@dataclass(frozen=True)
class Candidate:
    """A similarity that windows voted for: pixels of the reference -> of the live view, both from the picture's centre;
    and the logarithm to base 10 of its number of false alarms."""

    similarity: Similarity
    log_chance: float


class WholeView:
    """Proposes where a reference is in live views.

    Args:
        measurer: at the pictures' size; a sheet takes one of its slots until it is released.
        picture: the reference.
        begin: rotation and scale, as a complex factor, near which the search begins: those last known.
    """

    def __init__(self, measurer: Measurer, picture: Image, begin: complex) -> None:
        self._measurer = measurer
        width, height = measurer.size
        longest = max(SIDE, math.ceil(LEAST_SIDE * max(width, height) / min(width, height)))
        self._shrink = max(1.0, max(width, height) / longest)
        self._small = round(width / self._shrink), round(height / self._shrink)
        self._side = min(WINDOW, min(self._small) // 3)
        self._columns, self._rows = width // self._small[0], height // self._small[1]
        self._reference = self._shrunk(picture)
        self._variants = _endless(begin)
        self._waiting: list[tuple[tuple[int, int], complex]] = []
        self._sheet: View | None = None

    def release(self) -> None:
        """Release the sheet."""
        if self._sheet is not None:
            self._measurer.release(self._sheet)
            self._sheet = None
        self._waiting = []

    def look(self, picture: Image) -> list[Candidate]:
        """Candidates in a live picture, the best first; each call tries the next variants."""
        live = self._measurer.view(self._drawn([self._shrunk(picture)]))
        found: list[Candidate] = []
        try:
            for _ in range(BUDGET):
                if not self._waiting:
                    self._draw_sheet()
                found += self._try(*self._waiting.pop(0), live)
        finally:
            self._measurer.release(live)
        return sorted(found, key=lambda c: c.log_chance)

    def _draw_sheet(self) -> None:
        self.release()
        factors = list(islice(self._variants, self._columns * self._rows))
        width, height = self._small
        turned = [np.asarray(cv2.warpAffine(self._reference, self._about(f).matrix, self._small, flags=cv2.INTER_LINEAR,
                                            borderMode=cv2.BORDER_REPLICATE), np.uint8) for f in factors]
        self._sheet = self._measurer.view(self._drawn(turned))
        self._waiting = [((width * (k % self._columns), height * (k // self._columns)), f)
                         for k, f in enumerate(factors)]

    def _try(self, corner: tuple[int, int], factor: complex, live: View) -> list[Candidate]:
        """The candidate of a variant drawn at `corner` of the sheet, if windows agree on one."""
        assert self._sheet is not None
        (width, height), side = self._small, self._side
        centres = self._centres(factor)
        if len(centres) < 4:
            return []
        reach = (width - side) // 2, (height - side) // 2
        answers = self._measurer.measure(
            [Query(self._sheet, live, corner[0] + x, corner[1] + y, side, side,
                   (width // 2 - x - corner[0], height // 2 - y - corner[1]), reach)
             for x, y in centres.tolist()], ANYTHING)
        middle = (np.array(self._small, np.float64) - 1) / 2
        p = centres - middle
        q = p + [[m.dx_px + corner[0], m.dy_px + corner[1]] for m in answers]
        start, _ = vote(p, q, TOLERANCE, 0.75 * STEP_DEG, STEP_SCALE, 1.5 * side)
        seen = fit(p, q, start, TOLERANCE, 3.0).similarity
        chance = log_false_alarms(np.hypot(*(q - seen(p)).T), len(p), (2 * reach[0] + 1) * (2 * reach[1] + 1))
        if chance > MAYBE:
            return []
        whole = Similarity(seen.factor, seen.shift * self._shrink) @ Similarity(factor)
        return [Candidate(whole, chance)]

    def _about(self, factor: complex) -> Similarity:
        """A rotation and scale about a small picture's centre."""
        middle = complex(*((np.array(self._small) - 1) / 2))
        return Similarity(factor, middle - factor * middle)

    def _centres(self, factor: complex) -> Floats:
        """Centres (n, 2) of the windows that lie wholly within the reference as it is drawn by `factor`."""
        side, size = self._side, np.array(self._small)
        across, down = (np.unique(np.rint(np.linspace(side // 2, n - side + side // 2, k)).astype(int))
                        for n, k in zip(self._small, GRID, strict=True))
        centres = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
        corners = centres[:, None, :] + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * side / 2
        back = self._about(factor).inverse(corners.astype(np.float64))
        return np.asarray(centres[((back >= -1) & (back <= size)).all(axis=(1, 2))])

    def _shrunk(self, picture: Image) -> Image:
        return _even(np.asarray(cv2.resize(picture.astype(np.float32), self._small, interpolation=cv2.INTER_AREA)))

    def _drawn(self, pictures: list[Image]) -> Image:
        """Small pictures on a sheet, row by row."""
        width, height = self._small
        sheet = np.zeros(self._measurer.size[::-1], np.uint8)
        for k, picture in enumerate(pictures):
            x, y = width * (k % self._columns), height * (k // self._columns)
            sheet[y:y + height, x:x + width] = picture
        return sheet


def _even(small: Floats) -> Image:
    """A small picture without what changes slowly, stretched to the range of a pixel: the mean of many pixels tells
    more than whole grey levels, and a plain floor in murky water has few of them."""
    apart = small - cv2.GaussianBlur(small, (0, 0), SLOW)
    stretch = DEVIATION / max(float(apart.std()), LEAST_CONTRAST)
    return np.asarray(np.clip(np.rint(128 + stretch * apart), 0, 255), np.uint8)


def _endless(begin: complex) -> Iterator[complex]:
    """Factors of the variants in the order in which they are tried: the near ones, the nearest first, and some of the
    others, again and again."""
    def ring(steps: tuple[int, int]) -> list[complex]:
        turns, scales = steps
        pairs = [(i, j) for i in range(-turns, turns + 1) for j in range(-scales, scales + 1)]
        pairs.sort(key=lambda ij: (ij[0] ** 2 + ij[1] ** 2, ij))
        return [begin * cmath.rect(STEP_SCALE ** j, math.radians(STEP_DEG * i)) for i, j in pairs]

    near = ring(NEAR)
    far = [f for f in ring(FAR) if f not in near]
    at = 0
    while True:
        yield from near
        for _ in range(len(near) // 2):
            yield far[at % len(far)]
            at += 1
