# SPDX-License-Identifier: Apache-2.0
"""The state of a survey: its components, the edges that hold them together, and where these place every frame."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

from signum.applications.mosaic.edges import LIVE, Edge
from signum.applications.mosaic.graph import Solution, solve_graph
from signum.applications.mosaic.journal import Key, key_of
from signum.applications.mosaic.local_solution import MOVED_PX, WIDE, WINDOW, Knowledge, solve_window
from signum.applications.mosaic.nearby import CentreGrid
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import EDGES_FILE, Shelf
from signum.common.files import own_bytes, write_bytes
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Registrar
from signum.measure.registration import Registration
from signum.tables.schemas import SURVEY_EDGES
from signum.tables.table import csv_line

WHOLE = 64
"""Up to so many frames all are placed again after each one."""
GROWN = 1.25
"""All are when a component has grown by this factor since they were last."""
SOONER = 1.125
"""All are, by this factor, if a loop has moved more frames than a part holds. Both make the cost a frame the same in a
long survey: the sum of a geometric series."""


@dataclass
class Piece:
    """A component: connected frames, placed in the plane of the first of them.

    Attributes:
        stored: frames in the graph, in order.
        places: of those, pixels of the frame -> plane.
        hung: frames of a stream between them: the stored frame each depends on, and its pixels -> that one's.
        frames: all frames, in order.
        solution: the latest of all frames, perhaps without the newest.
        grid: where the stored frames are.
        order: of the stored frames, their index in `stored`.
        strained: whether frames beyond those placed again after the newest should move.
    """

    grid: CentreGrid
    stored: list[str] = field(default_factory=list)
    places: dict[str, Similarity] = field(default_factory=dict)
    hung: dict[str, tuple[str, Similarity]] = field(default_factory=dict)
    frames: list[str] = field(default_factory=list)
    solution: Solution | None = None
    order: dict[str, int] = field(default_factory=dict)
    strained: bool = False

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

    def add(self, name: str, place: Similarity) -> None:
        """Add a stored frame at a place, or one that is in `stored` already."""
        if name not in self.order:
            self.order[name] = len(self.stored)
            self.stored.append(name)
            if self.hung.pop(name, None) is None:
                self.frames.append(name)
        self.move({name: place})

    def move(self, places: Mapping[str, Similarity]) -> None:
        """Give stored frames other places."""
        self.places.update(places)
        for name, place in places.items():
            self.grid.put(name, place)

    def near(self, name: str) -> list[str]:
        """The stored frames that may overlap with one, in order, itself left out."""
        found = self.grid.near(self.grid.at[name], self.grid.diagonal * self.places[name].scale)
        return sorted((other for other in found if other != name), key=self.order.__getitem__)

    @property
    def news(self) -> float:
        """By which factor it has grown since all its frames were placed."""
        return len(self.stored) / max(1, len(self.solution.places) if self.solution is not None else 0)


class Ledger:
    """Components and edges, with a row in `edges.csv` for every edge noted.

    Args:
        registrar: for frames of this size.
        out: folder of `edges.csv` and of the stored frames.
        settings: see `SurveySettings`.

    Attributes:
        centre, size: of the frames, pixels.
        accepted: accepted edges between stored frames, of all components, in the order they were measured.
        links: the same by frame.
    """

    def __init__(self, registrar: Registrar, out: Path, settings: SurveySettings) -> None:
        self.registrar, self.out, self.settings = registrar, out, settings
        self.centre = float(registrar.centre[0]), float(registrar.centre[1])
        self.size = registrar.fine.source
        self.shelf = Shelf(out)
        self.pieces: list[Piece] = []
        self.edges: list[Edge] = []
        self.accepted: list[Edge] = []
        self.links: dict[str, list[Edge]] = {}
        self._homes: dict[str, Piece] = {}
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

    def edges_of(self, piece: Piece) -> list[Edge]:
        """Accepted edges between stored frames of a component."""
        return [edge for edge in self.accepted if edge.frame_a in piece.places and edge.frame_b in piece.places]

    def ranked(self) -> list[Piece]:
        """The components, that with most frames first."""
        return sorted(self.pieces, key=lambda piece: -len(piece.frames))

    def piece_of(self, name: str) -> Piece:
        """The component a stored frame belongs to."""
        return self._homes[name]

    def partners(self, name: str) -> list[str]:
        """The frames that a stored frame has accepted edges with."""
        return [edge.frame_b if edge.frame_a == name else edge.frame_a for edge in self.links.get(name, ())]

    def poses(self, piece: Piece) -> list[Pose]:
        """Poses of a component's frames, in order."""
        return [Pose.of(name, piece.place(name), self.centre, self.shelf.time(name)) for name in piece.frames]

    def register(self, a: str, b: str, guess: Similarity | None = None, reach: int | None = None) -> Registration:
        """Find frame a in frame b, each stored or at work; see `Registrar.register`."""
        return self.shelf.register(self.registrar, a, b, guess, reach)

    def key(self, a: str, b: str, guess: Similarity | None = None, reach: int | None = None) -> Key:
        """The question that `register` asks."""
        return key_of(self.shelf.number(a), self.shelf.number(b), guess, reach)

    def begin(self, name: str) -> Piece:
        """Begin a component with a stored frame; its plane is this frame's."""
        piece = Piece(CentreGrid(self.size))
        piece.add(name, IDENTITY)
        self.pieces.append(piece)
        self._homes[name] = piece
        return piece

    def enter(self, piece: Piece, edge: Edge) -> None:
        """Add a stored frame to a component by its edge to another."""
        piece.add(edge.frame_b, piece.places[edge.frame_a] @ edge.similarity.inverse)
        self._homes[edge.frame_b] = piece

    def note(self, edge: Edge) -> Edge:
        """Record an edge, also in `edges.csv` where that is open."""
        self.edges.append(edge)
        if edge.accepted and edge.kind != LIVE:
            self.accepted.append(edge)
            self.links.setdefault(edge.frame_a, []).append(edge)
            self.links.setdefault(edge.frame_b, []).append(edge)
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
        self.edges[_spot(self.edges, edge)] = verdict
        self._revised = True
        for held in (self.accepted, self.links[edge.frame_a], self.links[edge.frame_b]):
            del held[_spot(held, edge)]

    def solve(self, piece: Piece) -> None:
        """Place the frames of a component by all its edges."""
        edges = self.edges_of(piece)
        piece.solution = solve_graph(piece.stored[0], edges, self.size, piece.places, self.settings.outvoted)
        piece.move(piece.solution.places)
        piece.strained = False

    def settle(self, piece: Piece, name: str) -> None:
        """Place frames of a component again after a new one, at a cost that does not grow with their number.

        In a large component these are the frames around the new one, or more where that moves them at their border. All
        are placed again when it has grown by a part; sooner where even more should move.
        """
        if len(piece.stored) <= WHOLE:
            self.solve(piece)
            return
        if len(self.links[name]) > 1:  # one edge alone leaves nothing to even out
            self._settle_around(piece, name)
        if piece.news >= (SOONER if piece.strained else GROWN):
            self.solve(piece)

    def _settle_around(self, piece: Piece, name: str) -> None:
        for most in (WINDOW, WIDE * WINDOW):
            places, moved = solve_window(self.links, piece.places, piece.stored[0], name, most, self.size,
                                         self.settings.outvoted)
            if moved < MOVED_PX:
                break
        piece.move(places)
        piece.strained |= moved >= MOVED_PX

    def complete(self, piece: Piece) -> None:
        """Place the frames of a component by all its edges, unless they were already."""
        if piece.solution is None or len(piece.solution.places) < len(piece.stored):
            self.solve(piece)

    def known(self, piece: Piece, name: str, others: Sequence[str]) -> Knowledge | Solution:
        """What tells how well the places of other frames are known from a frame."""
        if len(piece.stored) <= WHOLE and piece.solution is not None:
            return piece.solution
        return Knowledge(self.links, piece.places, name, others, self.size, self.settings.outvoted, piece.solution)

    def merge(self, early: Piece, late: Piece) -> None:
        """Make one component of two that edges now connect; the frames of the later one come last."""
        if self.pieces.index(early) > self.pieces.index(late):
            early, late = late, early
        # The last component is the one that new frames are added to, and stays last.
        position = max(self.pieces.index(early), self.pieces.index(late))
        start, frames = dict(early.places), early.frames + late.frames
        for name in late.stored:
            self._homes[name] = early
            early.add(name, IDENTITY)
        early.frames, early.hung = frames, early.hung | late.hung
        early.solution = solve_graph(early.stored[0], self.edges_of(early), self.size, start, self.settings.outvoted)
        early.move(early.solution.places)
        early.strained = False
        self.pieces[position] = early
        self.pieces = [p for i, p in enumerate(self.pieces) if p is not late and (p is not early or i == position)]


def _measured(table: bytes) -> list[list[str]]:
    """The rows of an `edges.csv` without the columns that a verdict changes."""
    keep = [k for k, name in enumerate(SURVEY_EDGES) if name not in ("accepted", "reason")]
    return [[row[k] for k in keep if k < len(row)] for row in csv.reader(table.decode(errors="replace").splitlines())]


def _spot(edges: list[Edge], edge: Edge) -> int:
    """Where an edge is in a list."""
    return next(k for k, noted in enumerate(edges) if noted is edge)
