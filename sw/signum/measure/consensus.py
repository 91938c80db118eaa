# SPDX-License-Identifier: Apache-2.0
"""What the displacements of many overlapping windows have in common, place by place.

Under snow or over weak texture many a window finds a chance match, each another one. Those that are right agree with
their neighbours. A place takes its own displacement where enough of the neighbourhood supports it, else the one nearby
with the most support, and a plane fitted to the displacements like it: noise is averaged, and turns, zooms and slopes
are kept. A place that measured something else by itself is refused, not overruled: something small may move there.

What turns or zooms as a whole, as a camera's view does, is taken out before, and put back: within a neighbourhood only
what remains must be alike.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats

Flags = NDArray[np.bool_]
Field = NDArray[np.float32]
AFAR = 1e6
"""Displacement of a place that has none, pixels: like no other."""
FEWEST = 0.7
"""Share of a neighbourhood that counts where less of it lies on the grid: in a corner a single false match, found by
all windows that hold it, would have support enough."""
ROUNDS = 2
"""Times that a place's displacement moves to the mean of those like it, before the plane is fitted."""
SCALES_PX = 16.0, 8.0, 4.0, 2.0, 1.0, 1.0
"""Residuals beyond which displacements count less in the motion of the whole, round by round."""
STEADY = 20.0
"""Slopes are held near 0 as by this many places at the neighbourhood's edge."""


@dataclass(frozen=True)
class ConsensusRules:
    """How places agree.

    Attributes:
        like_px: largest difference of displacements that are like one another.
        support: share of the neighbourhood that must have like displacements.
        majority: share of the neighbours with a displacement that must have a like one: two motions that are about
            equally frequent leave open which is the place's.
        contrary_px: difference from which what a place measured by itself is something else.
    """

    like_px: float = 0.75
    support: float = 0.3
    majority: float = 0.5
    contrary_px: float = 2.0


class _Around:
    """The neighbourhood of every place of a grid (ny, nx): places at most `reach` away, every `stride`-th.

    `count` is how many of them lie on the grid, but no fewer than FEWEST.
    """

    def __init__(self, shape: tuple[int, int], reach: int, stride: int) -> None:
        self.shape, self.pad = shape, reach // stride * stride
        span = range(-self.pad, self.pad + 1, stride)
        self.steps = sorted(((j, i) for j in span for i in span), key=lambda at: at[0] ** 2 + at[1] ** 2)
        self.count = np.zeros(shape, np.float32)
        for _, _, (there,) in self.views((np.ones(shape), 0)):
            self.count += there
        self.count = np.maximum(self.count, FEWEST * len(self.steps))

    def views(self, *fields: tuple[NDArray[np.generic], float]) -> Iterator[tuple[int, int, list[NDArray[np.float32]]]]:
        """For each neighbour, nearest first, its place and the fields shifted there; a field goes on as the number
        given with it."""
        padded = [np.pad(np.asarray(field, np.float32), self.pad, constant_values=beyond) for field, beyond in fields]
        ny, nx = self.shape
        for j, i in self.steps:
            yield j, i, [f[self.pad + j:self.pad + j + ny, self.pad + i:self.pad + i + nx] for f in padded]


def agree_around(dx: Floats, dy: Floats, measured: Flags, sure: Flags, reach: int, stride: int = 1,
                 rules: ConsensusRules | None = None) -> tuple[Flags, Floats, Floats]:
    """The displacements of a grid that their neighbourhoods support.

    Args:
        dx, dy: (ny, nx) displacements, pixels.
        measured: (ny, nx) which of them were measured.
        sure: (ny, nx) which of these are not to be overruled.
        reach: how far the neighbourhood goes, places of the grid.
        stride: takes every so many places of it.
        rules: how places agree.

    Returns:
        Which places are valid, and their displacements, (ny, nx) each.
    """
    rules = rules or ConsensusRules()
    around = _Around((dx.shape[0], dx.shape[1]), reach, stride)
    u_whole, v_whole = (_of_whole(d, measured) for d in (dx, dy))
    u, v = (np.where(measured, d, AFAR).astype(np.float32) for d in (dx - u_whole, dy - v_whole))
    share = _support(around, u, v, u, v, rules.like_px)
    share = np.where(measured, share, 0).astype(np.float32)
    own = share >= rules.support
    best, u_best, v_best = share.copy(), u.copy(), v.copy()
    for _, _, (near, u_near, v_near) in around.views((share, 0), (u, AFAR), (v, AFAR)):
        better = near > best
        best, u_best, v_best = (np.where(better, new, old) for new, old in (
            (near, best), (u_near, u_best), (v_near, v_best)))
    u_mean, v_mean = (np.where(own, d, np.where(best > 0, d_best, -AFAR)).astype(np.float32)
                      for d, d_best in ((u, u_best), (v, v_best)))
    for _ in range(ROUNDS):
        u_mean, v_mean = _mean(around, u, v, u_mean, v_mean, rules.like_px)
    support = _support(around, u, v, u_mean, v_mean, rules.like_px)
    enough = np.maximum(rules.support, rules.majority * _share(around, measured))
    u_fit, v_fit = _planes(around, u, v, u_mean, v_mean, rules.like_px)
    contrary = sure & (np.hypot(u - u_fit, v - v_fit) > rules.contrary_px)
    return np.asarray((support >= enough) & ~contrary), u_fit + u_whole, v_fit + v_whole


def _of_whole(d: Floats, measured: Flags) -> Floats:
    """One component of the motion that the whole grid has: a plane through most of the measured displacements."""
    y, x = (at / max(d.shape) for at in np.indices(d.shape))
    terms = np.stack([np.ones(d.shape), x, y])
    known, values = terms[:, measured], d[measured]
    if values.size < terms.shape[0]:
        return np.zeros(d.shape)
    plane = np.array([np.median(values), 0.0, 0.0])
    for scale in SCALES_PX:
        weight = 1 / (1 + ((values - plane @ known) / scale) ** 2) ** 2
        normal = (weight * known) @ known.T + 1e-6 * np.eye(3)
        plane = np.linalg.solve(normal, (weight * known) @ values)
    return np.asarray(np.tensordot(plane, terms, 1))


def _share(around: _Around, places: Flags) -> Field:
    """Share of each place's neighbours on the grid that are among these places."""
    among = np.zeros(around.shape, np.float32)
    for _, _, (near,) in around.views((places, 0)):
        among += near
    return among / around.count


def _support(around: _Around, u: Field, v: Field, u0: Field, v0: Field, like_px: float) -> Field:
    """Share of each place's neighbours on the grid whose displacements (u, v) are like its (u0, v0)."""
    like = np.zeros(around.shape, np.float32)
    for _, _, (near_u, near_v) in around.views((u, AFAR), (v, AFAR)):
        like += (near_u - u0) ** 2 + (near_v - v0) ** 2 <= like_px**2
    return like / around.count


def _mean(around: _Around, u: Field, v: Field, u0: Field, v0: Field, like_px: float) -> tuple[Field, Field]:
    """Mean of the neighbours' displacements that are like each place's (u0, v0)."""
    count, du, dv = (np.zeros(around.shape, np.float32) for _ in range(3))
    for _, _, (near_u, near_v) in around.views((u, AFAR), (v, AFAR)):
        a, b = near_u - u0, near_v - v0
        like = a * a + b * b <= like_px**2
        count += like
        du += np.where(like, a, 0)
        dv += np.where(like, b, 0)
    count = np.maximum(count, 1)
    return u0 + du / count, v0 + dv / count


def _planes(around: _Around, u: Field, v: Field, u0: Field, v0: Field, like_px: float) -> tuple[Floats, Floats]:
    """Least-squares planes through the neighbours' displacements that are like (u0, v0), at each place."""
    sums = np.zeros((12, *around.shape), np.float32)
    for j, i, (near_u, near_v) in around.views((u, AFAR), (v, AFAR)):
        a, b = near_u - u0, near_v - v0
        like = (a * a + b * b <= like_px**2).astype(np.float32)
        a, b = np.where(like, a, 0), np.where(like, b, 0)
        for n, term in enumerate((like, like * j, like * i, like * (j * j), like * (i * j), like * (i * i),
                                  a, a * j, a * i, b, b * j, b * i)):
            sums[n] += term
    normal = sums[[[0, 1, 2], [1, 3, 4], [2, 4, 5]]].transpose(2, 3, 0, 1).astype(np.float64)
    normal += np.diag([1e-9, STEADY * around.pad**2, STEADY * around.pad**2])
    u_fit, v_fit = (np.linalg.solve(normal, sums[k:k + 3].transpose(1, 2, 0).astype(np.float64)[..., None])[..., 0, 0]
                    for k in (6, 9))
    return u0 + u_fit, v0 + v_fit
