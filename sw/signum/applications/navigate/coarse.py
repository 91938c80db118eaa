# SPDX-License-Identifier: Apache-2.0
"""The coarse search: candidate places of a frame in a mosaic, without a prior.

Frame and mosaic are scaled down until the frame is 160 pixels long. A grid of the frame's windows is searched for in
tiles of the mosaic as large as the board takes; every window votes with its best match in every tile.

Marine snow, a few pixels each, outlasts the scaling and moves the signs around it: a median filter takes it out of the
frame first. It takes fine texture with it, so that where nothing is found, the frame as it is is searched for as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.navigate.chart import Chart, filled
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, fit, vote
from signum.measure.measurer import Measurer, Query
from signum.measure.register import ANYTHING

SEARCH_SIDE = 160
"""Longer side of the scaled frame, pixels."""
SEARCH_WINDOW = 32
"""Side of the windows, coarse pixels."""
SEARCH_SIGMA = 1.25
"""Sigma of the LoG, coarse pixels."""
SEARCH_GRID = (5, 4)
"""Windows across and down."""
TILE_OVERLAP = 56
"""Overlap of tiles, pixels: a window, and a margin for the rotation of the picture."""
SEARCH_MISS_PX = 4.0
"""Largest residual of a window from the similarity it votes for, coarse pixels."""
LEAST_VOTES = 3
"""Least number of votes of a candidate."""
SPECKS = 5
"""Side of the median filter, pixels: specks of less than half its area vanish."""
HALF = complex(0.5, 0.5)
"""Half a pixel along both axes: scaling keeps the picture's corner, half a pixel off the first pixel's centre."""


class CoarseSearch:
    """Proposes candidate places.

    Args:
        measurer: makes a measurer for a picture size (width, height) and a sigma.
        largest: (width, height) of the largest picture the board takes.
        frame: (width, height) of the frames.
        chart: the mosaic at the frames' scale.
    """

    def __init__(self, measurer: Callable[[tuple[int, int], float], Measurer], largest: tuple[int, int],
                 frame: tuple[int, int], chart: Chart) -> None:
        self._make = measurer
        self._shrink = max(1.0, max(frame) / SEARCH_SIDE)
        self._small = round(frame[0] / self._shrink), round(frame[1] / self._shrink)
        self._chart = chart.shrunk(self._shrink)
        self._tile = (min(largest[0], max(self._chart.size[0], self._small[0])),
                      min(largest[1], max(self._chart.size[1], self._small[1])))
        self._tiles = self._cut()

    def candidates(self, live: Image, turns_deg: Sequence[float], convinced: int, rot_deg: float, zoom: float,
                   most: int, calm: bool = False) -> list[Similarity]:
        """Similarities from the frame to the chart, in descending order of votes.

        Args:
            live: uint8 of the frame's size.
            turns_deg: rotations of the frame that are tried, in order, until one has `convinced` votes.
            rot_deg, zoom: largest rotation and scale beyond those tried.
            most: largest number of candidates.
            calm: whether specks are taken out of the frame first.
        """
        measurer = self._make(self._tile, SEARCH_SIGMA)
        live = np.asarray(cv2.medianBlur(live, SPECKS), np.uint8) if calm else live
        small = np.asarray(cv2.resize(live, self._small, interpolation=cv2.INTER_AREA), np.uint8)
        found: list[tuple[int, Similarity]] = []
        for turn in turns_deg:
            p, q, about = self._ask(measurer, small, turn)
            found += [(votes, s @ about) for votes, s in elect(p, q, rot_deg, zoom, most)]
            if found and max(votes for votes, _ in found) >= convinced:
                break
        found.sort(key=lambda f: -f[0])
        up = Similarity(self._shrink + 0j, HALF * self._shrink - HALF)
        return [up @ s @ up.inverse for _, s in found[:most]]

    def _cut(self) -> list[tuple[Image, tuple[int, int]]]:
        """Pictures of the tile's size that cover the mosaic, and their corners."""
        picture, covered, (width, height) = filled(self._chart), self._chart.covered, self._tile
        out = []
        for y in _corners(self._chart.size[1], height):
            for x in _corners(self._chart.size[0], width):
                if covered[y:y + height, x:x + width].any():
                    out.append((_padded(picture[y:y + height, x:x + width], self._tile), (x, y)))
        return out

    def _ask(self, measurer: Measurer, small: Image, turn_deg: float) -> tuple[Floats, Floats, Similarity]:
        """Windows of the rotated frame and their best match in each tile, coarse pixels; and the rotation."""
        width, height = self._small
        middle = complex((width - 1) / 2, (height - 1) / 2)
        factor = Similarity.of(turn_deg).factor
        about = Similarity(factor, middle - factor * middle)
        seen = np.full(small.shape, 255, np.uint8)
        if turn_deg:
            seen = np.asarray(cv2.warpAffine(seen, about.matrix, (width, height), flags=cv2.INTER_NEAREST), np.uint8)
            small = np.asarray(cv2.warpAffine(small, about.matrix, (width, height), flags=cv2.INTER_LINEAR,
                                              borderMode=cv2.BORDER_REPLICATE), np.uint8)
        inside = cv2.integral(np.asarray(seen > 0, np.uint8))
        side = min(SEARCH_WINDOW, min(self._small) // 2)
        centres = [c for c in spread(side, self._small, SEARCH_GRID) if whole(inside, c, side)]
        frame = measurer.view(_padded(small, self._tile))
        p, q = [], []
        for picture, corner in self._tiles:
            tile = measurer.view(picture)
            answers = measurer.measure([Query(frame, tile, x, y, side, side, reach=self._tile) for x, y in centres],
                                       ANYTHING)
            measurer.release(tile)
            p += centres
            q += [(x + m.dx_px + corner[0], y + m.dy_px + corner[1])
                  for (x, y), m in zip(centres, answers, strict=True)]
        measurer.release(frame)
        return np.array(p, np.float64).reshape(-1, 2), np.array(q, np.float64).reshape(-1, 2), about


def elect(p: Floats, q: Floats, rot_deg: float, zoom: float, most: int) -> list[tuple[int, Similarity]]:
    """Similarities p -> q with their votes, each with the most votes among the pairs that the earlier ones leave."""
    out: list[tuple[int, Similarity]] = []
    while len(p) >= LEAST_VOTES and len(out) < most:
        found, agree = vote(p, q, SEARCH_MISS_PX, rot_deg, zoom, 1.5 * SEARCH_WINDOW)
        if agree.sum() < LEAST_VOTES:
            break
        out.append((int(agree.sum()), fit(p, q, found, SEARCH_MISS_PX, 3.0).similarity))
        p, q = p[~agree], q[~agree]
    return out


def spread(window: int, size: tuple[int, int], counts: tuple[int, int]) -> list[tuple[int, int]]:
    """Centres of a grid of windows that fills a picture, as `Query` takes them."""
    across, down = (np.unique(np.rint(np.linspace(window // 2, n - window + window // 2, k)).astype(int))
                    for n, k in zip(size, counts, strict=True))
    return [(int(x), int(y)) for y in down for x in across]


def whole(inside: NDArray[np.generic], centre: tuple[int, int], window: int) -> bool:
    """Whether at least 98 % of a window is inside, by an integral image of 0 and 1."""
    x, y = centre[0] - window // 2, centre[1] - window // 2
    a, b, c, d = (int(inside[v, u]) for v, u in ((y, x), (y, x + window), (y + window, x), (y + window, x + window)))
    return a - b - c + d >= 0.98 * window * window


def _padded(picture: Image, size: tuple[int, int]) -> Image:
    below, aside = size[1] - picture.shape[0], size[0] - picture.shape[1]
    return np.asarray(cv2.copyMakeBorder(picture, 0, below, 0, aside, cv2.BORDER_REPLICATE), np.uint8)


def _corners(extent: int, tile: int) -> list[int]:
    """First pixels of the tiles along one axis."""
    if extent <= tile:
        return [0]
    count = math.ceil((extent - TILE_OVERLAP) / (tile - TILE_OVERLAP))
    return [round(i * (extent - tile) / (count - 1)) for i in range(count)]
