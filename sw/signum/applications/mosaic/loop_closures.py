# SPDX-License-Identifier: Apache-2.0
"""Finds loop closures: edges between frames that are not consecutive, in one component or between two."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from signum.applications.mosaic.edges import JOIN, LOOP, Edge
from signum.applications.mosaic.graph import precision
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.likelihood import surprise
from signum.applications.mosaic.revise import revise
from signum.geometry.similarity import IDENTITY, Similarity, overlap
from signum.measure.register import Rival


class Loops:
    """Proposes, measures and checks edges, and notes them in a ledger.

    Attributes:
        tried: pairs measured already, with the prediction used: pixels of the first -> of the second.
    """

    def __init__(self, ledger: Ledger) -> None:
        self._ledger, self._settings = ledger, ledger.settings
        self._registrar, self._centre, self._size = ledger.registrar, ledger.centre, ledger.size
        self.tried: dict[tuple[str, str], Similarity] = {}
        self._doubtful: list[Edge] = []

    def propose(self, piece: Piece, name: str, by: Edge | None = None) -> int:
        """Measure the edges of a frame that its predicted overlaps suggest; returns how many were accepted.

        Args:
            piece: the frame's.
            name: the frame.
            by: the edge that has just placed it, which is not yet in the solution.
        """
        wanted = []
        order = {stored: k for k, stored in enumerate(piece.stored)}
        here = piece.places[name]
        middle = here(np.array(self._centre))
        reach = math.hypot(*self._size) * here.scale
        for other in piece.stored:
            pair = (other, name) if order[other] < order[name] else (name, other)
            if other == name or (by is not None and other == by.frame_a) or pair in self.tried:
                continue
            there = piece.places[other]
            if float(np.abs(there(np.array(self._centre)) - middle).max()) > reach:
                continue
            share = overlap(piece.places[pair[1]].inverse @ piece.places[pair[0]], self._size)
            if share >= self._settings.overlap:
                wanted.append((share, pair))
        wanted.sort(key=lambda one: -one[0])
        # Edges to two frames that lie close together are redundant: those chosen come from all directions.
        near = self._settings.apart * min(self._size) * here.scale
        taken = [piece.places[partner](np.array(self._centre)) for partner in self._ledger.partners.get(name, ())
                 if partner in piece.places]
        room = self._settings.proposals
        found = 0
        for _, pair in wanted:
            at = piece.places[pair[0] if pair[1] == name else pair[1]](np.array(self._centre))
            if room and all(np.hypot(*(at - other)) >= near for other in taken):
                room -= 1
                if self._try(piece, pair, by):
                    taken.append(at)
                    found += 1
        return found

    def _try(self, piece: Piece, pair: tuple[str, str], by: Edge | None) -> bool:
        """Measure a proposed edge of a component; it is accepted if it agrees with the poses."""
        a, b = pair
        predicted = piece.places[b].inverse @ piece.places[a]
        point = self._common(predicted)
        deviation = self._deviation(piece, a, b, point, by)
        edge = self.measure(a, b, LOOP, predicted, deviation)
        self.tried[pair] = predicted
        self._ledger.note(edge)
        return edge.accepted

    def _common(self, predicted: Similarity) -> tuple[float, float]:
        """The centre of the overlap of two frames, pixels of a."""
        middle = (np.array(self._centre) + predicted.inverse(np.array(self._centre))) / 2
        return float(middle[0]), float(middle[1])

    def _deviation(self, piece: Piece, a: str, b: str, at: tuple[float, float], by: Edge | None) -> float:
        """Standard deviation of the prediction, pixels."""
        assert piece.solution is not None
        if by is None:
            return piece.solution.deviation(a, b, at)
        x, y = by.similarity.inverse((piece.places[b].inverse @ piece.places[a])(np.array(at)))
        known = piece.solution.deviation(a, by.frame_a, at) if a != by.frame_a else 0.0
        lever = math.dist((x, y), by.middle) / max(by.spread_px, 0.05 * max(self._size))
        return math.hypot(known, piece.solution.usual * math.hypot(1.0, lever) / math.sqrt(precision(by)))

    def measure(self, a: str, b: str, kind: str, predicted: Similarity, deviation: float) -> Edge:
        """Measure an edge around its prediction; of its motions that is taken which is the likeliest by its windows and
        its place, and refused if that is not likely enough."""
        settings = self._settings
        spread = math.hypot(deviation, settings.relief * max(self._size))
        reach = math.ceil(settings.gate * spread / max(self._registrar.fine.factor)) + 6
        near = reach <= settings.farthest
        reach = max(reach, self._registrar.limits.reach)
        result = self._ledger.register(a, b, predicted if near else None, reach if near else None)
        searched = reach * max(self._registrar.fine.factor) if near else 0.5 * max(self._size)
        edge = replace(Edge.of(a, b, kind, self._centre, result), reason="", accepted=True)
        motions: list[Edge | Rival] = [edge, *edge.rivals]
        odds = [motion.evidence + surprise(motion.similarity, predicted, motion.middle, spread, searched)
                for motion in motions]
        best = max(range(len(odds)), key=odds.__getitem__)
        edge = edge.switched(best)
        if edge.agreed < settings.agreed or odds[best] < settings.odds:
            point = np.array(edge.middle)
            miss = float(np.hypot(*(edge.similarity(point) - predicted(point))))
            far = edge.evidence >= settings.odds and edge.agreed >= settings.agreed
            edge = replace(edge, accepted=False, reason=(
                f"{miss:.0f} px off the place the other edges give it" if far else
                result.reason or f"only {edge.agreed} of {edge.tried} windows agree"))
        return edge

    def join(self, name: str) -> int:
        """Look for an edge from a frame of the last component to the others; returns how many were accepted."""
        late = self._ledger.piece_of(name)
        others = [(piece, other) for piece in self._ledger.pieces if piece is not late for other in piece.stored]
        # Where columns turn, the n-th frame after a break lies beside the n-th before it; some others are tried too.
        place = late.stored.index(name)
        beside = others[::-1][place : place + self._settings.joins // 2]
        spread = [others[round(i)] for i in np.linspace(0, len(others) - 1, self._settings.joins)]
        tried: set[str] = set()
        for piece, other in (*beside, *spread):
            full = len(tried) >= self._settings.joins
            if other in tried or full or piece not in self._ledger.pieces or piece is late:
                continue
            tried.add(other)
            if (other, name) in self.tried:
                continue
            result = self._ledger.register(other, name)
            self.tried[other, name] = IDENTITY
            if result.accepted and result.agreed >= self._settings.agreed:
                self._doubtful.append(Edge.of(other, name, JOIN, self._centre, result))
        found = 0
        for edge in list(self._doubtful):
            found += self._confirm(edge)
        return found

    def _confirm(self, join: Edge) -> int:
        """Accept an edge between two components if at least half of the other edges that it predicts are found too.

        Returns:
            Edges accepted: 0, or 2 and more.
        """
        early, late = self._ledger.piece_of(join.frame_a), self._ledger.piece_of(join.frame_b)
        if early is late:
            self._doubtful.remove(join)
            return 0
        onto = early.places[join.frame_a] @ join.similarity.inverse @ late.places[join.frame_b].inverse
        wanted = []
        for a in early.stored:
            for b in late.stored:
                predicted = (onto @ late.places[b]).inverse @ early.places[a]
                share = overlap(predicted, self._size)
                if (a, b) != (join.frame_a, join.frame_b) and share >= self._settings.overlap:
                    wanted.append((share, a, b, predicted))
        wanted.sort(key=lambda one: -one[0])
        lever = 0.5 * max(self._size) / max(join.spread_px, 0.05 * max(self._size))
        deviation = 2 * math.hypot(1.0, lever) / math.sqrt(precision(join)) + 0.01 * max(self._size)
        edges = [self.measure(a, b, JOIN, predicted, deviation)
                 for _, a, b, predicted in wanted[: self._settings.joins]]
        good = [edge for edge in edges if edge.accepted]
        if not edges:
            return 0
        if 2 * len(good) < len(edges):
            self._doubtful.remove(join)
            self._ledger.note(replace(join, accepted=False, reason="not confirmed by the other edges it predicts"))
            return 0
        for edge in (join, *edges):
            self._ledger.note(edge)
            self.tried[edge.frame_a, edge.frame_b] = IDENTITY
        self._doubtful.remove(join)
        self._ledger.merge(early, late)
        return 1 + len(good)

    def exhaust(self, piece: Piece) -> Iterator[str]:
        """Look again for the edges of a component that its poses now predict, until there are no more; yields a phrase
        for each frame."""
        for _ in range(3):
            connected = {(edge.frame_a, edge.frame_b) for edge in self._ledger.accepted}
            for pair, before in list(self.tried.items()):
                if pair[0] in piece.places and pair[1] in piece.places and pair not in connected:
                    now = piece.places[pair[1]].inverse @ piece.places[pair[0]]
                    off = float(np.hypot(*(now(np.array(self._centre)) - before(np.array(self._centre)))))
                    if off > self._settings.relief * max(self._size):
                        del self.tried[pair]  # it was searched for elsewhere
            found = 0
            for name in list(piece.stored):
                found += self.propose(piece, name)
                yield f"{name}: looked for more edges"
            if not found:
                break
            self._ledger.solve(piece)
        if revise(self._ledger, piece):
            self._ledger.solve(piece)
