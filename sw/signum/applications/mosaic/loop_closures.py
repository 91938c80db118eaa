# SPDX-License-Identifier: Apache-2.0
"""Finds loop closures: edges between frames that are not consecutive, in one component or between two."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate

import numpy as np

from signum.applications.mosaic.edges import JOIN, LOOP, Edge
from signum.applications.mosaic.graph import Solution, precision
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.local_solution import Knowledge
from signum.applications.mosaic.nearby import ball
from signum.applications.mosaic.revise import revise
from signum.applications.mosaic.surprise import surprise
from signum.geometry.similarity import IDENTITY, Similarity, overlap
from signum.measure.registration import Rival

CONFIRMING = 64
"""Frames around one end of an edge between two components whose places beside the other end may confirm it."""


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
        found = 0
        for pair, deviation in self.choose(piece, name, by):
            found += self.attempt(piece, pair, deviation)
        return found

    def choose(self, piece: Piece, name: str, by: Edge | None = None) -> Iterator[tuple[tuple[str, str], float]]:
        """The pairs to be tried of a frame, as `propose`, and the standard deviations of their predictions, pixels.

        Edges to two frames that lie close together are redundant: those chosen come from all directions. One that has
        been tried between two steps, and accepted, counts.
        """
        wanted = self._wanted(piece, name, by)
        if not wanted:
            return
        anchor = name if by is None else by.frame_a
        known = self._ledger.known(piece, anchor, [pair[0] if pair[1] == name else pair[1] for _, pair in wanted])
        near = self._settings.apart * min(self._size) * piece.places[name].scale
        room = self._settings.proposals
        for _, pair in wanted:
            at = piece.grid.at[pair[0] if pair[1] == name else pair[1]]
            partners = [partner for partner in self._ledger.partners(name) if partner in piece.places]
            if not room or any(abs(at - piece.grid.at[partner]) < near for partner in partners):
                continue
            deviation = self._deviation(piece, known, pair, by)
            if deviation is None:
                piece.strained = True  # it waits until all frames are placed again, or for the last look
                continue
            room -= 1
            yield pair, deviation

    def _wanted(self, piece: Piece, name: str, by: Edge | None) -> list[tuple[float, tuple[str, str]]]:
        """The pairs of a frame with others that were not tried yet, and their predicted overlaps, the largest first."""
        wanted = []
        for other in piece.near(name):
            pair = (other, name) if piece.order[other] < piece.order[name] else (name, other)
            if (by is not None and other == by.frame_a) or pair in self.tried:
                continue
            share = overlap(piece.places[pair[1]].inverse @ piece.places[pair[0]], self._size)
            if share >= self._settings.overlap:
                wanted.append((share, pair))
        return sorted(wanted, key=lambda one: -one[0])

    def attempt(self, piece: Piece, pair: tuple[str, str], deviation: float) -> bool:
        """Measure a proposed edge of a component; it is accepted if it agrees with the poses."""
        predicted = piece.places[pair[1]].inverse @ piece.places[pair[0]]
        edge = self.measure(*pair, LOOP, predicted, deviation)
        self.tried[pair] = predicted
        self._ledger.note(edge)
        return edge.accepted

    def _common(self, predicted: Similarity) -> tuple[float, float]:
        """The centre of the overlap of two frames, pixels of a."""
        middle = (np.array(self._centre) + predicted.inverse(np.array(self._centre))) / 2
        return float(middle[0]), float(middle[1])

    def _deviation(self, piece: Piece, known: Knowledge | Solution, pair: tuple[str, str], by: Edge | None
                   ) -> float | None:
        """Standard deviation of the prediction of a pair, pixels; None if it cannot be told yet.

        Args:
            piece: of both.
            known: what is known from the frame that is placed, or from the one that the edge `by` has placed it by.
            pair: the frames.
            by: the edge, if it has just placed the second of them.
        """
        a, b = pair
        predicted = piece.places[b].inverse @ piece.places[a]
        at = self._common(predicted)
        if by is None:
            return known.deviation(a, b, at)
        x, y = by.similarity.inverse(predicted(np.array(at)))
        before = known.deviation(a, by.frame_a, at) if a != by.frame_a else 0.0
        lever = math.dist((x, y), by.middle) / max(by.spread_px, 0.05 * max(self._size))
        return None if before is None else math.hypot(before, known.usual * math.hypot(1.0, lever)
                                                      / math.sqrt(precision(by)))

    def search(self, predicted: Similarity, deviation: float) -> tuple[Similarity | None, int | None]:
        """The guess and reach to search with around a prediction; None where the whole frame is searched."""
        spread = math.hypot(deviation, self._settings.relief * max(self._size))
        reach = math.ceil(self._settings.gate * spread / max(self._registrar.fine.factor)) + 6
        if reach > self._settings.farthest:
            return None, None
        return predicted, max(reach, self._registrar.limits.reach)

    def measure(self, a: str, b: str, kind: str, predicted: Similarity, deviation: float) -> Edge:
        """Measure an edge around its prediction; of its motions that is taken which is the likeliest by its windows and
        its place, and refused if that is not likely enough."""
        settings = self._settings
        spread = math.hypot(deviation, settings.relief * max(self._size))
        guess, reach = self.search(predicted, deviation)
        result = self._ledger.register(a, b, guess, reach)
        searched = 0.5 * max(self._size) if reach is None else reach * max(self._registrar.fine.factor)
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
        for other in self.beside(name):
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

    def beside(self, name: str) -> list[str]:
        """The frames of other components that an edge from a frame of the last one is looked for to.

        Where columns turn, the n-th frame after a break lies beside the n-th before it; some others are tried too.
        """
        late = self._ledger.piece_of(name)
        pieces = [piece for piece in self._ledger.pieces if piece is not late]
        ends = list(accumulate(len(piece.stored) for piece in pieces))
        count, first = ends[-1], ends[-1] - 1 - late.order[name]
        places = [*range(first, max(first - self._settings.joins // 2, -1), -1),
                  *(round(i) for i in np.linspace(0, count - 1, self._settings.joins))]
        found: dict[str, None] = {}
        for place in places:
            k = bisect_right(ends, place)
            found.setdefault(pieces[k].stored[place - ends[k]])
        return list(found)[: self._settings.joins]

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
        for b in ball(self._ledger.links, join.frame_b, CONFIRMING):
            there = onto @ late.places[b]
            middle = there(np.array(self._centre))
            for a in early.grid.near(complex(*middle), early.grid.diagonal * there.scale):
                predicted = there.inverse @ early.places[a]
                share = overlap(predicted, self._size)
                if (a, b) != (join.frame_a, join.frame_b) and share >= self._settings.overlap:
                    wanted.append((share, a, b, predicted))
        wanted.sort(key=lambda one: (-one[0], early.order[one[1]], late.order[one[2]]))
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
        self._ledger.complete(piece)
        for _ in range(3):
            self.forget(piece)
            found = 0
            for name in list(piece.stored):
                found += self.propose(piece, name)
                yield f"{name}: looked for more edges"
            if not found:
                break
            self._ledger.solve(piece)
        self.conclude(piece)

    def conclude(self, piece: Piece) -> None:
        """Refuse the edges that the others contradict, once no more are looked for."""
        if revise(self._ledger, piece):
            self._ledger.solve(piece)

    def forget(self, piece: Piece) -> int:
        """Let pairs be tried again that were searched for elsewhere than the poses now predict; returns how many."""
        connected = {(edge.frame_a, edge.frame_b) for edge in self._ledger.accepted}
        moved = []
        for pair, before in self.tried.items():
            if pair[0] in piece.places and pair[1] in piece.places and pair not in connected:
                now = piece.places[pair[1]].inverse @ piece.places[pair[0]]
                off = float(np.hypot(*(now(np.array(self._centre)) - before(np.array(self._centre)))))
                if off > self._settings.relief * max(self._size):
                    moved.append(pair)
        for pair in moved:
            del self.tried[pair]
        return len(moved)
