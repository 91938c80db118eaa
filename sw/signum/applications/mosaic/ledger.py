# SPDX-License-Identifier: Apache-2.0
"""The state of a survey: its components, the edges that hold them together, and where these place every frame."""

from __future__ import annotations

import csv
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

from signum.applications.mosaic.edges import LIVE, Edge
from signum.applications.mosaic.graph import Solution, solve_graph
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import EDGES_FILE, Shelf
from signum.common.files import own_bytes, write_bytes
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Registrar, Registration
from signum.tables.schemas import SURVEY_EDGES
from signum.tables.table import csv_line


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
        self._table: TextIO | None = None
        self._revised = False

    def open_table(self) -> bool:
        """Write `edges.csv` with the edges so far, and from now on a row for every edge noted.

        Returns:
            Whether the rows that were in the file before are among those that are written, but for the verdicts on
            them, which come last.
        """
        path = self.out / EDGES_FILE
        try:
            before = own_bytes(path)
        except OSError:
            before = b""
        whole = before[: before.rfind(b"\n") + 1]
        text = self._text().encode()
        if text != before:
            write_bytes(path, text)
        self._table = path.open("a", newline="", encoding="utf-8")
        return all(a == b for a, b in zip(_measured(whole), _measured(text), strict=False))

    def close_table(self) -> None:
        """Write no more rows; revised ones get their last state."""
        if self._table is None:
            return
        with suppress(OSError):  # of a row that `note` has told of
            self._table.close()
        if self._revised:
            write_bytes(self.out / EDGES_FILE, self._text().encode())

    def _text(self) -> str:
        """The whole of `edges.csv`."""
        return "".join([csv_line(SURVEY_EDGES), *(csv_line(edge.row) for edge in self.edges)])

    @property
    def opened(self) -> bool:
        """Whether edges are written to `edges.csv` as they are noted."""
        return self._table is not None

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
        return [Pose.of(name, piece.place(name), self.centre, self.shelf.time(name)) for name in piece.frames]

    def register(self, a: str, b: str, guess: Similarity | None = None, reach: int | None = None) -> Registration:
        """Find frame a in frame b, each stored or at work; see `Registrar.register`."""
        return self.shelf.register(self.registrar, a, b, guess, reach)

    def begin(self, name: str) -> Piece:
        """Begin a component with a stored frame; its plane is this frame's."""
        piece = Piece([name], {name: IDENTITY}, frames=[name])
        self.pieces.append(piece)
        return piece

    def note(self, edge: Edge) -> Edge:
        """Record an edge, also in `edges.csv` where that is open."""
        self.edges.append(edge)
        if edge.accepted and edge.kind != LIVE:
            self.partners.setdefault(edge.frame_a, set()).add(edge.frame_b)
            self.partners.setdefault(edge.frame_b, set()).add(edge.frame_a)
        if self._table is not None:
            try:
                self._table.write(csv_line(edge.row))
                self._table.flush()
            except OSError as error:
                raise OSError(error.errno, error.strerror, str(self.out / EDGES_FILE)) from error
        return edge

    def revise(self, edge: Edge, verdict: Edge) -> None:
        """Put a verdict in the place of an edge noted before, of which only `accepted` and `reason` differ; it is in
        `edges.csv` when the table is closed."""
        self.edges[next(k for k, noted in enumerate(self.edges) if noted is edge)] = verdict
        self._revised = True

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



def _measured(table: bytes) -> list[list[str]]:
    """The rows of an `edges.csv` without the columns that a verdict changes."""
    keep = [k for k, name in enumerate(SURVEY_EDGES) if name not in ("accepted", "reason")]
    return [[row[k] for k in keep if k < len(row)] for row in csv.reader(table.decode(errors="replace").splitlines())]
