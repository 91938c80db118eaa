# SPDX-License-Identifier: Apache-2.0
"""Three ways to place frames by the same edges, for comparison: two chains of the paper, and least squares."""

from __future__ import annotations

from collections.abc import Callable

from signum.applications.mosaic.edges import SEQUENCE
from signum.applications.mosaic.graph import chain
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.pose import Pose
from signum.geometry.similarity import Similarity


def by_sequence(ledger: Ledger, piece: Piece) -> list[Pose]:
    """(a) Each stored frame by its edge to the one before; empty if the sequence does not reach them all."""
    edges = [edge for edge in ledger.edges_of(piece) if edge.kind == SEQUENCE]
    return _poses(ledger, piece, chain(piece.stored[0], edges))


def by_neighbours(ledger: Ledger, piece: Piece) -> list[Pose]:
    """(b) Each by the fewest edges from the first frame, across columns where there are such edges."""
    return _poses(ledger, piece, chain(piece.stored[0], ledger.edges_of(piece)))


def by_all(ledger: Ledger, piece: Piece) -> list[Pose]:
    """(c) All frames by all edges, by least squares."""
    return _poses(ledger, piece, piece.places)


def _poses(ledger: Ledger, piece: Piece, places: dict[str, Similarity]) -> list[Pose]:
    if len(places) < len(piece.stored):
        return []
    return [Pose.of(name, places[name], ledger.centre) for name in piece.stored]


WAYS: dict[str, Callable[[Ledger, Piece], list[Pose]]] = {
    "sequence only": by_sequence, "fewest links": by_neighbours, "all links": by_all}
"""The ways by their names in `accuracy.csv`."""
