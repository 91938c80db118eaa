"""The state of a survey: its components, the edges that hold them together, and where these place every frame."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from signum.applications.mosaic.edges import LIVE, Edge
from signum.applications.mosaic.graph import Solution, solve_graph
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import Shelf
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Prepared, Registrar
from signum.tables.schemas import SURVEY_EDGES


@dataclass
class Piece:
    """A component: connected frames, placed in the plane of the first of them.

    Attributes:
        stored: frames in the graph, in order.
        places: of those, pixels of the frame -> plane.
        hung: frames of a stream between them: the stored frame each depends on, and its pixels -> that one's.
        frames: all frames, in order.
        solution: the latest.
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

    def hang(self, edge: Edge) -> None:
        """Add a frame of a stream by its edge to a stored frame, without storing it."""
        self.hung[edge.frame_b] = edge.frame_a, edge.similarity.inverse
        self.frames.append(edge.frame_b)

    def enter(self, edge: Edge) -> None:
        """Add a stored frame by its edge to another."""
        name = edge.frame_b
        self.hung.pop(name, None)
        self.stored.append(name)
        if name not in self.frames:
            self.frames.append(name)
        self.places[name] = self.places[edge.frame_a] @ edge.similarity.inverse


class Ledger:
    """Components and edges, with a row in `edges.csv` for every edge noted.

    Args:
        registrar: for frames of this size.
        out: folder of `edges.csv` and of the stored frames.
        settings: see `SurveySettings`.

    Attributes:
        centre, size: of the frames, pixels.
        partners: by frame, the frames it has accepted edges with.
    """

    def __init__(self, registrar: Registrar, out: Path, settings: SurveySettings) -> None:
        self.registrar, self.out, self.settings = registrar, out, settings
        self.centre = float(registrar.centre[0]), float(registrar.centre[1])
        self.size = registrar.fine.source
        self.shelf = Shelf(out)
        self.pieces: list[Piece] = []
        self.edges: list[Edge] = []
        self.partners: dict[str, set[str]] = {}

    def open_table(self, anew: bool) -> None:
        """Begin to write `edges.csv`, or continue it."""
        self._table = (self.out / "edges.csv").open("a", newline="", encoding="utf-8")
        if anew:
            self._write(SURVEY_EDGES)

    def close_table(self) -> None:
        """Write no more rows."""
        self._table.close()

    @property
    def closed(self) -> bool:
        """Whether `edges.csv` is complete."""
        return self._table.closed

    @property
    def accepted(self) -> list[Edge]:
        """Accepted edges between stored frames, of all components."""
        return [edge for edge in self.edges if edge.accepted and edge.kind != LIVE]

    def edges_of(self, piece: Piece) -> list[Edge]:
        """Accepted edges between stored frames of a component."""
        return [edge for edge in self.accepted if edge.frame_a in piece.places and edge.frame_b in piece.places]

    def ranked(self) -> list[Piece]:
        """The components, that with most frames first."""
        return sorted(self.pieces, key=lambda piece: -len(piece.frames))

    def piece_of(self, name: str) -> Piece:
        """The component a stored frame belongs to."""
        return next(piece for piece in reversed(self.pieces) if name in piece.places)

    def poses(self, piece: Piece) -> list[Pose]:
        """Poses of a component's frames, in order."""
        return [Pose.of(name, piece.place(name), self.centre) for name in piece.frames]

    def prepared(self, name: str) -> Prepared:
        """A stored frame as the board sees it."""
        return self.shelf.prepared(name, self.registrar)

    def begin(self, name: str) -> Piece:
        """Begin a component with a stored frame; its plane is this frame's."""
        piece = Piece([name], {name: IDENTITY}, frames=[name])
        self.pieces.append(piece)
        return piece

    def note(self, edge: Edge) -> Edge:
        """Record an edge, also in `edges.csv`."""
        self.recall(edge)
        self._write(edge.row)
        return edge

    def recall(self, edge: Edge) -> None:
        """Record an edge that is in `edges.csv` already."""
        self.edges.append(edge)
        if edge.accepted and edge.kind != LIVE:
            self.partners.setdefault(edge.frame_a, set()).add(edge.frame_b)
            self.partners.setdefault(edge.frame_b, set()).add(edge.frame_a)

    def _write(self, row: Sequence[object]) -> None:
        # A row is written in one call, newline included, so that a crash leaves at most one incomplete row.
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow(row)
        self._table.write(line.getvalue())
        self._table.flush()

    def solve(self, piece: Piece) -> None:
        """Place the frames of a component by all its edges."""
        edges = self.edges_of(piece)
        piece.solution = solve_graph(piece.stored[0], edges, self.size, piece.places, self.settings.outvoted)
        piece.places.update(piece.solution.places)

    def merge(self, early: Piece, late: Piece) -> None:
        """Make one component of two that edges now connect; the frames of the later one come last."""
        if self.pieces.index(early) > self.pieces.index(late):
            early, late = late, early
        early.stored += late.stored
        early.frames += late.frames
        early.hung |= late.hung
        early.places |= dict.fromkeys(late.stored, IDENTITY)
        start = {name: early.places[name] for name in early.stored if name not in late.places}
        # The last component is the one that new frames are added to, and stays last.
        position = max(self.pieces.index(early), self.pieces.index(late))
        early.solution = solve_graph(early.stored[0], self.edges_of(early), self.size, start, self.settings.outvoted)
        early.places = dict(early.solution.places)
        self.pieces[position] = early
        self.pieces = [p for i, p in enumerate(self.pieces) if p is not late and (p is not early or i == position)]
