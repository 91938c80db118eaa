"""The three ways of the paper and after it to place frames by the same links: what least squares gains over chains."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from signum.applications.mosaic.edges import SEQUENCE
from signum.applications.mosaic.graph import chain
from signum.applications.mosaic.ledger import Piece
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.survey import Survey
from signum.geometry.similarity import Similarity


def by_sequence(survey: Survey, piece: Piece) -> list[Pose]:
    """(a) Each stored frame by its link to the one before; empty where the sequence does not reach them all."""
    links = [link for link in survey.links_of(piece) if link.kind == SEQUENCE]
    return _poses(survey, piece, chain(piece.stored[0], links))


def by_neighbours(survey: Survey, piece: Piece) -> list[Pose]:
    """(b) Each by as few links from the first frame as there are: across columns where they are linked."""
    return _poses(survey, piece, chain(piece.stored[0], survey.links_of(piece)))


def by_all(survey: Survey, piece: Piece) -> list[Pose]:
    """(c) All by all links, least squares."""
    return _poses(survey, piece, piece.places)


def _poses(survey: Survey, piece: Piece, places: dict[str, Similarity]) -> list[Pose]:
    if len(places) < len(piece.stored):
        return []
    out = []
    for name in piece.stored:
        x, y = places[name](np.array(survey.centre))
        out.append(Pose(name, float(x), float(y), places[name].rot_deg, places[name].scale))
    return out


WAYS: dict[str, Callable[[Survey, Piece], list[Pose]]] = {
    "sequence only": by_sequence, "fewest links": by_neighbours, "all links": by_all}
"""By what they are called in `accuracy.csv`."""
