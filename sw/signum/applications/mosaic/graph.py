# SPDX-License-Identifier: Apache-2.0
"""Pose graph: every frame's similarity by robust least squares over all edges at once.

A frame's pose takes its pixels p to the mosaic plane: f p + t, in complex numbers. An edge is a similarity S from
pixels of a to pixels of b. With c the centroid of its windows and s their spread, it has two complex residuals,

    (f_a c + t_a - t_b) / f_b - S(c)        the displacement of the centroid,
    s (f_a / f_b - S')                      that of the windows about it, by rotation and scale,

whose squares are, to first order, the mean square over its windows. Both are analytic in the poses, so Gauss-Newton
runs on complex sparse matrices with half the unknowns. They are measured in pixels of frame b, not of the plane: in the
plane the fit would reduce its residuals by shrinking frames that do not agree. Edges are levelled first (`level`).

Edges that contradict the others lose weight (Geman-McClure, in units of the usual misfit). The scale of the weights
begins wide and narrows, so that a gross error does not decide which edges it is that contradict (graduated
non-convexity: Yang et al., RA-L 2020). Of an edge with rivals, the motion that fits the poses best takes part
(max-mixture: Olson and Agarwal, IJRR 2013).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import SuperLU

from signum.applications.mosaic.edges import Edge
from signum.applications.mosaic.level import level, tilts
from signum.applications.mosaic.sparse import factored
from signum.common.arrays import Complexes, Floats
from signum.geometry.similarity import IDENTITY, Similarity

FLOOR_PX = 1.0
"""Error of a window in addition to the residual of its edge, original pixels: a little over half a board pixel."""
TOGETHER = 4.0
"""Number of windows that count as one: they overlap by half each way, and relief displaces neighbours alike."""
LEAST_SPREAD = 0.05
"""Spread assumed for edges without a measured rotation, as a fraction of the frame: enough to fix the angle."""
ROBUST = 3.0
"""Default of `outvoted` in `solve_graph`."""
PARALLAX = 0.01
"""Error of an edge by relief, as a share of its displacement: what the windows have in common."""
WIDENED = 6
"""Steps in which the scale of the robust weights comes down from 2 to this power."""
CONVEX = 0.5
"""Misfit, of that at which an edge has a quarter of its weight, below which the weights begin narrow if no edge is
above it: the cost is convex there (up to 0.577), so there is one solution, and none to be kept away from."""
MOST_STEPS = 40
"""Most Gauss-Newton steps."""
CONVERGED = 1e-3
"""Change of every translation, pixels, below which the steps end."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Placed frames.

    Attributes:
        places: pixels of each frame -> plane of the first; only of frames connected to it.
        weights: of the edges given, in order, 0..1; low where the others contradict an edge.
        chosen: of the same, the number of the rival that takes part, from 1; 0 for the edge's own motion.
        lean: tilt of each frame, per pixel; see `level`.
        misfit_px: of the same edges, pixels of frame b.
        usual: median misfit of the edges in units of their predicted one, at least 1; 1 without redundant edges.
    """

    places: dict[str, Similarity]
    weights: Floats
    misfit_px: Floats
    usual: float
    chosen: list[int] = field(default_factory=list)
    lean: dict[str, complex] = field(default_factory=dict)
    _names: dict[str, int] = field(default_factory=dict, repr=False)
    _factor: SuperLU | None = field(default=None, repr=False)

    def relative(self, a: str, b: str) -> Similarity:
        """Pixels of a -> pixels of b, by the poses."""
        return self.places[b].inverse @ self.places[a]

    def deviation(self, a: str, b: str, at: tuple[float, float]) -> float:
        """Standard deviation of where `relative(a, b)` puts the point `at` of a, each axis, pixels of b."""
        if self._factor is None:
            return 0.0
        row = np.zeros(2 * len(self._names), np.complex128)
        pa, pb = self.places[a], self.places[b]
        i, j = 2 * self._names[a], 2 * self._names[b]
        f = pb.factor
        seen = (pa.factor * complex(*at) + pa.shift - pb.shift) / f
        row[[i, i + 1]] += np.array([complex(*at), 1]) / f
        row[[j, j + 1]] -= np.array([seen, 1]) / f
        solved = self._factor.solve(np.conj(row[2:]))
        return float(self.usual * np.sqrt(max(float((row[2:] @ solved).real), 0.0)))


def precision(edge: Edge) -> float:
    """1 / variance of an edge's displacement at its centroid, each axis, 1/pixels^2."""
    return max(edge.agreed, 1) / TOGETHER / (edge.rms_px**2 / 2 + FLOOR_PX**2)


def chain(first: str, edges: Sequence[Edge], order: Mapping[int, float] | None = None) -> dict[str, Similarity]:
    """Frames placed one after the other along edges, breadth first from the first frame: a spanning tree.

    Args:
        first: its pose is the identity.
        edges: accepted ones; of those that lead to a frame at the same depth, the first in `order` places it.
        order: rank of each edge by its index; by default the most precise first.
    """
    rank = order or {k: -precision(edge) for k, edge in enumerate(edges)}
    beside: dict[str, list[tuple[float, str, Similarity]]] = {}
    for k, edge in enumerate(edges):
        beside.setdefault(edge.frame_a, []).append((rank[k], edge.frame_b, edge.similarity.inverse))
        beside.setdefault(edge.frame_b, []).append((rank[k], edge.frame_a, edge.similarity))
    places, queue = {first: IDENTITY}, deque([first])
    while queue:
        name = queue.popleft()
        for _, other, back in sorted(beside.get(name, []), key=lambda way: way[0]):
            if other not in places:
                places[other] = places[name] @ back
                queue.append(other)
    return places


def solve_graph(first: str, edges: Sequence[Edge], size: tuple[int, int],
          start: Mapping[str, Similarity] | None = None, outvoted: float = ROBUST,
          most_steps: int = MOST_STEPS) -> Solution:
    """Place all frames connected to the first.

    Args:
        first: the frame whose pose is the identity.
        edges: accepted ones.
        size: width and height of the frames, pixels.
        start: poses to begin with, where they are known; others follow from edges.
        outvoted: misfit at which an edge has a quarter of its weight, in units of the usual misfit.
        most_steps: Gauss-Newton steps at most.
    """
    lean = tilts(edges, size)
    given, edges = edges, level(edges, lean)
    tree = chain(first, edges)
    if start and first in start:
        origin = start[first].inverse
        tree = {name: origin @ start[name] if name in start else place for name, place in tree.items()}
    held = [k for k, edge in enumerate(edges) if edge.frame_a in tree]
    names = {name: i for i, name in enumerate(tree)}
    weights, misfits, chosen = np.ones(len(edges)), np.zeros(len(edges)), [0] * len(edges)
    if len(names) < 2:
        return Solution(dict(tree), weights, misfits, 1.0, chosen, lean, names)
    poses = np.array([v for place in tree.values() for v in (place.factor, place.shift)])
    run = _Descent([edges[k] for k in held], [given[k] for k in held], names, size, outvoted)
    poses = run.descend(poses, most_steps)
    weights[held], misfits[held] = run.robust, run.misfits(poses)
    for k, number in zip(held, run.chosen, strict=True):
        chosen[k] = number
    places = {name: Similarity(complex(poses[2 * i]), complex(poses[2 * i + 1])) for name, i in names.items()}
    return Solution(places, weights, misfits, run.usual, chosen, lean, names, run.factor)


class _Descent:
    """Robust Gauss-Newton, in which edges switch to the rivals that the poses bear out."""

    def __init__(self, edges: list[Edge], given: list[Edge], names: Mapping[str, int], size: tuple[int, int],
                 outvoted: float) -> None:
        self._edges, self._own, self._given = list(edges), edges, given
        self._names, self._size, self._outvoted = names, size, outvoted
        self._system = _System(edges, names, size)
        self.chosen = [0] * len(edges)
        self.robust, self.usual = np.ones(len(edges)), 1.0
        self._calm = False  # no edge contradicts the others
        self.factor: SuperLU | None = None

    def descend(self, poses: Complexes, most_steps: int) -> Complexes:
        """The poses of least squares, from some, in so many steps at most."""
        power = self._system.precision
        for turn in range(most_steps):
            residual, matrix = self._system.linear(poses)
            power = self._weigh(residual, turn)
            weighted = _weighted(matrix, power)
            factor = factored(weighted @ matrix)
            step = np.concatenate([np.zeros(2, np.complex128), -factor.solve(weighted @ residual)])
            poses = poses + step
            switched = self._system.redundant and turn >= 2 and self._switch(poses)
            settled = turn > (2 + WIDENED if self._system.redundant and not self._calm else 3) and not switched
            if settled and float(np.abs(step[1::2]).max()) < CONVERGED:
                break
        _, matrix = self._system.linear(poses)
        self.factor = factored(_weighted(matrix, self._system.honest * self.robust) @ matrix)
        return poses

    def _weigh(self, residual: Complexes, turn: int) -> Floats:
        """Weights of the edges by their residuals; all have full weight at first, since robust ones need approximate
        poses."""
        claimed = np.sqrt((np.abs(residual.reshape(-1, 2)) ** 2).sum(axis=1) * self._system.precision / 4)
        if not self._system.redundant:
            return self._system.precision
        self.usual = max(1.0, float(np.median(claimed)) / 0.92)
        if turn > 1:
            final = self._outvoted * self.usual
            self._calm = self._calm if turn > 2 else float(claimed.max()) < CONVEX * final
            scale = final * (1.0 if self._calm else 2.0 ** max(0, WIDENED - (turn - 1)))
            self.robust = np.asarray(1 / (1 + (claimed / scale) ** 2) ** 2, np.float64)
        return self._system.precision * self.robust

    def _switch(self, poses: Complexes) -> bool:
        """Let each edge with rivals take part by the motion that fits the poses best; returns whether one changed."""
        changed = False
        for k, edge in enumerate(self._given):
            if not edge.rivals:
                continue
            i, j = self._names[edge.frame_a], self._names[edge.frame_b]
            fa, ta, fb, tb = poses[2 * i], poses[2 * i + 1], poses[2 * j], poses[2 * j + 1]
            off = []
            for number in range(len(edge.rivals) + 1):
                s, middle = ((edge.similarity, edge.middle) if number == 0 else
                             (edge.rivals[number - 1].similarity, edge.rivals[number - 1].middle))
                at = complex(*middle)
                off.append(abs((fa * at + ta - tb) / fb - (s.factor * at + s.shift)))
            best = int(np.argmin(off))
            if best != self.chosen[k] and off[best] < 0.7 * off[self.chosen[k]]:
                self.chosen[k], changed = best, True
                self._edges[k] = self._given[k].switched(best) if best else self._own[k]
        if changed:
            self._system, self._calm = _System(self._edges, self._names, self._size), False
        return changed

    def misfits(self, poses: Complexes) -> Floats:
        """Of the edges, pixels of frame b."""
        residual, _ = self._system.linear(poses)
        return np.asarray(np.sqrt((np.abs(residual.reshape(-1, 2)) ** 2).sum(axis=1) / 2), np.float64)


class _System:
    """The edges as arrays; residuals and their derivatives at given poses."""

    def __init__(self, edges: Sequence[Edge], names: Mapping[str, int], size: tuple[int, int]) -> None:
        self.a = np.array([names[edge.frame_a] for edge in edges])
        self.b = np.array([names[edge.frame_b] for edge in edges])
        self.middle = np.array([complex(*edge.middle) for edge in edges])
        least = LEAST_SPREAD * max(size)
        self.spread = np.array([max(edge.spread_px, least) for edge in edges])
        self.factor = np.array([edge.similarity.factor for edge in edges])
        self.seen = np.array([edge.similarity.factor * complex(*edge.middle) + edge.similarity.shift
                              for edge in edges])
        self.precision = np.array([precision(edge) for edge in edges])
        centre = np.array([complex(*edge.centre) for edge in edges])
        moved = np.abs(self.factor * centre + np.array([edge.similarity.shift for edge in edges]) - centre)
        self.honest = 1 / (1 / self.precision + (PARALLAX * moved) ** 2)
        self.unknowns = 2 * len(names)
        self.redundant = len(edges) > len(names) - 1
        # The derivatives by the poses change with these, their places in the matrix do not.
        count = len(edges)
        even, odd = 2 * np.arange(count), 2 * np.arange(count) + 1
        rows = np.concatenate([even, even, even, even, odd, odd])
        columns = np.concatenate([2 * self.a, 2 * self.a + 1, 2 * self.b, 2 * self.b + 1, 2 * self.a, 2 * self.b]) - 2
        free = np.flatnonzero(columns >= 0)
        self._pattern = csc_matrix((free, (rows[free], columns[free])), shape=(2 * count, self.unknowns - 2))

    def linear(self, poses: Complexes) -> tuple[Complexes, csc_matrix]:
        """Residuals (2 an edge), pixels, and their derivatives by all poses but the first."""
        fa, ta, fb, tb = poses[2 * self.a], poses[2 * self.a + 1], poses[2 * self.b], poses[2 * self.b + 1]
        there = (fa * self.middle + ta - tb) / fb
        residual = np.stack([there - self.seen, self.spread * (fa / fb - self.factor)], axis=1).ravel()
        values = np.concatenate([self.middle / fb, 1 / fb, -there / fb, -1 / fb,
                                 self.spread / fb, -self.spread * fa / fb**2])
        found = self._pattern
        return residual, csc_matrix((values[found.data], found.indices, found.indptr), shape=found.shape)


def _weighted(matrix: csc_matrix, power: Floats) -> csc_matrix:
    """The conjugate transpose of derivatives, the columns of each edge multiplied by its weight."""
    values = matrix.data.conj() * np.repeat(power, 2)[matrix.indices]
    return csr_matrix((values, matrix.indices, matrix.indptr), shape=matrix.shape[::-1]).tocsc()
