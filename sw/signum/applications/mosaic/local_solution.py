# SPDX-License-Identifier: Apache-2.0
"""Least squares on a part of a component: places around a new frame, and how well one frame is known from another.

Both cost the same whatever the size of the whole. Around a frame, the frames outside of the part stay where they are:
they become one frame, the ground, whose pixels are the plane. An edge from an outer frame a with pose f p + t to a
frame b of the part has the residual of an edge from the ground to b with its centroid at f c + t, |f| times its spread
and the similarity S after the pose's inverse; it is measured in pixels of b as before. One to an outer frame is turned
round first. Edges are levelled before (`level`), by the tilts that the frames of the part and around it show.

How well frames are known from one another is taken from a part that contains both: edges that are left out can only add
to what is known, so that the deviation is at most too large.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from signum.applications.mosaic.edges import Edge
from signum.applications.mosaic.graph import Solution, solve_graph
from signum.applications.mosaic.level import level, tilts
from signum.applications.mosaic.nearby import ball, edges_among
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.registration import UNKNOWN

GROUND = "\0"
"""Stands for all frames outside of a part; no frame has this name."""
WINDOW = 24
"""Frames that are placed again after a new one."""
WIDE = 4
"""By this factor more are, where the first are moved at their border."""
MOVED_PX = 2.0
"""Distance at the border from which more frames are placed again, pixels."""
BETWEEN = 128
"""Most frames of a part that contains two frames."""
STEPS = 3
"""Gauss-Newton steps on that part, whose frames are in place: as many as robust weights take."""


def solve_window(links: Mapping[str, Sequence[Edge]], places: Mapping[str, Similarity], fixed: str, name: str,
                 most: int, size: tuple[int, int], outvoted: float) -> tuple[dict[str, Similarity], float]:
    """Place the frames around one again, all others staying where they are.

    Args:
        links: accepted edges by frame.
        places: pixels of the component's frames -> plane.
        fixed: the frame whose pixels are the plane.
        name: the frame.
        most: frames that are placed.
        size: width and height of the frames, pixels.
        outvoted: see `solve_graph`.

    Returns:
        The places, and by how much the frames with edges to others were moved at most, pixels.
    """
    inside = dict.fromkeys(other for other in ball(links, name, most) if other != fixed)
    around = [edge for here in inside for edge in links[here]
              if edge.frame_a == here or edge.frame_a not in inside]
    edges, border = [], set()
    for edge in level(around, tilts(around, size)):
        edge = replace(edge, shear=(0.0, 0.0), shear_error=UNKNOWN)  # it is levelled
        if edge.frame_a in inside and edge.frame_b in inside:
            edges.append(edge)
        else:
            here, other = ((edge.frame_a, edge.frame_b) if edge.frame_a in inside else (edge.frame_b, edge.frame_a))
            border.add(here)
            edges.append(grounded(edge if edge.frame_a == other else turned(edge), places[other]))
    start = {GROUND: IDENTITY, **{here: places[here] for here in inside}}
    solved = solve_graph(GROUND, edges, size, start, outvoted).places
    middle = np.array([(size[0] - 1) / 2, (size[1] - 1) / 2])
    moved = max((float(np.hypot(*(solved[here](middle) - places[here](middle)))) for here in border if here != name),
                default=0.0)
    return {here: solved[here] for here in inside}, moved


def grounded(edge: Edge, place: Similarity) -> Edge:
    """An edge as one from the ground, its first frame being at a place: pixels -> plane."""
    x, y = place(np.array(edge.middle))
    return replace(edge, frame_a=GROUND, similarity=edge.similarity @ place.inverse, middle=(float(x), float(y)),
                   spread_px=edge.spread_px * place.scale, rivals=())


def turned(edge: Edge) -> Edge:
    """An edge the other way round."""
    x, y = edge.similarity(np.array(edge.middle))
    return replace(edge, frame_a=edge.frame_b, frame_b=edge.frame_a, similarity=edge.similarity.inverse,
                   middle=(float(x), float(y)), spread_px=edge.spread_px * edge.similarity.scale,
                   rms_px=edge.rms_px / edge.similarity.scale, rivals=())


class Knowledge:
    """How well the places of some frames are known from one frame.

    Args:
        links: accepted edges by frame.
        places: pixels of the component's frames -> plane.
        name: the frame.
        others: the frames asked for.
        size, outvoted: see `solve_graph`.
        whole: a solution of the whole, if there is one, perhaps without the newest frames.

    Attributes:
        usual: see `Solution`.
    """

    def __init__(self, links: Mapping[str, Sequence[Edge]], places: Mapping[str, Similarity], name: str,
                 others: Sequence[str], size: tuple[int, int], outvoted: float, whole: Solution | None) -> None:
        around = ball(links, name, BETWEEN, others)
        self._places, self._whole = places, whole
        self._near = solve_graph(name, edges_among(links, around), size, {here: places[here] for here in around},
                                 outvoted, STEPS)
        self.usual = self._near.usual
        self._stay = next((here for here in around if whole is not None and here in whole.places), None)

    def deviation(self, a: str, b: str, at: tuple[float, float]) -> float | None:
        """Standard deviation of where the point `at` of a is seen in b, one of them the frame, each axis, pixels of b;
        None if a solution of the whole is needed to tell."""
        if a in self._near.places and b in self._near.places:
            return self._near.deviation(a, b, at)
        whole, stay = self._whole, self._stay
        if whole is None or stay is None or (a not in whole.places and b not in whole.places):
            return None
        x, y = (self._places[stay].inverse @ self._places[a])(np.array(at))
        parts = [solution.deviation(one, other, spot) for solution, one, other, spot in (
            (whole if a in whole.places else self._near, a, stay, at),
            (whole if b in whole.places else self._near, stay, b, (float(x), float(y)))) if one != other]
        return math.hypot(*parts)
