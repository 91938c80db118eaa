# SPDX-License-Identifier: Apache-2.0
"""The graph's verdict on accepted edges, once all are measured: those that the others contradict are refused.

An edge that lost its weight has no part in the poses, and says so in `edges.csv`. Where another motion of the same pair
took its place, that is noted as an edge of its own. An edge without which frames would not hang together stays.
"""

from __future__ import annotations

from dataclasses import replace

from signum.applications.mosaic.edges import Edge
from signum.applications.mosaic.graph import chain
from signum.applications.mosaic.ledger import Ledger, Piece

CONTRADICTED = 0.1
"""Weight below which an edge is refused: its misfit is 1.5 times that at which it has a quarter."""
CONTRADICTS = "the other edges contradict it"
SWITCHED = "the other edges bear out another motion of this pair"


def revise(ledger: Ledger, piece: Piece) -> int:
    """Refuse what the latest solution of a component contradicts; returns how many edges."""
    solution = piece.solution
    edges = ledger.edges_of(piece)
    if solution is None or len(solution.weights) != len(edges):
        return 0
    kept: list[Edge] = []
    doubtful: list[tuple[Edge, Edge | None, str]] = []
    for edge, weight, number in zip(edges, solution.weights.tolist(), solution.chosen, strict=True):
        if weight < CONTRADICTED:
            doubtful.append((edge, None, CONTRADICTS))
        elif number:
            kept.append(edge.switched(number))
            doubtful.append((edge, kept[-1], SWITCHED))
        else:
            kept.append(edge)
    reached = chain(piece.stored[0], kept)
    count = 0
    for edge, instead, reason in doubtful:
        if instead is None and not (edge.frame_a in reached and edge.frame_b in reached):
            continue
        ledger.revise(edge, replace(edge, accepted=False, reason=reason))
        if instead is not None:
            ledger.note(instead)
        count += 1
    return count
