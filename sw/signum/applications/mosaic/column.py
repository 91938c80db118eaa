"""Single-column mosaics, by the paper's `make_single_column_mosaic()`.

    store an image; then, again and again: find the section at its top centre in the live image; when the section has
    come to the bottom centre, record the offset and store the live image.

`Column` is that loop for recorded frames (manual mode): every frame is registered against the last stored one.
Snapshots are all stored; of a stream a frame is stored when the view has moved by `step` of the frame. `fly` closes the
loop over a simulated camera (automatic mode): the error between section and bottom centre moves the vehicle.

An edge that is refused breaks the chain only if no earlier stored frame is found either; then a new piece begins, with
a mosaic of its own, and nothing is placed by guesswork.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from signum.applications.mosaic.blend import compose
from signum.applications.mosaic.pose import Pose, Settings
from signum.applications.pid import Gains, Pid
from signum.common.arrays import Image
from signum.frames.frame import Frame
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.register import Prepared, Registrar, Registration
from signum.tables.schemas import EDGES, POSES
from signum.tables.table import Table
from signum.world.scene import Camera, Vehicle


@dataclass(frozen=True)
class Edge:
    """A measured link between two frames, original pixels; as `EDGES`, and why it was refused, if it was."""

    frame_a: str
    frame_b: str
    dx_px: float
    dy_px: float
    score: float
    margin: float
    accepted: bool
    reason: str
    agreed: int
    tried: int

    @classmethod
    def of(cls, a: str, b: str, r: Registration) -> Edge:
        """From a registration of frame `a` in frame `b`."""
        return cls(a, b, *r.shift, r.score, r.margin, r.accepted, r.reason, r.agreed, r.tried)

    @property
    def row(self) -> list[object]:
        """The row of the table; displacements of refused edges are what was refused, not to be used."""
        figures = [f"{self.dx_px:.2f}", f"{self.dy_px:.2f}", f"{self.score:.4f}", f"{self.margin:.4f}"]
        return [self.frame_a, self.frame_b, *figures, int(self.accepted)]


@dataclass(frozen=True, eq=False)
class Stored:
    """A stored frame and its place: pixels of the frame -> mosaic plane of its piece."""

    name: str
    picture: Image
    prepared: Prepared
    place: Similarity


@dataclass
class Piece:
    """Frames that hang together."""

    stored: list[Stored] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)


class Column:
    """Builds a column mosaic frame by frame and writes its tables as it goes; a `with` writes the pictures at its end.

    Args:
        registrar: for frames of this size.
        out: folder for `edges.csv`, `poses.csv`, `mosaic.png`; further pieces get `poses-2.csv`, `mosaic-2.png`, ...
        stream: whether little moves between frames (a video), rather than a third of a frame (snapshots).
        settings: see `Settings`.
    """

    def __init__(self, registrar: Registrar, out: Path, stream: bool = False, settings: Settings | None = None) -> None:
        self.registrar, self.out, self.stream = registrar, out, stream
        self.settings = settings or Settings()
        self.pieces: list[Piece] = []
        self.edges: list[Edge] = []
        self._lost = 0
        self._seen: Registration | None = None
        self._before: Registration | None = None
        self._last: tuple[Frame, Prepared, Similarity] | None = None
        out.mkdir(parents=True, exist_ok=True)
        for old in (*out.glob("mosaic*.png"), *out.glob("poses*.csv")):
            old.unlink()
        self._edge_table = Table(out / "edges.csv", EDGES)
        self._pose_table: Table | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    @property
    def chain(self) -> list[Stored]:
        """Stored frames of the piece at work."""
        return self.pieces[-1].stored

    def add(self, frame: Frame) -> Edge | None:
        """Take in the next frame.

        Returns:
            The edge that places it, or the refused one; None for a frame that begins a piece without being tried.
        """
        prepared = self.registrar.prepare(frame.picture)
        if not self.pieces:
            self._begin(frame, prepared)
            return None
        if self.stream:
            return self._add_live(frame, prepared)
        return self._add_snapshot(frame, prepared)

    def _add_snapshot(self, frame: Frame, prepared: Prepared) -> Edge:
        for reference in self.chain[: -1 - self.settings.back : -1]:
            result = self.registrar.register(reference.prepared, prepared)
            edge = self._record(Edge.of(reference.name, frame.name, result))
            if result.accepted:
                self._place(frame, prepared, reference, result)
                return edge
        self._begin(frame, prepared)
        return edge

    def _add_live(self, frame: Frame, prepared: Prepared) -> Edge:
        reference = self.chain[-1]
        result = self.registrar.register(reference.prepared, prepared, self._predict(), self.settings.reach)
        if not result.accepted and self._last is not None and self._last[0].name != reference.name:
            self._store(*self._last)  # the view moves faster than the step allows: chain through the last good frame
            reference = self.chain[-1]
            result = self.registrar.register(reference.prepared, prepared, IDENTITY, self.settings.reach)
        if not result.accepted:
            result = self.registrar.register(reference.prepared, prepared)
        edge = self._record(Edge.of(reference.name, frame.name, result))
        if not result.accepted:
            self._lost += 1
            self._before = self._seen = None
            if self._lost > self.settings.patience:
                self._begin(frame, prepared)
            return edge
        self._lost = 0
        self._before, self._seen = self._seen, result
        place = reference.place @ result.similarity.inverse
        self._pose(frame.name, place)
        self._last = (frame, prepared, place)
        size = 2 * self.registrar.centre + 1
        moved = np.abs(result.shift) >= self.settings.step * size
        if moved.any() or abs(result.similarity.rot_deg) >= self.settings.turn_deg:
            self._store(*self._last)
        return edge

    def _predict(self) -> Similarity:
        """Where the next live frame should see the stored one: the last motion goes on."""
        if self._seen is None:
            return IDENTITY
        if self._before is None:
            return self._seen.similarity
        return self._seen.similarity @ self._before.similarity.inverse @ self._seen.similarity

    def _begin(self, frame: Frame, prepared: Prepared) -> None:
        """Begin a piece; its plane is this frame's."""
        self.pieces.append(Piece())
        self._lost = 0
        if self._pose_table:
            self._pose_table.close()
        self._pose_table = Table(self.out / f"poses{self._suffix(len(self.pieces))}.csv", POSES)
        self._pose(frame.name, IDENTITY)
        self._store(frame, prepared, IDENTITY)

    def _place(self, frame: Frame, prepared: Prepared, reference: Stored, result: Registration) -> None:
        place = reference.place @ result.similarity.inverse
        self._pose(frame.name, place)
        self._store(frame, prepared, place)

    def _store(self, frame: Frame, prepared: Prepared, place: Similarity) -> None:
        self.chain.append(Stored(frame.name, frame.picture, prepared, place))
        self._seen = self._before = None
        self._last = None

    def _pose(self, name: str, place: Similarity) -> None:
        x, y = place(self.registrar.centre)
        pose = Pose(name, float(x), float(y), place.rot_deg, place.scale)
        self.pieces[-1].poses.append(pose)
        assert self._pose_table is not None
        self._pose_table.write(pose.row)

    def _record(self, edge: Edge) -> Edge:
        self.edges.append(edge)
        self._edge_table.write(edge.row)
        return edge

    @staticmethod
    def _suffix(number: int) -> str:
        return "" if number == 1 else f"-{number}"

    def close(self) -> None:
        """Write the mosaics of what there is, and close the tables."""
        self._edge_table.close()
        if self._pose_table:
            self._pose_table.close()
        for number, piece in enumerate(self.pieces, 1):
            if number == 1 or len(piece.stored) > 1:
                pictures, places = self._shown(piece, last=number == len(self.pieces))
                mosaic = compose(pictures, places)
                cv2.imwrite(str(self.out / f"mosaic{self._suffix(number)}.png"), mosaic.picture)

    def _shown(self, piece: Piece, last: bool) -> tuple[list[Image], list[Similarity]]:
        """What a piece's mosaic shows: its stored frames, and of the one at work the last frame that was placed."""
        pictures, places = [s.picture for s in piece.stored], [s.place for s in piece.stored]
        if last and self._last is not None:
            pictures.append(self._last[0].picture)
            places.append(self._last[2])
        return pictures, places


@dataclass(frozen=True)
class Flight:
    """What the automatic mode tells after each live frame."""

    time: float
    picture: Image
    section: tuple[float, float]
    """Where the section is in the live frame, pixels."""
    error: tuple[float, float]
    """How far it is from the bottom centre (right, down), pixels."""
    stored: int
    """Frames stored so far."""
    valid: bool


def fly(column: Column, camera: Camera, vehicle: Vehicle, images: int, section: int = 64, dt: float = 0.2,
        epsilon: float = 4.0, gains: Gains | None = None, seconds: float = 120.0) -> Iterator[Flight]:
    """Automatic mode: the vehicle flies forward until `images` are stored, or the time is up.

    The section at the top centre of the stored image is followed in the live image and its error to the bottom centre
    is servoed to zero; within `epsilon` pixels of it the live image is stored and its offset recorded.

    Args:
        column: takes the stored frames; made for snapshots.
        camera, vehicle: the simulation. Image up is forward.
        images: to store, the first included.
        section: side of the section, pixels of the camera's frame.
        dt: seconds from live frame to live frame.
        epsilon: pixels.
        gains: of the controllers: metres of error -> m/s.
        seconds: at the most.
    """
    registrar = column.registrar
    width, height = camera.size
    edge = section / 2 + 8
    top, bottom = np.array([(width - 1) / 2, edge]), np.array([(width - 1) / 2, height - 1 - edge])
    metres = vehicle.pose.altitude / camera.focal
    ahead, aside = Pid(gains or Gains()), Pid(gains or Gains())
    picture = camera.look(vehicle.pose)
    column.add(Frame("0", picture))
    stored, seen, before = 1, IDENTITY, IDENTITY
    reference = registrar.prepare(picture)
    for _ in range(round(seconds / dt)):
        picture = camera.look(vehicle.pose)
        live = registrar.prepare(picture)
        predicted = seen @ before.inverse @ seen
        result = registrar.register(reference, live, predicted, 16)
        if not result.accepted:
            result = registrar.register(reference, live)
        if result.accepted:
            before, seen = seen, result.similarity
            at = seen(top)
            error = at - bottom
            # The section is above its goal: the scene must move down the image, so the vehicle goes forward (up).
            vehicle.step(ahead.step(-float(error[1]) * metres, dt), aside.step(float(error[0]) * metres, dt), dt)
        else:
            at, error = np.full(2, np.nan), np.full(2, np.nan)
            vehicle.step(ahead.hold(), aside.hold(), dt)
        if result.accepted and float(np.hypot(*error)) < epsilon:
            column.add(Frame(str(stored), picture))
            stored += 1
            reference, seen, before = live, IDENTITY, IDENTITY
        yield Flight(vehicle.time, picture, (float(at[0]), float(at[1])), (float(error[0]), float(error[1])), stored,
                     result.accepted)
        if stored >= images:
            return
