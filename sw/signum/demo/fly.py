"""The demonstration: a simulated flight over gravel through a board, and the report of it.

1. the stages of the filter, and what is left of the signs in bad water;        figures 3 and 8
2. a drift over the gravel: flow from frame to frame, features tracked;          figures 6 and 7
3. a single-column mosaic, flown by the paper's procedure;                       figures 14 and 15
4. a station held against a current.                                             equations 2 to 5
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import cv2
import numpy as np

from signum.applications.hold.station import hold
from signum.applications.mosaic.column import Column, fly
from signum.boards.board import Board
from signum.common.arrays import Floats
from signum.demo.flight import (
    DT,
    FEATURES,
    FLOW_FRAMES,
    FOCAL,
    FREE_SECONDS,
    HELD_SECONDS,
    IMAGES,
    SIZE,
    TRACKED,
    Flight,
    Phase,
)
from signum.frames.fit import Fit
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.measure.track import Tracker, TrackSettings
from signum.report.rows import track_row
from signum.reproduce import figure8
from signum.tables.schemas import TRACK
from signum.tables.table import Table
from signum.world.degrade import degrade
from signum.world.scene import Camera, Current, Pose, Vehicle, gravel

Bar = Callable[[str, int | None], AbstractContextManager[Callable[[str], None]]]
"""Makes a progress line: (what, total) -> a call for every frame."""


def run_demo(board: Board, out: Path, sigma: float, window: int, bar: Bar) -> Path:
    """Fly, and write `mosaic.png`, `track.csv`, the mosaic's tables, `overview.png` and `report.html`.

    Args:
        board: any.
        out: folder; made if missing.
        sigma: of the LoG, pixels.
        window: side of the correlation windows, pixels.
        bar: makes progress lines.

    Returns:
        The report's path.
    """
    from signum.demo.overview import overview
    from signum.demo.page import write_report

    out.mkdir(parents=True, exist_ok=True)
    flight = Flight(board.name, sigma, window)
    camera = Camera(gravel(), size=SIZE, focal=FOCAL, ground_pixel=2.0 / FOCAL)
    with _phase(flight, board, "filter", bar, 3) as step:
        _filter(flight, board, camera, step)
    with _phase(flight, board, "flow and tracking", bar, TRACKED) as step:
        _track(flight, board, camera, out, step)
    with _phase(flight, board, "mosaic", bar, None) as step:
        _mosaic(flight, board, camera, out, step)
    with _phase(flight, board, "station keeping", bar, round((HELD_SECONDS + FREE_SECONDS) / DT)) as step:
        _station(flight, board, camera, step)
    cv2.imwrite(str(out / "overview.png"), overview(flight))
    return write_report(flight, out)


@contextmanager
def _phase(flight: Flight, board: Board, name: str, bar: Bar, total: int | None) -> Iterator[Callable[[str], None]]:
    phase = Phase(name)
    clocks, began = board.clocks, time.perf_counter()
    with bar(name, total) as tell:
        def step(state: str) -> None:
            phase.frames += 1
            tell(state)

        yield step
    phase.clocks, phase.seconds = board.clocks - clocks, time.perf_counter() - began
    flight.phases.append(phase)


def _filter(flight: Flight, board: Board, camera: Camera, step: Callable[[str], None]) -> None:
    measurer = Measurer(board, camera.size, flight.sigma)
    picture = camera.look(Pose())
    flight.stage = picture, measurer.signs(measurer.view(picture))
    step("")
    photo = next(figure8.pictures())[1]
    degraded = degrade(photo)
    measurer = Measurer(board, (photo.shape[1], photo.shape[0]), 1.5)
    planes = []
    for image in (photo, degraded):
        planes.append(measurer.signs(measurer.view(image)))
        step("")
    flight.snow = photo, planes[0] * np.uint8(255), degraded, planes[1] * np.uint8(255)
    flight.agreement = figure8.agreement(planes[0], planes[1])


def _track(flight: Flight, board: Board, camera: Camera, out: Path, step: Callable[[str], None]) -> None:
    vehicle = Vehicle(Pose(-0.6, 0.6), current=Current(steady=(0.02, 0.0), surge=0.04, gusts=0.02, seed=3))
    fit = Fit(SIZE, SIZE)
    settings = TrackSettings(window=flight.window, features=FEATURES)
    tracker = Tracker(Measurer(board, camera.size, flight.sigma), settings)
    pictures, poses = [], []
    born: dict[int, tuple[int, Floats]] = {}
    errors = []
    measured = valid = 0
    table = Table(out / "track.csv", TRACK)
    for index in range(TRACKED):
        pictures.append(camera.look(vehicle.pose))
        poses.append(vehicle.pose)
        points = tracker.step(pictures[-1])
        for p in points:
            table.write(track_row(str(index), p, fit))
            at = np.array([p.x, p.y])
            if p.feature not in born:
                born[p.feature] = index, at
                continue
            measured += p.reason != "outside"
            if p.valid:
                valid += 1
                since, start = born[p.feature]
                errors.append(at - _seen(camera, poses[since], vehicle.pose, start))
        if index == 0:
            flight.initial = points
        flight.points = points
        vehicle.step(0.08, 0.04, DT)
        step(f"{sum(p.valid for p in points)} of {len(points)} features")
    table.close()
    flight.first, flight.last = pictures[0], pictures[-1]
    flight.errors, flight.tracked = np.array(errors).reshape(-1, 2), (measured, valid)
    measurer = Measurer(board, camera.size, flight.sigma)
    early, late = TRACKED - 1 - FLOW_FRAMES, TRACKED - 1
    views = measurer.view(pictures[early]), measurer.view(pictures[late])
    centre = (np.array(SIZE) - 1) / 2
    true = _seen(camera, poses[early], poses[late], centre) - centre
    window = min(flight.window, 48)
    field_ = measure_flow(measurer, *views, window=(window, window), step=32, support=1)
    flight.flow = pictures[early], pictures[late], field_, (float(true[0]), float(true[1]))


def _mosaic(flight: Flight, board: Board, camera: Camera, out: Path, step: Callable[[str], None]) -> None:
    def measurer(size: tuple[int, int], sigma: float) -> Measurer:
        return Measurer(board, size, sigma)

    vehicle = Vehicle(Pose(0.0, 2.0), current=Current(steady=(0.05, 0.02), surge=0.03, gusts=0.01, seed=1))
    home = vehicle.pose
    registrar = Registrar.on(measurer, Fit(SIZE, SIZE), flight.window, flight.sigma)
    taken = [home]
    with Column(registrar, out) as column:
        before = home
        for live in fly(column, camera, vehicle, IMAGES, section=flight.window, dt=DT):
            if live.stored > len(taken):
                taken.append(before)
            before = vehicle.pose
            step(f"{live.stored} of {IMAGES} images, error {np.hypot(*live.error):.0f} px")
    centre = (np.array(SIZE) - 1) / 2
    for pose, true in zip(column.pieces[0].poses, taken, strict=False):
        there = _seen(camera, true, home, centre)
        flight.poses.append(((pose.x_px, pose.y_px), (float(there[0]), float(there[1]))))
    flight.edges = len(column.edges), sum(e.accepted for e in column.edges)
    flight.mosaic = np.asarray(cv2.imread(str(out / "mosaic.png"), cv2.IMREAD_UNCHANGED), np.uint8)


def _station(flight: Flight, board: Board, camera: Camera, step: Callable[[str], None]) -> None:
    for control, seconds, kept in ((True, HELD_SECONDS, flight.held), (False, FREE_SECONDS, flight.free)):
        vehicle = Vehicle(Pose(0.2, 0.1), current=Current(seed=2))
        measurer = Measurer(board, camera.size, flight.sigma)
        for moment in hold(measurer, camera, vehicle, seconds, DT, flight.window, control=control):
            kept.append(moment)
            step(f"{100 * float(np.hypot(*moment.true)):.1f} cm off" + ("" if control else ", drifting free"))


def _seen(camera: Camera, then: Pose, now: Pose, at: Floats) -> Floats:
    """Where what was at pixel `at` of the view from `then` is in the view from `now`."""
    there, here = camera.matrix(then), camera.matrix(now)
    ground = there[:, :2] @ at + there[:, 2]
    return np.asarray(np.linalg.solve(here[:, :2], ground - here[:, 2]), np.float64)
