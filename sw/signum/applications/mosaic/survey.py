# SPDX-License-Identifier: Apache-2.0
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
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from signum.applications.mosaic.edges import LIVE, SEQUENCE, Edge
from signum.applications.mosaic.journal import SurveyRun
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.loop_closures import Loops
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.results import Results
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import EDGES_FILE, ResumeError, find_survey, read_record
from signum.frames.frame import Frame
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Registrar

NO_PICTURE = np.zeros((0, 0), np.uint8)
"""Picture of a frame of which only the registrations are left."""


class Survey:
    """Builds a mosaic frame by frame and writes as it goes; a `with` writes the pictures at its end.

    The survey is a function of the frames, in the order in which they were taken in, and of the registrations between
    them. One that is continued runs again over the frames in its journal, with registrations out of the journal, and
    has the same state as if it had never been interrupted.

    Args:
        registrar: for frames of this size.
        out: folder for `edges.csv`, `poses.csv`, `mosaic.png`; `poses-2.csv`, `mosaic-2.png` of a second component.
        stream: whether the view moves little between frames (a video), rather than a third of a frame (snapshots).
        settings: see `SurveySettings`.
        source: where the frames come from, for the record.
        resume: continue the survey in the folder: give the frames to `add` in the order of `ordered`.
        every: least seconds between two updates of the growing mosaic; infinite for none.
        calibration: of the camera, for the record.
        order: in which pairs are measured, for the record; empty for that in which the frames come.

    Attributes:
        ledger: the components and edges so far.
        results: writes poses and mosaics; has the optional georeference.
        done: names of the frames taken in.
        remarks: of damage that was found in the folder and mended, or not, a line each.

    Raises:
        ResumeError: if there is nothing in the folder to continue, or it was made otherwise.
    """

    def __init__(self, registrar: Registrar, out: Path, stream: bool = False, settings: SurveySettings | None = None,
                 source: str = "", resume: bool = False, every: float = math.inf, calibration: str = "",
                 order: str = "") -> None:
        self.registrar, self.out, self.stream, self.settings = registrar, out, stream, settings or SurveySettings()
        self.ledger = Ledger(registrar, out, self.settings)
        self.results = Results(self.ledger)
        self._loops = Loops(self.ledger)
        self.run = SurveyRun(source, self.ledger.size, stream, registrar.window, registrar.sigma, self.settings.columns,
                             calibration, order)
        self.done: set[str] = set()
        self.remarks: list[str] = []
        self._every, self._updated_at, self._update_took = every, time.monotonic(), 0.0
        self._lost = 0
        self._seen: Similarity | None = None
        self._before: Similarity | None = None
        self._last: tuple[Frame, Edge] | None = None
        self._closed = self._was_finished = False
        shelf = self.ledger.shelf
        if resume:
            self._resume()
        else:
            shelf.clear()
        self._recorded = {name for name, _ in shelf.journal.frames.values()}
        shelf.begin(self.run, finished=self._was_finished)
        if not self._recorded:
            self.ledger.open_table()

    def _resume(self) -> None:
        """Take in what the folder holds, after a check that it is this survey."""
        run = find_survey(self.out)
        if run is None:
            raise ResumeError(f"{self.out}: no survey there that can be continued; start it without --resume, or anew "
                              "with --anew")
        difference = run.differs(self.run)
        if difference:
            raise ResumeError(f"{self.out}: holds a survey made with {difference}; continue it with the same, or start "
                              "anew with --anew")
        shelf = self.ledger.shelf
        shelf.read()
        record = read_record(self.out)
        self._was_finished = record is not None and record[1]
        if record is None:
            self.remarks.append(f"{self.out / 'run.json'}: cannot be read; written anew from the journal")
        if shelf.journal.dropped:
            self.remarks.append(f"{shelf.journal.path}: {shelf.journal.dropped} damaged rows are left out; what they "
                                "held is measured again")

    def ordered(self, frames: Iterable[Frame], live: bool = False) -> Iterator[Frame]:
        """The frames in the order in which `add` takes them in: those of the journal first, then those that are new.

        A frame that the source no longer gives comes from its stored picture, or, if it was placed but not stored,
        without a picture.

        Args:
            frames: of the source; read a second time if new frames lie between those of the journal.
            live: whether the source cannot give the earlier frames again; its frames get the next numbers as names.
        """
        shelf = self.ledger.shelf
        known = {number: name for number, (name, _) in shelf.journal.frames.items()}
        names = set(known.values())
        ahead: Iterator[Frame] = iter(()) if live else iter(frames)
        passed = False
        for number in range(1 + max(known, default=-1)):
            name, found = known.get(number), None
            for frame in ahead:
                if frame.name == name or (name is None and frame.name not in names):
                    found = frame
                    break
                passed = passed or frame.name not in names
            if name is None:
                if found is None:
                    self.remarks.append(f"{shelf.journal.path}: the row of frame number {number} is lost, and the "
                                        "source gives no such frame; the survey goes on without it")
                    continue
                shelf.call(number, found.name)
            elif found is None:
                picture = shelf.stored(name)
                found = Frame(name, NO_PICTURE if picture is None else picture, shelf.time(name))
            yield found
        if live:
            self._forget_without_picture()
            for k, frame in enumerate(frames, 1 + max(known, default=-1)):
                yield replace(frame, name=str(k))
            return
        for frames_left in (ahead, frames if passed else ()):
            for frame in frames_left:
                if frame.name not in self.done:
                    yield frame

    def _forget_without_picture(self) -> None:
        """A last frame whose picture is gone cannot be stored."""
        if self._last is not None and not self._last[0].picture.size:
            self._last = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            self.leave()
        else:
            self.close(finished=kind is None)
            if kind is None:
                self.mark_finished()

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
        """Take in the next frame; one that this object has taken in is skipped.

        Returns:
            The outcome, a phrase.

        Raises:
            ResumeError: if the frame was taken in before with another picture.
        """
        if frame.name in self.done:
            return f"{frame.name}: done before"
        new = frame.name not in self._recorded
        if new and not self.ledger.opened:
            self.open_table()
        shelf = self.ledger.shelf
        if new:
            shelf.describe(finished=False)
        shelf.take(frame)
        self.done.add(frame.name)
        try:
            outcome = self._take(frame)
        except ResumeError as error:
            if frame.picture.size:
                raise
            outcome = f"{error}; the survey goes on without this frame"
            self.remarks.append(outcome)
        shelf.let_go({frame.name, self._last[0].name} if self._last else {frame.name})
        now = time.monotonic()
        if new and now - self._updated_at >= max(self._every, 20 * self._update_took):
            self.results.write_growing()
            self._updated_at, self._update_took = time.monotonic(), time.monotonic() - now
        return outcome

    def open_table(self) -> None:
        """Write `edges.csv` with the edges so far, and go on with it."""
        if not self.ledger.open_table():
            self.remarks.append(f"{self.out / EDGES_FILE}: differs from what was measured; written anew from the "
                                "journal")
        for name in self.ledger.shelf.mended:
            self.remarks.append(f"{self.out / 'frames'}: the stored picture of frame {name} was lost or damaged; "
                                "stored again")

    def _take(self, frame: Frame) -> str:
        if not self.pieces:
            return self._begin(frame)
        return self._add_live(frame) if self.stream else self._add_snapshot(frame)

    def _add_snapshot(self, frame: Frame) -> str:
        edge = self._linked(frame.name)
        return self._begin(frame) if edge is None else self._store(frame, edge)

    def _linked(self, name: str) -> Edge | None:
        """The edge by which a frame follows one of the last, not noted yet; None if it follows none of them."""
        for other in self.pieces[-1].stored[: -1 - self.settings.back : -1]:
            edge = Edge.of(other, name, SEQUENCE, self.ledger.centre, self.ledger.register(other, name))
            if edge.accepted:
                return edge
            self.ledger.note(edge)
        return None

    def _add_live(self, frame: Frame) -> str:
        name = self.pieces[-1].stored[-1]
        result = self.ledger.register(name, frame.name, self._predict(), self.settings.reach)
        if not result.accepted and self._last is not None:
            # The view moves faster than the step allows: chain through the last good frame.
            self._store(*self._last)
            name = self.pieces[-1].stored[-1]
            result = self.ledger.register(name, frame.name, IDENTITY, self.settings.reach)
        if not result.accepted:
            result = self.ledger.register(name, frame.name)
        edge = self.ledger.note(Edge.of(name, frame.name, LIVE, self.ledger.centre, result))
        if not edge.accepted:
            self._lost += 1
            self._seen = self._before = None
            if self._lost > self.settings.patience:
                return self._begin(frame)
            return f"{name} to {frame.name}: {edge.reason}"
        self._lost = 0
        self._before, self._seen = self._seen, edge.similarity
        self.pieces[-1].hang(edge)
        self._last = frame, edge
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

    def _begin(self, frame: Frame) -> str:
        """Begin a piece with a frame."""
        self._keep(frame)
        self.ledger.solve(self.ledger.begin(frame.name))
        self._lost = 0
        self._forget_motion()
        if self.settings.loops and len(self.pieces) > 1:
            self._loops.join(frame.name)
        return f"{frame.name}: begins component {len(self.pieces)}"

    def _store(self, frame: Frame, edge: Edge) -> str:
        """Add a frame to the graph by an accepted edge, and look for its neighbours."""
        self._keep(frame)
        edge = replace(edge, kind=SEQUENCE)
        piece = self._enter(edge)
        self._forget_motion()
        found = self._loops.propose(piece, frame.name, edge) if self.settings.loops else 0
        self.ledger.settle(piece, frame.name)
        if self.settings.loops and len(self.pieces) > 1:
            found += self._loops.join(frame.name)
        return f"{edge.frame_a} to {frame.name}: {edge.shift[0]:.1f}, {edge.shift[1]:.1f} px, {found} other edges"

    def _enter(self, edge: Edge) -> Piece:
        """Add a frame to the component of another by their edge, which is noted."""
        self.ledger.note(edge)
        self._loops.tried[edge.frame_a, edge.frame_b] = edge.similarity
        piece = self.ledger.piece_of(edge.frame_a)
        self.ledger.enter(piece, edge)
        return piece

    def _keep(self, frame: Frame) -> None:
        """Put a frame on the shelf."""
        self.ledger.shelf.save(frame.name, frame.picture)
        self.results.show(frame.name, frame.picture if frame.picture.size else None)

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
        """Write the edges, poses and mosaics of what there is; `finished` if no more frames come.

        The survey is marked as finished by `mark_finished`, after all that is made of it.
        """
        if self._closed:
            return
        if finished:
            self.settle()
        if self._end():
            for piece in self.pieces:
                self.ledger.complete(piece)
            self.results.write_all()

    def leave(self) -> None:
        """Write the edges, the poses and a quick mosaic of what there is, and leave the rest to the next call."""
        if not self._closed and self._end():
            self.results.write_growing()

    @property
    def all_before(self) -> bool:
        """Whether a continued survey has had no new frame."""
        return bool(self.pieces) and not self.ledger.opened

    @property
    def shown(self) -> bool:
        """Whether there is a survey to show: not while a continued one is incomplete."""
        return bool(self.pieces) and self._recorded <= self.done

    def mark_finished(self) -> None:
        """Note in `run.json` that all files are made."""
        self.ledger.shelf.describe(finished=True)

    def _end(self) -> bool:
        """Write no more edges; returns `shown`: the files of a continued survey stay as they are while it is
        incomplete."""
        self._closed = True
        if self.shown and not self.ledger.opened:
            self.open_table()
        self.ledger.close_table()
        self.ledger.shelf.journal.close()
        return self.shown
