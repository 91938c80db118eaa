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
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from sw.blend import compose, sketch
from sw.errors import SignumError
from sw.geometry import IDENTITY, Similarity, overlap
from sw.mosaic import POSES, Pose
from sw.mosaic import Settings as ColumnSettings
from sw.register import Prepared, Registrar
from sw.sources import Frame, Picture
from sw.survey.georeference import Georeference, write_geotiff, write_world_file
from sw.survey.graph import Solution, precision, solve
from sw.survey.links import JOIN, LINKS, LIVE, LOOP, SEQUENCE, Link, read_links
from sw.survey.shelf import ResumeError, Run, Shelf, write_picture, write_text

THUMB = 240
"""Longer side of the copies the growing mosaic is made of, pixels."""


@dataclass(frozen=True)
class Settings(ColumnSettings):
    """How a survey is made; see also `sw.mosaic.Settings`.

    Attributes:
        loops: whether links beside the sequence are looked for.
        overlap: least predicted overlap at which a link is proposed, share of a frame.
        apart: least distance of two frames that are both linked to a third, share of the frame's shorter side.
        proposals: most links proposed for a frame.
        share: least share of the windows that must agree on a proposed link: where it ought to be is known, so less
            than for a link of the sequence would be chance or two layers of relief.
        agreed: least number of them.
        gate: by how many standard deviations of the prediction a proposed link may miss it.
        relief: by which share of the frame's longer side more it may miss it: relief moves what is seen.
        farthest: pixels of the board searched around a prediction; where more would be needed, the whole frame is.
        joins: frames of other pieces tried for each stored one.
    """

    loops: bool = True
    overlap: float = 0.15
    apart: float = 0.1
    proposals: int = 8
    share: float = 0.6
    agreed: int = 6
    gate: float = 4.0
    relief: float = 0.02
    farthest: int = 64
    joins: int = 6


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


class Survey:
    """Builds a mosaic frame by frame and writes as it goes; a `with` writes the pictures at its end.

    Args:
        registrar: for frames of this size.
        out: folder for `edges.csv`, `poses.csv`, `mosaic.png`; further pieces get `poses-2.csv`, `mosaic-2.png`, ...
        stream: whether little moves between frames (a video), rather than a third of a frame (snapshots).
        settings: see `Settings`.
        source: where the frames come from, for the record.
        resume: go on with the survey in the folder.
        every: least seconds between two looks at the growing mosaic; infinite for none.

    Raises:
        ResumeError: if there is nothing in the folder to go on with, or it was made otherwise.
    """

    def __init__(self, registrar: Registrar, out: Path, stream: bool = False, settings: Settings | None = None,
                 source: str = "", resume: bool = False, every: float = math.inf) -> None:
        self.registrar, self.out, self.stream = registrar, out, stream
        self.settings = settings or Settings()
        self.centre = float(registrar.centre[0]), float(registrar.centre[1])
        self.size = registrar.fine.source
        self.shelf = Shelf(out)
        self.run = Run(source, self.size, stream, registrar.window, registrar.sigma, self.settings.loops)
        self.pieces: list[Piece] = []
        self.links: list[Link] = []
        self.done: set[str] = set()
        self.ground: Callable[[list[Pose], tuple[float, float]], Georeference | None] | None = None
        """Where on the ground a piece lies, from its poses and the frames' centre: for world files and GeoTIFF."""
        self.trouble = ""
        """Why `ground` could not be told, after `close`."""
        self._every, self._seen_at, self._look_took = every, time.monotonic(), 0.0
        self._thumbs: dict[str, Picture] = {}
        self._partners: dict[str, set[str]] = {}
        self._tried: dict[tuple[str, str], Similarity] = {}
        self._doubtful: list[Link] = []
        self._lost = 0
        self._forget()
        if resume:
            self._resume()
        else:
            self.shelf.clear()
        self._edges = (out / "edges.csv").open("a", newline="", encoding="utf-8")
        self._rows = csv.writer(self._edges, lineterminator="\n")
        if not resume:
            self._write(LINKS)
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
            result = self.registrar.register(self._prepared(name), prepared)
            link = Link.of(name, frame.name, SEQUENCE, self.centre, result)
            if link.accepted:
                return self._store(frame, prepared, link)
            self._note(link)
        return self._begin(frame, prepared)

    def _add_live(self, frame: Frame, prepared: Prepared) -> str:
        name = self.pieces[-1].stored[-1]
        result = self.registrar.register(self._prepared(name), prepared, self._predict(), self.settings.reach)
        if not result.accepted and self._last is not None:
            # The view moves faster than the step allows: chain through the last good frame.
            self._store(*self._last)
            name = self.pieces[-1].stored[-1]
            result = self.registrar.register(self._prepared(name), prepared, IDENTITY, self.settings.reach)
        if not result.accepted:
            result = self.registrar.register(self._prepared(name), prepared)
        link = self._note(Link.of(name, frame.name, LIVE, self.centre, result))
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
        self._solve(self.pieces[-1])
        self._lost = 0
        self._forget()
        if self.settings.loops and len(self.pieces) > 1:
            self._join(frame.name)
        return f"{frame.name}: begins piece {len(self.pieces)}"

    def _store(self, frame: Frame, prepared: Prepared, link: Link) -> str:
        """Make a frame part of the graph by an accepted link, and look for its neighbours."""
        self.shelf.save(frame.name, frame.picture)
        self._keep(frame, prepared)
        link = replace(link, kind=SEQUENCE)
        self._note(link)
        self._tried[link.frame_a, link.frame_b] = link.similarity
        self._forget()
        piece = self._piece(link.frame_a)
        self._enter(piece, link)
        found = self._propose(piece, frame.name, link) if self.settings.loops else 0
        self._solve(piece)
        if self.settings.loops and len(self.pieces) > 1:
            found += self._join(frame.name)
        return f"{link.frame_a} to {frame.name}: {link.shift[0]:.1f}, {link.shift[1]:.1f} px, {found} other links"

    @staticmethod
    def _enter(piece: Piece, link: Link) -> None:
        name = link.frame_b
        piece.hung.pop(name, None)
        piece.stored.append(name)
        if name not in piece.frames:
            piece.frames.append(name)
        piece.places[name] = piece.places[link.frame_a] @ link.similarity.inverse

    def _keep(self, frame: Frame, prepared: Prepared) -> None:
        self.shelf.prepared(frame.name, self.registrar, prepared)
        self._thumb(frame.name, frame.picture)

    def _thumb(self, name: str, picture: Picture | None = None) -> Picture:
        if name not in self._thumbs:
            whole = self.shelf.picture(name) if picture is None else picture
            less = THUMB / max(whole.shape[:2])
            self._thumbs[name] = np.asarray(cv2.resize(whole, None, fx=less, fy=less, interpolation=cv2.INTER_AREA),
                                            np.uint8) if less < 1 else whole
        return self._thumbs[name]

    def _prepared(self, name: str) -> Prepared:
        return self.shelf.prepared(name, self.registrar)

    def _piece(self, name: str) -> Piece:
        return next(piece for piece in reversed(self.pieces) if name in piece.places)

    def _note(self, link: Link) -> Link:
        """Record a link."""
        self._know(link)
        self._write(link.row)
        return link

    def _know(self, link: Link) -> None:
        self.links.append(link)
        if link.accepted and link.kind != LIVE:
            self._partners.setdefault(link.frame_a, set()).add(link.frame_b)
            self._partners.setdefault(link.frame_b, set()).add(link.frame_a)

    def _write(self, row: Sequence[object]) -> None:
        # A row goes to the disk in one piece, its newline with it.
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow(row)
        self._edges.write(line.getvalue())
        self._edges.flush()

    def _solve(self, piece: Piece) -> None:
        """Place the frames of a piece by all its links."""
        piece.solution = solve(piece.stored[0], self.links_of(piece), self.size, piece.places)
        piece.places.update(piece.solution.places)

    def _propose(self, piece: Piece, name: str, by: Link | None = None) -> int:
        """Measure the links of a frame that its predicted overlaps suggest; returns how many were accepted.

        Args:
            piece: the frame's.
            name: the frame.
            by: the link that has just placed it, which the solution does not know yet.
        """
        wanted = []
        order = {stored: k for k, stored in enumerate(piece.stored)}
        here = piece.places[name]
        middle = here(np.array(self.centre))
        reach = math.hypot(*self.size) * here.scale
        for other in piece.stored:
            pair = (other, name) if order[other] < order[name] else (name, other)
            if other == name or (by is not None and other == by.frame_a) or pair in self._tried:
                continue
            there = piece.places[other]
            if float(np.abs(there(np.array(self.centre)) - middle).max()) > reach:
                continue
            share = overlap(piece.places[pair[1]].inverse @ piece.places[pair[0]], self.size)
            if share >= self.settings.overlap:
                wanted.append((share, pair))
        wanted.sort(key=lambda one: -one[0])
        # Where frames lie close, links to two that are side by side say the same: they are to come from all around.
        near = self.settings.apart * min(self.size) * here.scale
        taken = [piece.places[partner](np.array(self.centre)) for partner in self._partners.get(name, ())
                 if partner in piece.places]
        room = self.settings.proposals
        found = 0
        for _, pair in wanted:
            at = piece.places[pair[0] if pair[1] == name else pair[1]](np.array(self.centre))
            if room and all(np.hypot(*(at - other)) >= near for other in taken):
                room -= 1
                if self._try(piece, pair, by):
                    taken.append(at)
                    found += 1
        return found

    def _try(self, piece: Piece, pair: tuple[str, str], by: Link | None) -> bool:
        """Measure a proposed link of a piece, and believe it if it lands where the poses allow."""
        a, b = pair
        predicted = piece.places[b].inverse @ piece.places[a]
        point = self._common(predicted)
        deviation = self._deviation(piece, a, b, point, by)
        link = self._measure(a, b, LOOP, predicted, deviation)
        self._tried[pair] = predicted
        self._note(link)
        return link.accepted

    def _common(self, predicted: Similarity) -> tuple[float, float]:
        """The middle of what two frames have in common, pixels of a."""
        middle = (np.array(self.centre) + predicted.inverse(np.array(self.centre))) / 2
        return float(middle[0]), float(middle[1])

    def _deviation(self, piece: Piece, a: str, b: str, at: tuple[float, float], by: Link | None) -> float:
        """Standard deviation of the prediction, pixels."""
        assert piece.solution is not None
        if by is None:
            return piece.solution.deviation(a, b, at)
        x, y = by.similarity.inverse((piece.places[b].inverse @ piece.places[a])(np.array(at)))
        known = piece.solution.deviation(a, by.frame_a, at) if a != by.frame_a else 0.0
        lever = math.dist((x, y), by.middle) / max(by.spread_px, 0.05 * max(self.size))
        return math.hypot(known, piece.solution.usual * math.hypot(1.0, lever) / math.sqrt(precision(by)))

    def _measure(self, a: str, b: str, kind: str, predicted: Similarity, deviation: float) -> Link:
        """Measure a link around its prediction; refused where it lands farther off than the prediction may be."""
        slack = self.settings.gate * deviation + self.settings.relief * max(self.size)
        reach = math.ceil(slack / max(self.registrar.fine.factor)) + 6
        near = reach <= self.settings.farthest
        result = self.registrar.register(self._prepared(a), self._prepared(b), predicted if near else None,
                                         max(reach, self.registrar.limits.reach) if near else None)
        reason = ""
        if result.accepted:
            point = np.array(result.middle)
            miss = float(np.hypot(*(result.similarity(point) - predicted(point))))
            turned = abs((result.similarity @ predicted.inverse).rot_deg)
            if result.agreed < max(self.settings.share * result.tried, self.settings.agreed):
                reason = f"only {result.agreed} of {result.tried} windows agree"
            elif miss > slack or turned > 6:
                reason = f"{miss:.0f} px and {turned:.1f} degrees off the place the other links give it"
        return Link.of(a, b, kind, self.centre, result, reason)

    def _join(self, name: str) -> int:
        """Look for a link from a frame of the last piece to the others; returns how many were accepted."""
        late = self._piece(name)
        others = [(piece, other) for piece in self.pieces if piece is not late for other in piece.stored]
        # Where columns turn, the frames after a break lie beside those as long before it; and a few from everywhere.
        place = late.stored.index(name)
        beside = others[::-1][place : place + self.settings.joins // 2]
        spread = [others[round(i)] for i in np.linspace(0, len(others) - 1, self.settings.joins)]
        tried: set[str] = set()
        for piece, other in (*beside, *spread):
            if other in tried or len(tried) >= self.settings.joins or piece not in self.pieces or piece is late:
                continue
            tried.add(other)
            if (other, name) in self._tried:
                continue
            result = self.registrar.register(self._prepared(other), self._prepared(name))
            self._tried[other, name] = IDENTITY
            if result.accepted and result.agreed >= max(self.settings.share * result.tried, self.settings.agreed):
                self._doubtful.append(Link.of(other, name, JOIN, self.centre, result))
        found = 0
        for link in list(self._doubtful):
            found += self._confirm(link)
        return found

    def _confirm(self, join: Link) -> int:
        """Believe a link between two pieces if a second one, where the first says it must be, is found too.

        Returns:
            Links accepted: 0, or 2 and more.
        """
        early, late = self._piece(join.frame_a), self._piece(join.frame_b)
        if early is late:
            self._doubtful.remove(join)
            return 0
        onto = early.places[join.frame_a] @ join.similarity.inverse @ late.places[join.frame_b].inverse
        wanted = []
        for a in early.stored:
            for b in late.stored:
                predicted = (onto @ late.places[b]).inverse @ early.places[a]
                share = overlap(predicted, self.size)
                if (a, b) != (join.frame_a, join.frame_b) and share >= self.settings.overlap:
                    wanted.append((share, a, b, predicted))
        wanted.sort(key=lambda one: -one[0])
        lever = 0.5 * max(self.size) / max(join.spread_px, 0.05 * max(self.size))
        deviation = 2 * math.hypot(1.0, lever) / math.sqrt(precision(join)) + 0.01 * max(self.size)
        links = [self._measure(a, b, JOIN, predicted, deviation)
                 for _, a, b, predicted in wanted[: self.settings.joins]]
        good = [link for link in links if link.accepted]
        if not links:
            return 0
        if 2 * len(good) < len(links):
            self._doubtful.remove(join)
            self._note(replace(join, accepted=False, reason="not borne out where others had to be"))
            return 0
        for link in (join, *links):
            self._note(link)
            self._tried[link.frame_a, link.frame_b] = IDENTITY
        self._doubtful.remove(join)
        self._merge(early, late)
        return 1 + len(good)

    def _merge(self, early: Piece, late: Piece) -> None:
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
        early.solution = solve(early.stored[0], self.links_of(early), self.size, start)
        early.places = dict(early.solution.places)
        self.pieces[position] = early
        self.pieces = [p for i, p in enumerate(self.pieces) if p is not late and (p is not early or i == position)]

    def settle(self) -> None:
        """Store the last frame of a stream, however little it moved since the one before."""
        if self._last is not None:
            self._store(*self._last)

    def finish(self) -> Iterator[str]:
        """Look again for links the poses now predict, until there are no more; tells of each frame."""
        if not self.settings.loops:
            return
        for piece in list(self.pieces):
            for _ in range(3):
                linked = {(link.frame_a, link.frame_b) for link in self.accepted}
                for pair, before in list(self._tried.items()):
                    if pair[0] in piece.places and pair[1] in piece.places and pair not in linked:
                        now = piece.places[pair[1]].inverse @ piece.places[pair[0]]
                        off = float(np.hypot(*(now(np.array(self.centre)) - before(np.array(self.centre)))))
                        if off > self.settings.relief * max(self.size):
                            del self._tried[pair]  # it was looked for elsewhere
                found = 0
                for name in list(piece.stored):
                    found += self._propose(piece, name)
                    yield f"{name}: looked for more links"
                if not found:
                    break
                self._solve(piece)

    def poses(self, piece: Piece) -> list[Pose]:
        """Poses of a piece's frames, in order."""
        out = []
        for name in piece.frames:
            place = piece.place(name)
            x, y = place(np.array(self.centre))
            out.append(Pose(name, float(x), float(y), place.rot_deg, place.scale))
        return out

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
        if self._edges.closed:
            return
        self.settle()
        self._edges.close()
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
            self._solve(piece)

    def _take(self, link: Link) -> None:
        """Take in a link measured before a crash."""
        a, b = link.frame_a, link.frame_b
        self._know(link)
        if link.kind == LIVE or (link.accepted and link.kind == SEQUENCE):
            self.done.add(b)
        if link.kind in (LOOP, JOIN) or link.accepted:
            self._tried[a, b] = IDENTITY
        if not link.accepted:
            return
        if link.kind == LIVE:
            piece = self._piece(a)
            piece.hung[b] = a, link.similarity.inverse
            piece.frames.append(b)
        elif link.kind == SEQUENCE:
            self._enter(self._piece(a), link)
        elif link.kind == JOIN:
            early, late = self._piece(a), self._piece(b)
            if early is not late:
                self._merge(early, late)


def suffix(number: int) -> str:
    """Of the files of a piece."""
    return "" if number == 1 else f"-{number}"
