"""What a survey knows: its pieces, the edges that hold them together, where these put every frame."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from signum.applications.mosaic.edges import LIVE, SURVEY_EDGES, Edge
from signum.applications.mosaic.graph import Solution, solve_graph
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import Shelf
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Prepared, Registrar


@dataclass
class Piece:
    """Frames that hang together; its plane is that of its first frame.

    Attributes:
        stored: frames in the graph, in order.
        places: of those, pixels of the frame -> plane.
        hung: frames of a stream between them: which stored frame each hangs on, and its pixels -> that one's.
        frames: all of them, in order.
        solution: the last.
    """

    stored: list[str] = field(default_factory=list)
    places: dict[str, Similarity] = field(default_factory=dict)
    hung: dict[str, tuple[str, Similarity]] = field(default_factory=dict)
    frames: list[str] = field(default_factory=list)
    solution: Solution | None = None

    def place(self, name: str) -> Similarity:
        """Pixels of any of its frames -> plane."""
        if name in self.places:
            return self.places[name]
        key, onto = self.hung[name]
        return self.places[key] @ onto


class Ledger:
    """Pieces and edges, with a row in `edges.csv` for every edge noted.

    Args:
        registrar: for frames of this size.
        out: folder of `edges.csv` and of the frames that are kept.
        settings: see `SurveySettings`.
    """

    def __init__(self, registrar: Registrar, out: Path, settings: SurveySettings) -> None:
        self.registrar, self.out, self.settings = registrar, out, settings
        self.centre = float(registrar.centre[0]), float(registrar.centre[1])
        self.size = registrar.fine.source
        self.shelf = Shelf(out)
        self.pieces: list[Piece] = []
        self.edges: list[Edge] = []
        self.partners: dict[str, set[str]] = {}
        """Frames a frame has accepted edges with."""

    def open_edges(self, anew: bool) -> None:
        """Begin to write `edges.csv`, or go on with it."""
        self._table = (self.out / "edges.csv").open("a", newline="", encoding="utf-8")
        if anew:
            self._write(SURVEY_EDGES)

    @property
    def accepted(self) -> list[Edge]:
        """Accepted edges between stored frames, of all pieces."""
        return [edge for edge in self.edges if edge.accepted and edge.kind != LIVE]

    def edges_of(self, piece: Piece) -> list[Edge]:
        """Accepted edges between stored frames of a piece."""
        return [edge for edge in self.accepted if edge.frame_a in piece.places and edge.frame_b in piece.places]

    def ranked(self) -> list[Piece]:
        """The pieces, that with most frames first."""
        return sorted(self.pieces, key=lambda piece: -len(piece.frames))

    @staticmethod
    def enter(piece: Piece, edge: Edge) -> None:
        name = edge.frame_b
        piece.hung.pop(name, None)
        piece.stored.append(name)
        if name not in piece.frames:
            piece.frames.append(name)
        piece.places[name] = piece.places[edge.frame_a] @ edge.similarity.inverse

    def prepared(self, name: str) -> Prepared:
        return self.shelf.prepared(name, self.registrar)

    def piece_of(self, name: str) -> Piece:
        return next(piece for piece in reversed(self.pieces) if name in piece.places)

    def note(self, edge: Edge) -> Edge:
        """Record an edge."""
        self.know(edge)
        self._write(edge.row)
        return edge

    def know(self, edge: Edge) -> None:
        self.edges.append(edge)
        if edge.accepted and edge.kind != LIVE:
            self.partners.setdefault(edge.frame_a, set()).add(edge.frame_b)
            self.partners.setdefault(edge.frame_b, set()).add(edge.frame_a)

    def _write(self, row: Sequence[object]) -> None:
        # A row goes to the disk in one piece, its newline with it.
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow(row)
        self._table.write(line.getvalue())
        self._table.flush()

    def solve(self, piece: Piece) -> None:
        """Place the frames of a piece by all its edges."""
        edges = self.edges_of(piece)
        piece.solution = solve_graph(piece.stored[0], edges, self.size, piece.places, self.settings.outvoted)
        piece.places.update(piece.solution.places)

    def merge(self, early: Piece, late: Piece) -> None:
        """One piece of two that edges hold together; the frames of the later one come last."""
        if self.pieces.index(early) > self.pieces.index(late):
            early, late = late, early
        early.stored += late.stored
        early.frames += late.frames
        early.hung |= late.hung
        early.places |= dict.fromkeys(late.stored, IDENTITY)
        start = {name: early.places[name] for name in early.stored if name not in late.places}
        # The one whose frames are still coming stays last.
        position = max(self.pieces.index(early), self.pieces.index(late))
        early.solution = solve_graph(early.stored[0], self.edges_of(early), self.size, start, self.settings.outvoted)
        early.places = dict(early.solution.places)
        self.pieces[position] = early
        self.pieces = [p for i, p in enumerate(self.pieces) if p is not late and (p is not early or i == position)]
