"""A survey, frame by frame: each is registered against the last, then against every neighbour the poses predict.

The vehicle's way is not told: a single column, columns flown back and forth, or any other track. What the sequence
places, least squares over all links (`graph`) keeps in place: after every stored frame the pairs whose predicted
overlap is large enough are measured, around the place predicted and as far as the prediction may be wrong by its own
account; what lands elsewhere is refused. Where the sequence breaks, a new piece begins, and frames of both sides are
tried until one link between the pieces is found and borne out by others.
"""

from __future__ import annotations

import csv
import io
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from signum.applications.mosaic.blend import compose, sketch
from signum.applications.mosaic.edges import JOIN, LIVE, LOOP, SEQUENCE, Link, read_links
from signum.applications.mosaic.georeference import Georeference, write_geotiff, write_world_file
from signum.applications.mosaic.ledger import Ledger, Piece
from signum.applications.mosaic.loops import Loops
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.shelf import ResumeError, Run, write_picture, write_text
from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.frames.frame import Frame
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Prepared, Registrar
from signum.tables.schemas import POSES

THUMB = 240
"""Longer side of the copies the growing mosaic is made of, pixels."""


class Survey(Ledger):
    """Builds a mosaic frame by frame and writes as it goes; a `with` writes the pictures at its end.

    Args:
        registrar: for frames of this size.
        out: folder for `edges.csv`, `poses.csv`, `mosaic.png`; further pieces get `poses-2.csv`, `mosaic-2.png`, ...
        stream: whether little moves between frames (a video), rather than a third of a frame (snapshots).
        settings: see `SurveySettings`.
        source: where the frames come from, for the record.
        resume: go on with the survey in the folder.
        every: least seconds between two looks at the growing mosaic; infinite for none.

    Raises:
        ResumeError: if there is nothing in the folder to go on with, or it was made otherwise.
    """

    def __init__(self, registrar: Registrar, out: Path, stream: bool = False, settings: SurveySettings | None = None,
                 source: str = "", resume: bool = False, every: float = math.inf) -> None:
        super().__init__(registrar, out, settings or SurveySettings())
        self.stream = stream
        self._loops = Loops(self)
        self.run = Run(source, self.size, stream, registrar.window, registrar.sigma, self.settings.columns)
        self.done: set[str] = set()
        self.ground: Callable[[list[Pose], tuple[float, float]], Georeference | None] | None = None
        """Where on the ground a piece lies, from its poses and the frames' centre: for world files and GeoTIFF."""
        self.trouble = ""
        """Why `ground` could not be told, after `close`."""
        self._every, self._seen_at, self._look_took = every, time.monotonic(), 0.0
        self._thumbs: dict[str, Image] = {}
        self._lost = 0
        self._forget()
        if resume:
            self._resume()
        else:
            self.shelf.clear()
        self.open_edges(anew=not resume)
        self.shelf.describe(self.run, finished=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close(finished=kind is None)

    def _forget(self) -> None:
        """Nothing is known of the motion any more."""
        self._seen: Similarity | None = None
        self._before: Similarity | None = None
        self._last: tuple[Frame, Prepared, Link] | None = None

    def add(self, frame: Frame) -> str:
        """Take in the next frame; one that was taken in before a crash is passed over.

        Returns:
            What came of it, a phrase.
        """
        if frame.name in self.done:
            return f"{frame.name}: done before"
        prepared = self.registrar.prepare(frame.picture)
        if not self.pieces:
            said = self._begin(frame, prepared)
        elif self.stream:
            said = self._add_live(frame, prepared)
        else:
            said = self._add_snapshot(frame, prepared)
        self.done.add(frame.name)
        now = time.monotonic()
        if now - self._seen_at >= max(self._every, 20 * self._look_took):
            self.look()
            self._seen_at, self._look_took = time.monotonic(), time.monotonic() - now
        return said

    def _add_snapshot(self, frame: Frame, prepared: Prepared) -> str:
        for name in self.pieces[-1].stored[: -1 - self.settings.back : -1]:
            result = self.registrar.register(self.prepared(name), prepared)
            link = Link.of(name, frame.name, SEQUENCE, self.centre, result)
            if link.accepted:
                return self._store(frame, prepared, link)
            self.note(link)
        return self._begin(frame, prepared)

    def _add_live(self, frame: Frame, prepared: Prepared) -> str:
        name = self.pieces[-1].stored[-1]
        result = self.registrar.register(self.prepared(name), prepared, self._predict(), self.settings.reach)
        if not result.accepted and self._last is not None:
            # The view moves faster than the step allows: chain through the last good frame.
            self._store(*self._last)
            name = self.pieces[-1].stored[-1]
            result = self.registrar.register(self.prepared(name), prepared, IDENTITY, self.settings.reach)
        if not result.accepted:
            result = self.registrar.register(self.prepared(name), prepared)
        link = self.note(Link.of(name, frame.name, LIVE, self.centre, result))
        if not link.accepted:
            self._lost += 1
            self._seen = self._before = None
            if self._lost > self.settings.patience:
                return self._begin(frame, prepared)
            return f"{name} to {frame.name}: {link.reason}"
        self._lost = 0
        self._before, self._seen = self._seen, link.similarity
        piece = self.pieces[-1]
        piece.hung[frame.name] = name, link.similarity.inverse
        piece.frames.append(frame.name)
        self._last = frame, prepared, link
        moved = np.abs(link.shift) >= self.settings.step * np.array(self.size)
        if moved.any() or abs(link.similarity.rot_deg) >= self.settings.turn_deg:
            return self._store(*self._last)
        return f"{name} to {frame.name}: {link.shift[0]:.1f}, {link.shift[1]:.1f} px"

    def _predict(self) -> Similarity:
        """Where the next live frame should see the stored one: the last motion goes on."""
        if self._seen is None:
            return IDENTITY
        if self._before is None:
            return self._seen
        return self._seen @ self._before.inverse @ self._seen

    def _begin(self, frame: Frame, prepared: Prepared) -> str:
        """Begin a piece; its plane is this frame's."""
        self.shelf.save(frame.name, frame.picture)
        self._keep(frame, prepared)
        self.shelf.start(frame.name)
        self.pieces.append(Piece([frame.name], {frame.name: IDENTITY}, frames=[frame.name]))
        self.solve(self.pieces[-1])
        self._lost = 0
        self._forget()
        if self.settings.loops and len(self.pieces) > 1:
            self._loops.join(frame.name)
        return f"{frame.name}: begins piece {len(self.pieces)}"

    def _store(self, frame: Frame, prepared: Prepared, link: Link) -> str:
        """Make a frame part of the graph by an accepted link, and look for its neighbours."""
        self.shelf.save(frame.name, frame.picture)
        self._keep(frame, prepared)
        link = replace(link, kind=SEQUENCE)
        self.note(link)
        self._loops.tried[link.frame_a, link.frame_b] = link.similarity
        self._forget()
        piece = self.piece_of(link.frame_a)
        self.enter(piece, link)
        found = self._loops.propose(piece, frame.name, link) if self.settings.loops else 0
        self.solve(piece)
        if self.settings.loops and len(self.pieces) > 1:
            found += self._loops.join(frame.name)
        return f"{link.frame_a} to {frame.name}: {link.shift[0]:.1f}, {link.shift[1]:.1f} px, {found} other links"

    def settle(self) -> None:
        """Store the last frame of a stream, however little it moved since the one before."""
        if self._last is not None:
            self._store(*self._last)

    def finish(self) -> Iterator[str]:
        """Look again for links the poses now predict, until there are no more; tells of each frame."""
        if self.settings.loops:
            for piece in list(self.pieces):
                yield from self._loops.exhaust(piece)

    def poses(self, piece: Piece) -> list[Pose]:
        """Poses of a piece's frames, in order."""
        out = []
        for name in piece.frames:
            place = piece.place(name)
            x, y = place(np.array(self.centre))
            out.append(Pose(name, float(x), float(y), place.rot_deg, place.scale))
        return out

    def _keep(self, frame: Frame, prepared: Prepared) -> None:
        self.shelf.prepared(frame.name, self.registrar, prepared)
        self._thumb(frame.name, frame.picture)

    def _thumb(self, name: str, picture: Image | None = None) -> Image:
        if name not in self._thumbs:
            whole = self.shelf.picture(name) if picture is None else picture
            less = THUMB / max(whole.shape[:2])
            self._thumbs[name] = np.asarray(cv2.resize(whole, None, fx=less, fy=less, interpolation=cv2.INTER_AREA),
                                            np.uint8) if less < 1 else whole
        return self._thumbs[name]

    def write_poses(self) -> None:
        """Write `poses.csv`, and of further pieces `poses-2.csv`, ..."""
        for number, piece in enumerate(self.ranked(), 1):
            text = io.StringIO()
            rows = csv.writer(text, lineterminator="\n")
            rows.writerow(POSES)
            rows.writerows(pose.row for pose in self.poses(piece))
            write_text(self.out / f"poses{suffix(number)}.csv", text.getvalue())
        for old in self.out.glob("poses-*.csv"):
            if int(old.stem.removeprefix("poses-")) > len(self.pieces):
                old.unlink()

    def look(self) -> None:
        """Write the growing mosaic, quickly, and the poses so far."""
        self.write_poses()
        piece = self.ranked()[0]
        picture = sketch([self._thumb(name) for name in piece.stored], [piece.places[n] for n in piece.stored],
                         self.size)
        write_picture(self.out / "mosaic.png", picture)

    def close(self, finished: bool = True) -> None:
        """Write poses and mosaics of what there is."""
        if self.edges.closed:
            return
        self.settle()
        self.edges.close()
        self.write_poses()
        self.trouble = ""
        for number, piece in enumerate(self.ranked(), 1):
            if number == 1 or len(piece.stored) > 1:
                self._picture(piece, suffix(number))
        self.shelf.describe(self.run, finished)

    def _picture(self, piece: Piece, ending: str) -> None:
        """Write a piece's mosaic, on the ground if it can be."""
        geo: Georeference | None = None
        if self.ground is not None:
            try:
                geo = self.ground(self.poses(piece), self.centre)
            except SignumError as error:
                self.trouble = self.trouble or str(error)
        upright = geo.upright if geo else IDENTITY
        mosaic = compose(self.shelf.pictures(piece.stored), [upright @ piece.places[name] for name in piece.stored])
        path = self.out / f"mosaic{ending}.png"
        write_picture(path, mosaic.picture)
        if geo:
            write_world_file(path.with_suffix(".pgw"), mosaic, geo)
            write_geotiff(path.with_suffix(".tif"), mosaic, geo)

    def _resume(self) -> None:
        described = self.shelf.described()
        path = self.out / "edges.csv"
        if described is None or not path.exists():
            raise ResumeError(f"{self.out}: no survey there to go on with; start it without --resume")
        difference = described[0].differs(self.run)
        if difference:
            raise ResumeError(f"{self.out}: holds a survey made with {difference}; go on with the same, "
                              "or start anew with --anew")
        for name in self.shelf.started():
            self.pieces.append(Piece([name], {name: IDENTITY}, frames=[name]))
            self.done.add(name)
        for link in read_links(path, self.centre):
            self._take(link)
        # What a crash left of a row goes.
        with path.open("rb+") as file:
            file.truncate(file.read().rfind(b"\n") + 1)
        for piece in self.pieces:
            self.solve(piece)

    def _take(self, link: Link) -> None:
        """Take in a link measured before a crash."""
        a, b = link.frame_a, link.frame_b
        self.know(link)
        if link.kind == LIVE or (link.accepted and link.kind == SEQUENCE):
            self.done.add(b)
        if link.kind in (LOOP, JOIN) or link.accepted:
            self._loops.tried[a, b] = IDENTITY
        if not link.accepted:
            return
        if link.kind == LIVE:
            piece = self.piece_of(a)
            piece.hung[b] = a, link.similarity.inverse
            piece.frames.append(b)
        elif link.kind == SEQUENCE:
            self.enter(self.piece_of(a), link)
        elif link.kind == JOIN:
            early, late = self.piece_of(a), self.piece_of(b)
            if early is not late:
                self.merge(early, late)


def suffix(number: int) -> str:
    """Of the files of a piece."""
    return "" if number == 1 else f"-{number}"
