"""What a survey knows: its pieces, the links that hold them together, where these put every frame."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from signum.applications.mosaic.edges import LINKS, LIVE, Link
from signum.applications.mosaic.graph import Solution
from signum.applications.mosaic.graph import solve as place_all
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
    """Pieces and links, with a row in `edges.csv` for every link noted.

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
        self.links: list[Link] = []
        self.partners: dict[str, set[str]] = {}
        """Frames a frame has accepted links with."""

    def open_edges(self, anew: bool) -> None:
        """Begin to write `edges.csv`, or go on with it."""
        self.edges = (self.out / "edges.csv").open("a", newline="", encoding="utf-8")
        if anew:
            self._write(LINKS)

    @property
    def accepted(self) -> list[Link]:
        """Accepted links between stored frames, of all pieces."""
        return [link for link in self.links if link.accepted and link.kind != LIVE]

    def links_of(self, piece: Piece) -> list[Link]:
        """Accepted links between stored frames of a piece."""
        return [link for link in self.accepted if link.frame_a in piece.places and link.frame_b in piece.places]

    def ranked(self) -> list[Piece]:
        """The pieces, that with most frames first."""
        return sorted(self.pieces, key=lambda piece: -len(piece.frames))

    @staticmethod
    def enter(piece: Piece, link: Link) -> None:
        name = link.frame_b
        piece.hung.pop(name, None)
        piece.stored.append(name)
        if name not in piece.frames:
            piece.frames.append(name)
        piece.places[name] = piece.places[link.frame_a] @ link.similarity.inverse

    def prepared(self, name: str) -> Prepared:
        return self.shelf.prepared(name, self.registrar)

    def piece_of(self, name: str) -> Piece:
        return next(piece for piece in reversed(self.pieces) if name in piece.places)

    def note(self, link: Link) -> Link:
        """Record a link."""
        self.know(link)
        self._write(link.row)
        return link

    def know(self, link: Link) -> None:
        self.links.append(link)
        if link.accepted and link.kind != LIVE:
            self.partners.setdefault(link.frame_a, set()).add(link.frame_b)
            self.partners.setdefault(link.frame_b, set()).add(link.frame_a)

    def _write(self, row: Sequence[object]) -> None:
        # A row goes to the disk in one piece, its newline with it.
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow(row)
        self.edges.write(line.getvalue())
        self.edges.flush()

    def solve(self, piece: Piece) -> None:
        """Place the frames of a piece by all its links."""
        links = self.links_of(piece)
        piece.solution = place_all(piece.stored[0], links, self.size, piece.places, self.settings.outvoted)
        piece.places.update(piece.solution.places)

    def merge(self, early: Piece, late: Piece) -> None:
        """One piece of two that links hold together; the frames of the later one come last."""
        if self.pieces.index(early) > self.pieces.index(late):
            early, late = late, early
        early.stored += late.stored
        early.frames += late.frames
        early.hung |= late.hung
        early.places |= dict.fromkeys(late.stored, IDENTITY)
        start = {name: early.places[name] for name in early.stored if name not in late.places}
        # The one whose frames are still coming stays last.
        position = max(self.pieces.index(early), self.pieces.index(late))
        early.solution = place_all(early.stored[0], self.links_of(early), self.size, start, self.settings.outvoted)
        early.places = dict(early.solution.places)
        self.pieces[position] = early
        self.pieces = [p for i, p in enumerate(self.pieces) if p is not late and (p is not early or i == position)]
