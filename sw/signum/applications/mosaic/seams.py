# SPDX-License-Identifier: Apache-2.0
"""Which frame shows each place of a mosaic: the nearest one that agrees with the others there.

The choice is made on small copies of the frames, in tiles of a coarse grid over the mosaic. A frame's cost at a place
is the squared distance from its centre, and more where it shows what other frames do not: fish, floating weed, a wrong
place, or, for less, a flake of marine snow. Of three or more frames the median is right. Where half of the frames or
more differ from it, as two always do, those are right whose patch looks like what surrounds it, for the whole patch, so
that no seam cuts a thing in two. Where the costs of two frames are about equal, the seam between them is put where they
differ least: the band is flooded from both sides, large differences first.

A tile's choice depends on its own surroundings alone, so the cost grows in proportion to the number of frames.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity

TILE, AROUND = 160, 24
"""Side of a tile, and the margin looked at around it, pixels of the coarse grid."""
ALONE = -1
"""In a choice: the rim, where no frame surely reaches; any that does may show it."""
SMOOTH = 1.2
"""Width of the Gaussian before frames are compared, pixels of the grid: wrong by less, they still agree."""
LEVELS, SHIFT = 3.0, 1.0
"""Difference of two frames that is expected at least, grey levels, and wherever they are laid wrong by that many pixels
of the grid."""
WIDE, EVENED = 3.0, 0.15
"""Width of the Gaussian that differences are averaged with, pixels of the grid, and what it leaves of those between
frames that are laid wrong: texture that is moved differs by 0 on average, a fish does not."""
UNEVEN = 0.03
"""Difference of such averages that is expected at least, as a share of the grey level: what is left of uneven light."""
OUT, EDGE = 3.0, 1.5
"""Difference from the others in units of the expected one at which a frame shows something else, and at the outline of
what it shows."""
SMALLEST = 12
"""Least area of something else, pixels of the grid."""
GROWN = 3
"""Pixels of the grid by which it is enlarged: its outline is soft."""
RING = 5
"""Width of the surroundings that a patch is compared with, pixels of the grid."""
PENALTY = 4.0
"""Cost of showing something else; the squared distance from a frame's centre costs 1 in its corners."""
MARGIN, LAST = 0.03, 1.0
"""Part of a frame's width and height along its edges that is shown only where nothing else is, and what it costs: there
the light is least known, and a seam would follow the edge."""
FLAKE, HINT, FLAKES = 40.0, 15.0, 0.6
"""Brightness above its surroundings from which a speck may be marine snow, the one from which another frame bears it
out, grey levels; cost of snow."""
BAND = 0.12
"""Difference of the costs of two frames up to which the seam between them may move."""

Float = NDArray[np.float32]
Labels = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Layer:
    """A frame on a tile of the grid.

    Attributes:
        number: of the frame.
        levels: float32 (h, w, channels), grey levels, its light evened out and smoothed.
        specks: float32 (h, w), how far the brightest speck stands out of its surroundings, grey levels.
        cost: float32 (h, w), squared distance from its centre in half diagonals; infinite where it does not reach.
    """

    number: int
    levels: Float
    specks: Float
    cost: Float


def calm(picture: Image) -> Image:
    """A picture whose specks, up to 3 pixels wide, stand out of their surroundings by `FLAKE` at most."""
    around = np.asarray(cv2.medianBlur(picture, 5), np.uint8)
    return np.asarray(cv2.min(picture, cv2.add(around, np.full_like(around, FLAKE))), np.uint8)


def specks_of(picture: Image, size: tuple[int, int]) -> Image:
    """How far specks stand out of their surroundings, grey levels, the highest for each pixel of a copy of `size`."""
    grey = picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)
    above = cv2.subtract(grey, cv2.medianBlur(grey, 5))
    less = -(-picture.shape[1] // size[0])
    return np.asarray(cv2.resize(cv2.dilate(above, np.ones((less, less), np.uint8)), size,
                                 interpolation=cv2.INTER_NEAREST), np.uint8)


def softened(copy: Image) -> Float:
    """A small copy as frames are compared by it: float32, as large, smoothed."""
    return np.asarray(cv2.GaussianBlur(copy.astype(np.float32), (0, 0), SMOOTH, borderType=cv2.BORDER_REPLICATE),
                      np.float32)


def lay(number: int, copy: Float, specks: Float, size: tuple[int, int], place: Similarity, spot: tuple[int, int],
        shape: tuple[int, int], rim: float) -> Layer:
    """A frame laid onto a tile of the grid.

    Args:
        number: of the frame.
        copy: from `softened`, of a small copy of it, its light evened out.
        specks: from `specks_of`, as large.
        size: the frame's width and height, pixels.
        place: its pixels -> pixels of the grid.
        spot: column and row of the tile's corner in the grid.
        shape: the tile's height and width.
        rim: pixels along the frame's edges that are left out.
    """
    less = Similarity(complex(size[0] / copy.shape[1]), complex(*(0.5 * size[0] / copy.shape[1] - 0.5,) * 2))
    matrix = (Similarity(shift=-complex(*spot)) @ place @ less).matrix
    levels = np.asarray(cv2.warpAffine(copy, matrix, shape[::-1], flags=cv2.INTER_LINEAR,
                                       borderMode=cv2.BORDER_REPLICATE), np.float32).reshape(*shape, -1)
    flakes = cv2.warpAffine(specks, matrix, shape[::-1], flags=cv2.INTER_LINEAR)
    inverse = place.inverse
    x, y = spot[0] + np.arange(shape[1]), spot[1] + np.arange(shape[0])
    at = inverse.factor * (x + 1j * y[:, None]) + inverse.shift
    off = at - complex(*size) / 2 + (0.5 + 0.5j)
    edge = rim + 0.5 / place.scale
    inside = (np.abs(off.real) <= size[0] / 2 - 0.5 - edge) & (np.abs(off.imag) <= size[1] / 2 - 0.5 - edge)
    cost = (off.real**2 + off.imag**2) / (size[0] ** 2 + size[1] ** 2) * 4
    cost += LAST * ((np.abs(off.real) > (0.5 - MARGIN) * size[0]) | (np.abs(off.imag) > (0.5 - MARGIN) * size[1]))
    return Layer(number, levels, np.asarray(flakes, np.float32), np.where(inside, cost, np.inf).astype(np.float32))


def choose_frames(layers: Sequence[Layer]) -> Labels:
    """The number of the frame that shows each place of a tile, or `ALONE`: int32 (h, w).

    Args:
        layers: the frames that reach into the tile, at least one.
    """
    numbers = np.array([layer.number for layer in layers], np.int32)
    cost = np.stack([layer.cost for layer in layers])
    reach = np.isfinite(cost)
    if len(layers) == 1:
        return np.where(reach[0], numbers[0], ALONE).astype(np.int32)
    levels = np.stack([layer.levels for layer in layers])
    expected, odd = _compare(levels, reach)
    cost += PENALTY * _something_else(levels, reach, expected, odd)
    cost += FLAKES * _snow(np.stack([layer.specks for layer in layers]), reach)
    order = np.argsort(cost, axis=0)[:2]
    first, second = np.take_along_axis(cost, order, 0)
    gap = np.where(np.isfinite(second), second - np.where(np.isfinite(first), first, 0), np.inf)
    best = _seamed(order, gap, levels, expected)
    taken = np.take_along_axis(cost, best[None], 0)[0]
    best = np.where(taken <= first + LAST / 2, best, order[0])
    return np.where(np.isfinite(first), numbers[best], ALONE).astype(np.int32)


def _compare(levels: Float, reach: NDArray[np.bool_]) -> tuple[Float, Float]:
    """The difference to expect at each place, (h, w), and each frame's difference from the median of all in units of
    it, (frames, h, w), 0 where it does not reach."""
    ordered = np.sort(np.where(reach[..., None], levels, np.inf), axis=0)
    count = reach.sum(axis=0)
    low, high = np.maximum(count - 1, 0) // 2, np.minimum(count // 2, np.maximum(count - 1, 0))
    middle = sum(np.take_along_axis(ordered, k[None, :, :, None], 0)[0] for k in (low, high)) / np.float32(2)
    middle = np.where(count[..., None] > 0, middle, 0).astype(np.float32)
    steep = np.max([cv2.magnitude(cv2.Sobel(middle[..., c], cv2.CV_32F, 1, 0, scale=0.125),
                                  cv2.Sobel(middle[..., c], cv2.CV_32F, 0, 1, scale=0.125))
                    for c in range(middle.shape[2])], axis=0)
    expected = np.asarray(LEVELS + SHIFT * cv2.dilate(steep, np.ones((3, 3), np.uint8)), np.float32)
    level, slope = (np.asarray(cv2.GaussianBlur(a, (0, 0), WIDE)) for a in (middle.max(axis=-1), expected - LEVELS))
    evened = 1 + UNEVEN * level + EVENED * slope
    odd = np.zeros(reach.shape, np.float32)
    for k in range(len(levels)):
        off = np.where(reach[k][..., None], levels[k] - middle, 0)
        average = np.asarray(cv2.GaussianBlur(off, (0, 0), WIDE)).reshape(off.shape)
        odd[k] = np.where(reach[k], np.maximum(np.abs(off).max(axis=-1) / expected,
                                               np.abs(average).max(axis=-1) / evened), 0)
    return expected, odd


def _something_else(levels: Float, reach: NDArray[np.bool_], expected: Float, odd: Float) -> NDArray[np.bool_]:
    """Where each frame shows what the others do not, (frames, h, w)."""
    count = reach.sum(axis=0)
    found = np.stack([_patches(np.where(count >= 3, o, 0), OUT, EDGE) for o in odd])
    # Each of two frames differs from the middle by half of their difference.
    contested = _patches(np.where(count == 2, odd.max(axis=0), 0), OUT / 2, EDGE / 2)
    contested |= (found.any(axis=0) & (2 * found.sum(axis=0) >= count)).astype(np.uint8)
    doubtful = contested | found.max(axis=0)
    _, parts, stats, _ = cv2.connectedComponentsWithStats(doubtful, connectivity=8)
    for part in np.unique(parts[contested > 0]).tolist():
        x, y, width, height, _ = (int(n) for n in stats[part])
        here = (slice(max(y - RING, 0), y + height + RING), slice(max(x - RING, 0), x + width + RING))
        whole = np.asarray(parts[here] == part, np.uint8)
        inner = (whole & contested[here]) > 0
        ring = (cv2.dilate(whole, np.ones((2 * RING + 1, 2 * RING + 1), np.uint8)) > doubtful[here])
        by = (reach[:, *here] & inner).sum(axis=(1, 2))
        there = np.flatnonzero(2 * by >= by.max())
        strange = np.array([_strangeness(levels[k][here], reach[k][here] & inner, reach[k][here] & ring, expected[here])
                            for k in there])
        for k, odd_one in zip(there, strange > (strange.min() + strange.max()) / 2, strict=True):
            found[k][here][inner] = odd_one
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * GROWN + 1, 2 * GROWN + 1))
    return np.stack([np.asarray(cv2.dilate(f, kernel)) > 0 if f.any() else f > 0 for f in found])


def _snow(specks: Float, reach: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Where each frame has a speck that half of the frames there do not have, (frames, h, w)."""
    kernel = np.ones((3, 3), np.uint8)
    near = np.stack([np.asarray(cv2.dilate(s, kernel)) for s in specks])
    shared = ((near > HINT) & reach).sum(axis=0) * 2 > reach.sum(axis=0)
    return np.asarray((near > FLAKE) & reach & ~shared, bool)


def _patches(odd: Float, inside: float, outline: float) -> Image:
    """The parts of a tile above `outline` that are large enough and somewhere above `inside`: uint8 of 0 and 1."""
    mask = (odd > outline).astype(np.uint8)
    if odd.max() <= inside:
        return np.zeros_like(mask)
    _, parts, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    good = np.zeros(len(stats), bool)
    good[np.unique(parts[odd > inside])] = True
    good &= stats[:, cv2.CC_STAT_AREA] >= SMALLEST
    good[0] = False
    return np.asarray(good[parts], np.uint8)


def _strangeness(levels: Float, inner: NDArray[np.bool_], ring: NDArray[np.bool_], expected: Float) -> float:
    """How far a patch of a frame is from what surrounds it there, by mean and spread, in units of the difference to
    expect."""
    if not ring.any() or not inner.any():
        return 0.0
    a, b = levels[inner], levels[ring]
    off = np.abs(a.mean(axis=0) - b.mean(axis=0)) + np.abs(a.std(axis=0) - b.std(axis=0))
    return float(off.max() / expected[inner].mean())


def _seamed(order: NDArray[np.int64], gap: Float, levels: Float, expected: Float) -> NDArray[np.int64]:
    """Index of the frame at each place, (h, w), the seams moved to where the two nearest frames differ least."""
    best: NDArray[np.int64] = order[0]
    clear = ~(gap < BAND)  # also where only one frame reaches
    if clear.all() or not clear.any():
        return best
    two = [np.take_along_axis(levels, k[None, :, :, None], 0)[0] for k in order]
    from skimage.segmentation import watershed

    apart = np.abs(two[0] - two[1]).max(axis=-1) / expected
    markers = np.where(clear, best + 1, 0)
    flooded: NDArray[np.int64] = np.zeros_like(best)
    flooded += watershed(-np.minimum(apart, 10), markers)
    return flooded - 1


class Seams:
    """The choice over a whole mosaic, tile by tile as it is asked for.

    Args:
        layers: gives the frames on a tile, (corner, shape) -> layers; none where no frame reaches.
    """

    def __init__(self, layers: Callable[[tuple[int, int], tuple[int, int]], Sequence[Layer]]) -> None:
        self._layers = layers
        self._kept: dict[tuple[int, int], Labels] = {}

    def over(self, left: int, top: int, right: int, bottom: int) -> Labels:
        """The choice over a box of the grid, ends exclusive: int32 (h, w)."""
        out = np.full((bottom - top, right - left), ALONE, np.int32)
        columns = range(left // TILE, -(-right // TILE))
        wanted = [(i, j) for j in range(top // TILE, -(-bottom // TILE)) for i in columns]
        self._kept = {key: tile for key, tile in self._kept.items() if key in wanted or key[1] >= wanted[-1][1]}
        for i, j in wanted:
            if (i, j) not in self._kept:
                self._kept[i, j] = self._tile(i, j)
            x, y = i * TILE, j * TILE
            a, b = max(left, x), min(right, x + TILE)
            c, d = max(top, y), min(bottom, y + TILE)
            out[c - top:d - top, a - left:b - left] = self._kept[i, j][c - y:d - y, a - x:b - x]
        return out

    def _tile(self, i: int, j: int) -> Labels:
        side = TILE + 2 * AROUND
        layers = self._layers((i * TILE - AROUND, j * TILE - AROUND), (side, side))
        if not layers:
            return np.full((TILE, TILE), ALONE, np.int32)
        return choose_frames(layers)[AROUND:-AROUND, AROUND:-AROUND]


def grid_scale(sizes: Sequence[Floats | tuple[int, int]], scale: float, most: int) -> int:
    """Pixels of the mosaic along a pixel of the grid, so that a frame covers at most about `most` of them."""
    return max(1, round(float(np.sqrt(sizes[0][0] * sizes[0][1] * scale**2 / most))))
