# SPDX-License-Identifier: Apache-2.0
"""The light of all frames of a mosaic in one least-squares fit: a field that all share, and a smooth one of each frame.

Model, in logarithms of grey levels, for each colour: what frame f shows of cell c of the seafloor, at the place (u, v)
of its picture, is `R(c) + L(u, v) + g(f) + l(f; u, v)`. R is the floor; L the light field of lamp and lens, a
polynomial of degree `DEGREE`; g the frame's gain (exposure, turbidity, range); l a polynomial of degree `OWN_DEGREE`,
small, as range and tilt change the light. Cells that several frames show tell R from the rest; they are eliminated, so
that the cost grows in proportion to the number of frames.

Overlaps alone leave two things open. A slope of the light over each picture and gains that rise along the survey look
alike, and a small error of each overlap adds up to a large one over many frames. Both are decided by a weak belief that
the floor is equally bright everywhere. It matters over distances of more than about `SCREEN` frames, and takes out the
survey's overall drift; brighter and darker places of the floor that are smaller stay. Weights of Cauchy's kind let
fish and wrong places count little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, corners

CELLS = 16
"""Cells along a frame's longer side."""
DEGREE = 6
"""Total degree of the light field."""
NOISE = 0.05
"""Usual difference of two frames in a cell, logarithm of grey levels."""
FIELD, GAIN, OWN = 0.5, 1.0, 0.1
"""Standard deviations believed of the light field's coefficients, of the gains, and of the further coefficients of each
frame's own field, logarithm; those of a coefficient of degree d are d times smaller."""
OWN_DEGREE = 2
"""Total degree of a frame's own field."""
SCREEN = 12.0
"""Frames over which the belief in an evenly bright floor weighs as much as the overlaps."""
EVEN = 0.25 / SCREEN**2
"""Weight of the belief that a cell is as bright as the mean; frames that overlap by half are held together by half of
their cells with a weight of a half."""
ROUNDS = 6
"""Rounds of reweighting."""
LEAST, MOST = 0.25, 4.0
"""What a picture may be multiplied by."""
DARKEST = 2.0
"""Grey level below which a cell tells nothing."""
CLIPPED = 250.0
"""Grey level above which a cell is taken as clipped."""
MAP = 32
"""Points along the longer side of the map by which a picture is multiplied."""


@dataclass(frozen=True, eq=False)
class Light:
    """The light of the frames of a mosaic.

    Attributes:
        own: (frames, own terms, channels), logarithm: coefficients of each frame's own field, the first its gain.
        field: (terms, channels), logarithm: coefficients of `basis`.
    """

    own: Floats
    field: Floats

    def factor(self, frame: int, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """What to multiply a picture by: float32 (h, w, channels), small, over the whole picture.

        Args:
            frame: its number.
            shape: the picture's height and width.
        """
        less = MAP / max(shape[:2])
        height, width = (max(2, round(n * less)) for n in shape[:2])
        v, u = ((np.arange(n) + 0.5) / n * 2 - 1 for n in (height, width))
        across, down = (a.ravel() for a in np.meshgrid(u, v))
        logs = basis(across, down)[:, 1:] @ self.field + basis(across, down, OWN_DEGREE) @ self.own[frame]
        return np.asarray(np.clip(np.exp(-logs), LEAST, MOST).reshape(height, width, -1), np.float32)


def basis(u: Floats, v: Floats, degree: int = DEGREE) -> Floats:
    """Products of Legendre polynomials in (u, v), each -1..1 over the picture, by total degree: (points, terms).

    All but the first, which is 1, are 0 on average.
    """
    across, down = legendre.legvander(u, degree), legendre.legvander(v, degree)
    return np.stack([across[:, i] * down[:, d - i] for d in range(degree + 1) for i in range(d + 1)], 1)


def _doubts(degree: int, spread: float) -> Floats:
    """Weights of the belief that the coefficients of a field, but the first, are 0."""
    return np.array([(NOISE * d / spread) ** 2 for d in range(1, degree + 1) for _ in range(d + 1)])


def shrink(picture: Image) -> Image:
    """The small copy of a picture that the light is fitted to: uint8, `CELLS` pixels along its longer side."""
    less = CELLS / max(picture.shape[:2])
    size = [max(2, round(n * less)) for n in picture.shape[1::-1]]
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)


@dataclass(frozen=True, eq=False)
class _Seen:
    """What the frames show of the cells: frame, cell, place in the frame, value (logarithm), a row each."""

    frame: NDArray[np.int32]
    cell: NDArray[np.int64]
    terms: Floats
    value: Floats


def fit_light(copies: Sequence[Image], sizes: Sequence[tuple[int, int]], places: Sequence[Similarity]) -> Light:
    """Fit the light of the frames of a mosaic.

    Args:
        copies: small copies of the pictures, from `shrink`, all grey or all colour.
        sizes: width and height of the pictures, pixels.
        places: pixels of each picture -> mosaic plane.

    Returns:
        The light about the survey's mean: pictures divided by it are on average as bright as they were.
    """
    channels = copies[0].shape[2] if copies[0].ndim == 3 else 1
    own_terms, terms = ((d + 1) * (d + 2) // 2 for d in (OWN_DEGREE, DEGREE))
    seen = _observe(copies, sizes, places)
    if len(copies) == 1 or not len(seen.frame):
        return Light(np.zeros((len(copies), own_terms, channels)), np.zeros((terms - 1, channels)))
    middle = seen.value.mean(axis=0)
    weights = np.ones(len(seen.frame))
    for _ in range(ROUNDS):
        own, field, rest = _solve(seen, seen.value - middle, weights, len(copies))
        off = np.abs(rest).max(axis=1)
        weights = 1 / (1 + (off / max(2 * 1.4826 * float(np.median(off)), NOISE / 2)) ** 2)
    own[:, 0] -= own[:, 0].mean(axis=0)
    return Light(own, field)


def _observe(copies: Sequence[Image], sizes: Sequence[tuple[int, int]], places: Sequence[Similarity]) -> _Seen:
    """Sample every frame at the cells of a grid over the mosaic."""
    cell = max(sizes[0]) * places[0].scale / CELLS
    frames, cells, at, values = [], [], [], []
    for number, (copy, size, place) in enumerate(zip(copies, sizes, places, strict=True)):
        onto = Similarity(complex(1 / cell)) @ place
        framed = onto(corners(size))
        low, high = np.ceil(framed.min(axis=0)).astype(int), np.floor(framed.max(axis=0)).astype(int)
        x, y = (a.ravel() for a in np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(low, high, strict=True))))
        points = (onto.inverse(np.stack([x, y], 1).astype(np.float64)) + 0.5) / size
        half = 0.5 / np.array(copy.shape[1::-1])
        inside = ((points >= half) & (points <= 1 - half)).all(axis=1)
        x, y, points = x[inside], y[inside], points[inside]
        spots = (points * copy.shape[1::-1] - 0.5).astype(np.float32)
        levels = np.asarray(cv2.remap(copy.astype(np.float32), spots[:, :1], spots[:, 1:], cv2.INTER_LINEAR,
                                      borderMode=cv2.BORDER_REPLICATE), np.float64).reshape(len(x), -1)
        good = (levels > DARKEST).all(axis=1) & (levels < CLIPPED).all(axis=1)
        frames.append(np.full(int(good.sum()), number, np.int32))
        cells.append(x[good].astype(np.int64) * (1 << 32) + y[good])
        at.append((2 * points[good] - 1).astype(np.float32))
        values.append(np.log(levels[good]))
    _, numbers = np.unique(np.concatenate(cells), return_inverse=True)
    places_uv = np.concatenate(at).astype(np.float64)
    return _Seen(np.concatenate(frames), numbers.ravel(), basis(places_uv[:, 0], places_uv[:, 1]),
                 np.concatenate(values))


def _solve(seen: _Seen, values: Floats, weights: Floats, count: int) -> tuple[Floats, Floats, Floats]:
    """One weighted fit, the cells eliminated: each frame's own field, the common one, what remains of each value."""
    rows, cells = len(weights), int(seen.cell.max()) + 1
    own_terms = (OWN_DEGREE + 1) * (OWN_DEGREE + 2) // 2
    common = seen.terms[:, 1:]
    columns = seen.frame[:, None] * own_terms + np.arange(own_terms)
    own = sparse.csr_matrix((seen.terms[:, :own_terms].ravel(), columns.ravel(),
                             np.arange(0, rows * own_terms + 1, own_terms)), (rows, count * own_terms))
    of_cell = sparse.csr_matrix((weights, (seen.cell, np.arange(rows))), (cells, rows))
    weighted = own.T.multiply(weights).tocsr()
    both = (of_cell @ own).tocsr()
    inverse = 1 / (np.bincount(seen.cell, weights, cells) + EVEN)
    scaled = sparse.diags(inverse) @ both
    cell_common, cell_values = of_cell @ common, of_cell @ values
    doubts = np.tile([(NOISE / GAIN) ** 2, *_doubts(OWN_DEGREE, OWN)], count)
    left = weighted @ own - both.T @ scaled + sparse.diags(doubts)
    cross = weighted @ common - scaled.T @ cell_common
    square = (_product(common, weights, common) - _product(cell_common, inverse, cell_common)
              + np.diag(_doubts(DEGREE, FIELD)))
    right = weighted @ values - scaled.T @ cell_values
    right_common = _product(common, weights, values) - _product(cell_common, inverse, cell_values)
    factored = splu(sparse.csc_matrix(left))
    reduced = factored.solve(np.ascontiguousarray(cross))
    field = np.linalg.solve(square - cross.T @ reduced, right_common - reduced.T @ right)
    fields = factored.solve(np.ascontiguousarray(right)) - reduced @ field
    rest = values - own @ fields - np.einsum("ij,jk->ik", common, field)
    rest -= ((of_cell @ rest) * inverse[:, None])[seen.cell]
    return fields.reshape(count, own_terms, -1), field, rest


def _product(a: Floats, weights: Floats, b: Floats) -> Floats:
    """`a.T @ diag(weights) @ b`, on this core alone: threads would cost more than these thin matrices do."""
    return np.asarray(np.einsum("ki,kj->ij", a, weights[:, None] * b))
