# SPDX-License-Identifier: Apache-2.0
"""Takes out of edges what cameras that do not look straight down put into their rotation and scale.

A camera tilted by small angles sees a level floor with a scale that changes over the picture: what it would show if it
were level is at p / (1 + a.p), in pixels p from the picture's centre; a, per pixel, points to where the floor is
nearest, and is the tilt in radians over the focal length. Near the point c of the frame this multiplies what is
seen by a similarity and adds a shear: with complex numbers the derivative is

    1 - m(a, c)   for dp,   m(a, c) = Re(conj(a) c) + c conj(a) / 2,
    - a c / 2     for conj(dp).

So between two frames, with the overlap's middle at c and d from their centres, an edge has the shear
g = (F~ d b - F c a) / 2 (F the rotation and scale, F~ its conjugate), which windows show, and the factor
F (1 + m(b, d) - m(a, c)), which would turn tilt into heading and height. Of this the registration of a floor that
slopes has already taken out what the slope adds along the baseline's direction u, u u g~ (`measure.surface`): relief is
local, and no tilt. What remains is the tilt's. The shears of all edges determine the tilt of each frame by linear least
squares, with a prior: a vehicle is tilted by a few degrees, in part by a constant. A floor that slopes all over does
the same as a tilt, and is taken out as one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csc_matrix, diags_array

from signum.applications.mosaic.edges import Edge
from signum.applications.mosaic.sparse import factored
from signum.geometry.similarity import Similarity
from signum.measure.refine import baseline

COMMON = 0.08
"""Standard deviation of the tilt that all frames share, over the focal length; the frame's width stands for that."""
OWN = 0.03
"""Standard deviation of a frame's own, the same."""
RELIEF = 0.02
"""Standard deviation of a shear that relief makes, each way: tilts leave 0.012 of an overlap in Skerki and IMOS, and
about three edges that see the same floor have the same error and count as one."""


def tilts(edges: Sequence[Edge], size: tuple[int, int]) -> dict[str, complex]:
    """The tilt of each frame of edges with a shear, per pixel: towards where the floor is nearest.

    Args:
        edges: accepted ones.
        size: width and height of the frames, pixels.
    """
    told = [edge for edge in edges if edge.sheared]
    names = {name: k for k, name in enumerate(dict.fromkeys(n for e in told for n in (e.frame_a, e.frame_b)))}
    if not told:
        return {}
    width, count = float(max(size)), len(names)
    centre = complex(*told[0].centre)
    factor = np.array([e.similarity.factor for e in told])
    middle = np.array([complex(*e.middle) for e in told])
    seen = factor * middle + np.array([e.similarity.shift for e in told]) - centre
    shear = np.array([complex(*e.shear) for e in told])
    deviation = np.hypot([e.shear_error for e in told], RELIEF)
    # Unknowns: tilt times width; the last is what all share.
    rows = np.repeat(np.arange(len(told)), 2)
    columns = np.array([(names[e.frame_a], names[e.frame_b]) for e in told]).ravel()
    of_a = -(middle - centre) * factor / 2
    of_b = seen * factor.conj() / 2
    values = np.stack([of_a, of_b], axis=1) / width / deviation[:, None]
    matrix = csc_matrix((values.ravel(), (rows, columns)), shape=(len(told), count + 1))
    prior = csc_matrix((np.concatenate([np.full(count, 1.0), np.full(count, -1.0)]),
                        (np.tile(np.arange(count), 2), np.concatenate([np.arange(count), np.full(count, count)]))),
                       shape=(count, count + 1)) / OWN
    last = np.zeros(count + 1)
    last[count] = 1 / COMMON**2
    normal = matrix.conj().T @ matrix + prior.T @ prior + diags_array(last)
    found = factored(csc_matrix(normal, dtype=np.complex128)).solve(matrix.conj().T @ (shear / deviation))
    return {name: complex(found[k]) / width for name, k in names.items()}


def level(edges: Sequence[Edge], lean: Mapping[str, complex]) -> list[Edge]:
    """The edges with the rotation and scale that level cameras would have measured.

    The place where the overlap's middle was seen stays: where the slope is the relief's, a tilt would move it wrongly.

    Args:
        edges: any.
        lean: tilts of frames; 0 for those that are not in it.
    """
    return [_level(edge, lean.get(edge.frame_a, 0j), lean.get(edge.frame_b, 0j)) for edge in edges]


def _level(edge: Edge, a: complex, b: complex) -> Edge:
    if a == 0 and b == 0:
        return edge
    centre, middle, s = complex(*edge.centre), complex(*edge.middle), edge.similarity
    seen = s.factor * middle + s.shift
    factor = s.factor
    if edge.sheared and edge.sloping:
        way, _ = baseline(s, edge.centre)
        factor += way**2 * _shear(s.factor, a, b, middle - centre, seen - centre).conjugate()
    factor /= 1 + _slope(b, seen - centre) - _slope(a, middle - centre)
    return replace(edge, similarity=Similarity(factor, seen - factor * middle))


def _shear(factor: complex, a: complex, b: complex, c: complex, d: complex) -> complex:
    """g of the module's text."""
    return (factor.conjugate() * d * b - factor * c * a) / 2


def _slope(a: complex, p: complex) -> complex:
    """m(a, p) of the module's text."""
    return (a.conjugate() * p).real + p * a.conjugate() / 2
