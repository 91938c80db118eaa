# SPDX-License-Identifier: Apache-2.0
"""Which frames of a component are near one another, found without a look at all of them: in the plane, and by edges."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Mapping, Sequence

from signum.applications.mosaic.edges import Edge
from signum.geometry.similarity import Similarity


class CentreGrid:
    """The centres of placed frames in square cells of the plane, as wide as a frame's diagonal.

    Args:
        size: width and height of the frames, pixels.

    Attributes:
        at: centre of each frame, pixels of the plane.
        diagonal: of a frame, pixels.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        self._middle = complex((size[0] - 1) / 2, (size[1] - 1) / 2)
        self.diagonal = math.hypot(*size)
        self.at: dict[str, complex] = {}
        self._cells: dict[tuple[int, int], dict[str, None]] = {}

    def put(self, name: str, place: Similarity) -> None:
        """Note where a frame is: its pixels -> plane."""
        at = place.factor * self._middle + place.shift
        before = self.at.get(name)
        self.at[name] = at
        cell = self._cell(at)
        if before is not None:
            old = self._cell(before)
            if old == cell:
                return
            del self._cells[old][name]
            if not self._cells[old]:
                del self._cells[old]
        self._cells.setdefault(cell, {})[name] = None

    def near(self, at: complex, reach: float) -> list[str]:
        """The frames whose centre is at most `reach` pixels from a point in x and in y, in no particular order."""
        low, high = self._cell(at - complex(reach, reach)), self._cell(at + complex(reach, reach))
        return [name for x in range(low[0], high[0] + 1) for y in range(low[1], high[1] + 1)
                for name in self._cells.get((x, y), ())
                if max(abs(self.at[name].real - at.real), abs(self.at[name].imag - at.imag)) <= reach]

    def _cell(self, at: complex) -> tuple[int, int]:
        return math.floor(at.real / self.diagonal), math.floor(at.imag / self.diagonal)


def ball(links: Mapping[str, Sequence[Edge]], start: str, most: int, wanted: Iterable[str] = ()) -> list[str]:
    """The frames around one, breadth first along its edges.

    Args:
        links: edges by frame.
        start: the frame, which is the first of the list.
        most: frames.
        wanted: if any are named, the list ends with the frames one edge beyond the last of these.
    """
    missing = set(wanted) - {start}
    ends = bool(missing)
    depth, queue, last = {start: 0}, deque([start]), math.inf
    while queue and depth[queue[0]] <= last:
        name = queue.popleft()
        for edge in links.get(name, ()):
            other = edge.frame_b if edge.frame_a == name else edge.frame_a
            if other in depth:
                continue
            if len(depth) == most:
                return list(depth)
            depth[other] = depth[name] + 1
            queue.append(other)
            missing.discard(other)
            if ends and not missing:
                last = min(last, depth[other])
    return list(depth)


def edges_among(links: Mapping[str, Sequence[Edge]], names: Iterable[str]) -> list[Edge]:
    """The edges whose frames are both among these."""
    here = dict.fromkeys(names)
    return [edge for name in here for edge in links.get(name, ()) if edge.frame_a == name and edge.frame_b in here]
