# SPDX-License-Identifier: Apache-2.0
"""Views of a board: found in the frames of one camera or two, and chosen so that no two are alike."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, zip_longest

import numpy as np

from signum.applications.calibrate.target import LEAST_CORNERS, Sighting, SquareBoard
from signum.common.arrays import Floats
from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source, size_text

MOST_LOOKED_AT = 400
"""Frames in which the board is looked for; of more, evenly many are left out."""
ALIKE = 0.03
"""Views whose outlines differ nowhere by more than this share of the picture's width count as one."""


@dataclass(frozen=True, eq=False)
class BoardView:
    """A frame, of a pair of cameras with the other's of the same moment, in which the board was looked for.

    Attributes:
        frame: its name.
        size: width and height of the pictures, pixels.
        seen: by each camera, None where the board was not found.
    """

    frame: str
    size: tuple[int, int]
    seen: tuple[Sighting | None, ...]

    @property
    def shared(self) -> tuple[Sighting, Sighting] | None:
        """The corners that both cameras see; None if they are too few."""
        if len(self.seen) < 2 or self.seen[0] is None or self.seen[1] is None:
            return None
        ids = np.intersect1d(self.seen[0].ids, self.seen[1].ids)
        if len(ids) < LEAST_CORNERS:
            return None
        one, two = self.seen[0].only(ids), self.seen[1].only(ids)
        if min(np.ptp(one.points[:, 0]), np.ptp(one.points[:, 1])) <= 0:
            return None
        return one, two


def look(target: SquareBoard, sources: Sequence[Source]) -> Iterator[tuple[BoardView, tuple[Frame, ...]]]:
    """The views of a board, one for each frame that is looked at, with the frames.

    Args:
        target: the board.
        sources: frames of one camera, or of two, of the same moments in the same order.

    Raises:
        SourceError: if frames differ in number or, of one camera, in size.
    """
    for frames in islice(zip_longest(*sources), 0, None, _step(sources[0])):
        if any(frame is None for frame in frames):
            short = sources[[frame is None for frame in frames].index(True)]
            raise SourceError(f"{short.label}: fewer frames than the other camera's: give frames of the same moments")
        if len({frame.size for frame in frames}) > 1:
            raise SourceError(f"frame {frames[0].name} is {size_text(frames[0].size)}, its right one "
                              f"{size_text(frames[1].size)}: both cameras must give pictures of one size")
        seen = [target.find(frame.grey) for frame in frames]
        yield BoardView(frames[0].name, frames[0].size, tuple(_alike(seen))), frames


def frames_looked_at(source: Source) -> int | None:
    """How many of a source's frames `look` gives; None if it is not known."""
    return None if source.count is None else -(-source.count // _step(source))


def _step(source: Source) -> int:
    return max(1, -(-(source.count or 0) // MOST_LOOKED_AT))


def _alike(seen: list[Sighting | None]) -> list[Sighting | None]:
    """Sightings with corners numbered from the same end: a chessboard may be read from the other one."""
    one, *others = seen
    if one is None or not others or others[0] is None or len(one.ids) != len(others[0].ids):
        return seen
    other = others[0]
    if np.dot(one.corners[-1] - one.corners[0], other.corners[-1] - other.corners[0]) < 0:
        other = Sighting(other.ids, other.points, other.corners[::-1])
    return [one, other]


def choose(outlines: Sequence[Floats], width: int, most: int) -> list[int]:
    """Numbers of the views that differ most from each other, in their order.

    Args:
        outlines: of each view, pixels (4, 2); place, size and tilt of the board show in it.
        width: of the pictures, pixels.
        most: how many to choose at most.
    """
    where = np.array([np.asarray(o).ravel() / width for o in outlines])
    if not len(where):
        return []
    chosen = [int(np.argmin(np.abs(where - np.median(where, 0)).max(1)))]
    apart = np.abs(where - where[chosen[0]]).max(1)
    while len(chosen) < most and apart.max() > ALIKE:
        chosen.append(int(np.argmax(apart)))
        apart = np.minimum(apart, np.abs(where - where[chosen[-1]]).max(1))
    return sorted(chosen)
