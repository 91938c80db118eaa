"""A survey, frame by frame: each is registered against the last, then against every neighbour the poses predict.

The track of the vehicle is not given: a single column, columns flown back and forth, or any other. The sequence places
each frame; least squares over all edges (`graph`) corrects the places. After every stored frame the pairs whose
predicted overlap is large enough are registered (`loop_closures`), within the uncertainty of the prediction; what is
found elsewhere is refused. Where the sequence breaks, a new component begins, and frames of both components are tried
until one edge between them is found and confirmed by others.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from signum.applications.mosaic.edges import JOIN, LIVE, LOOP, SEQUENCE, Edge, read_edges
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.loop_closures import Loops
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.results import Results
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import ResumeError, SurveyRun
from signum.frames.frame import Frame
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Prepared, Registrar


class Survey:
    """Builds a mosaic frame by frame and writes as it goes; a `with` writes the pictures at its end.

    Args:
        registrar: for frames of this size.
        out: folder for `edges.csv`, `poses.csv`, `mosaic.png`; `poses-2.csv`, `mosaic-2.png` of a second component.
        stream: whether the view moves little between frames (a video), rather than a third of a frame (snapshots).
        settings: see `SurveySettings`.
        source: where the frames come from, for the record.
        resume: continue the survey in the folder.
        every: least seconds between two updates of the growing mosaic; infinite for none.

    Attributes:
        ledger: the components and edges so far.
        results: writes poses and mosaics; has the optional georeference.
        done: names of the frames taken in.

    Raises:
        ResumeError: if there is nothing in the folder to continue, or it was made otherwise.
    """

    def __init__(self, registrar: Registrar, out: Path, stream: bool = False, settings: SurveySettings | None = None,
                 source: str = "", resume: bool = False, every: float = math.inf) -> None:
        self.registrar, self.out, self.stream, self.settings = registrar, out, stream, settings or SurveySettings()
        self.ledger = Ledger(registrar, out, self.settings)
        self.results = Results(self.ledger)
        self._loops = Loops(self.ledger)
        self.run = SurveyRun(source, self.ledger.size, stream, registrar.window, registrar.sigma, self.settings.columns)
        self.done: set[str] = set()
        self._every, self._updated_at, self._update_took = every, time.monotonic(), 0.0
        self._lost = 0
        self._seen: Similarity | None = None
        self._before: Similarity | None = None
        self._last: tuple[Frame, Prepared, Edge] | None = None
        if resume:
            self._resume()
        else:
            self.ledger.shelf.clear()
        self.ledger.open_table(anew=not resume)
        self.ledger.shelf.describe(self.run, finished=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close(finished=kind is None)

    @property
    def pieces(self) -> list[Piece]:
        """The components, the one that new frames are added to last."""
        return self.ledger.pieces

    @property
    def edges(self) -> list[Edge]:
        """All edges, accepted and refused, in the order they were measured."""
        return self.ledger.edges

    def ranked(self) -> list[Piece]:
        """The components, that with most frames first."""
        return self.ledger.ranked()

    def poses(self, piece: Piece) -> list[Pose]:
        """Poses of a component's frames, in order."""
        return self.ledger.poses(piece)

    def add(self, frame: Frame) -> str:
        """Take in the next frame; one that was taken in before a crash is skipped.

        Returns:
            The outcome, a phrase.
        """
        if frame.name in self.done:
            return f"{frame.name}: done before"
        prepared = self.registrar.prepare(frame.picture)
        if not self.pieces:
            outcome = self._begin(frame, prepared)
        elif self.stream:
            outcome = self._add_live(frame, prepared)
        else:
            outcome = self._add_snapshot(frame, prepared)
        self.done.add(frame.name)
        now = time.monotonic()
        if now - self._updated_at >= max(self._every, 20 * self._update_took):
            self.results.write_growing()
            self._updated_at, self._update_took = time.monotonic(), time.monotonic() - now
        return outcome

    def _add_snapshot(self, frame: Frame, prepared: Prepared) -> str:
        for name in self.pieces[-1].stored[: -1 - self.settings.back : -1]:
            result = self.registrar.register(self.ledger.prepared(name), prepared)
            edge = Edge.of(name, frame.name, SEQUENCE, self.ledger.centre, result)
            if edge.accepted:
                return self._store(frame, prepared, edge)
            self.ledger.note(edge)
        return self._begin(frame, prepared)

    def _add_live(self, frame: Frame, prepared: Prepared) -> str:
        name = self.pieces[-1].stored[-1]
        result = self.registrar.register(self.ledger.prepared(name), prepared, self._predict(), self.settings.reach)
        if not result.accepted and self._last is not None:
            # The view moves faster than the step allows: chain through the last good frame.
            self._store(*self._last)
            name = self.pieces[-1].stored[-1]
            result = self.registrar.register(self.ledger.prepared(name), prepared, IDENTITY, self.settings.reach)
        if not result.accepted:
            result = self.registrar.register(self.ledger.prepared(name), prepared)
        edge = self.ledger.note(Edge.of(name, frame.name, LIVE, self.ledger.centre, result))
        if not edge.accepted:
            self._lost += 1
            self._seen = self._before = None
            if self._lost > self.settings.patience:
                return self._begin(frame, prepared)
            return f"{name} to {frame.name}: {edge.reason}"
        self._lost = 0
        self._before, self._seen = self._seen, edge.similarity
        self.pieces[-1].hang(edge)
        self._last = frame, prepared, edge
        moved = np.abs(edge.shift) >= self.settings.step * np.array(self.ledger.size)
        if moved.any() or abs(edge.similarity.rot_deg) >= self.settings.turn_deg:
            return self._store(*self._last)
        return f"{name} to {frame.name}: {edge.shift[0]:.1f}, {edge.shift[1]:.1f} px"

    def _forget_motion(self) -> None:
        """Drop the last motion of a stream and its last frame that is not stored."""
        self._seen = self._before = self._last = None

    def _predict(self) -> Similarity:
        """The predicted place of the stored frame in the next live one, at the velocity of the last two."""
        if self._seen is None:
            return IDENTITY
        if self._before is None:
            return self._seen
        return self._seen @ self._before.inverse @ self._seen

    def _begin(self, frame: Frame, prepared: Prepared) -> str:
        """Begin a piece with a frame."""
        self._keep(frame, prepared)
        self.ledger.shelf.start(frame.name)
        self.ledger.solve(self.ledger.begin(frame.name))
        self._lost = 0
        self._forget_motion()
        if self.settings.loops and len(self.pieces) > 1:
            self._loops.join(frame.name)
        return f"{frame.name}: begins component {len(self.pieces)}"

    def _store(self, frame: Frame, prepared: Prepared, edge: Edge) -> str:
        """Add a frame to the graph by an accepted edge, and look for its neighbours."""
        self._keep(frame, prepared)
        edge = self.ledger.note(replace(edge, kind=SEQUENCE))
        self._loops.tried[edge.frame_a, edge.frame_b] = edge.similarity
        self._forget_motion()
        piece = self.ledger.piece_of(edge.frame_a)
        piece.enter(edge)
        found = self._loops.propose(piece, frame.name, edge) if self.settings.loops else 0
        self.ledger.solve(piece)
        if self.settings.loops and len(self.pieces) > 1:
            found += self._loops.join(frame.name)
        return f"{edge.frame_a} to {frame.name}: {edge.shift[0]:.1f}, {edge.shift[1]:.1f} px, {found} other edges"

    def _keep(self, frame: Frame, prepared: Prepared) -> None:
        """Put a frame on the shelf, before the row of `edges.csv` that places it."""
        self.ledger.shelf.save(frame.name, frame.picture)
        self.ledger.shelf.prepared(frame.name, self.registrar, prepared)
        self.results.show(frame.name, frame.picture)

    def settle(self) -> None:
        """Store the last frame of a stream, however little it moved since the one before."""
        if self._last is not None:
            self._store(*self._last)

    def finish(self) -> Iterator[str]:
        """Look again for edges the poses now predict, until there are no more; yields a phrase for each frame."""
        if self.settings.loops:
            for piece in list(self.pieces):
                yield from self._loops.exhaust(piece)

    def close(self, finished: bool = True) -> None:
        """Write poses and mosaics of what there is."""
        if self.ledger.closed:
            return
        self.settle()
        self.ledger.close_table()
        self.results.write_all()
        self.ledger.shelf.describe(self.run, finished)

    def _resume(self) -> None:
        described = self.ledger.shelf.described()
        path = self.out / "edges.csv"
        if described is None or not path.exists():
            raise ResumeError(f"{self.out}: no survey there to go on with; start it without --resume")
        difference = described[0].differs(self.run)
        if difference:
            raise ResumeError(f"{self.out}: holds a survey made with {difference}; go on with the same, "
                              "or start anew with --anew")
        for name in self.ledger.shelf.started():
            self.ledger.begin(name)
            self.done.add(name)
        for edge in read_edges(path, self.ledger.centre):
            self._take(edge)
        # Remove a row that a crash left incomplete.
        with path.open("rb+") as file:
            file.truncate(file.read().rfind(b"\n") + 1)
        for piece in self.pieces:
            self.ledger.solve(piece)

    def _take(self, edge: Edge) -> None:
        """Take in an edge measured before a crash."""
        a, b = edge.frame_a, edge.frame_b
        self.ledger.recall(edge)
        if edge.kind == LIVE or (edge.accepted and edge.kind == SEQUENCE):
            self.done.add(b)
        if edge.kind in (LOOP, JOIN) or edge.accepted:
            self._loops.tried[a, b] = IDENTITY
        if not edge.accepted:
            return
        if edge.kind == LIVE:
            self.ledger.piece_of(a).hang(edge)
        elif edge.kind == SEQUENCE:
            self.ledger.piece_of(a).enter(edge)
        elif edge.kind == JOIN:
            early, late = self.ledger.piece_of(a), self.ledger.piece_of(b)
            if early is not late:
                self.ledger.merge(early, late)
