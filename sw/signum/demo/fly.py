# SPDX-License-Identifier: Apache-2.0
"""The demonstration: a simulated flight over gravel through a board, and the report of it.

1. the stages of the filter, and the signs that remain in turbid water;        figures 3 and 8
2. a drift over the gravel: flow from frame to frame, features tracked;        figures 6 and 7
3. a single-column mosaic, flown by the paper's procedure;                     figures 14 and 15
4. a station held against a current by `signum hold`'s controller.             equations 2 to 7
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np

from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.applications.mosaic.column import fly_column
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.survey import Survey
from signum.boards.board import Board
from signum.common.arrays import Floats
from signum.common.files import write_picture
from signum.demo.flight import (
    CAMERA_FOCAL,
    CAMERA_SIZE,
    COLUMN_IMAGES,
    DT,
    FEATURES,
    FLIGHT_HEIGHT_M,
    FLOW_FRAMES,
    FREE_SECONDS,
    HELD_SECONDS,
    TRACKED,
    DemoFlight,
    Phase,
)
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.camera import Sight
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.measure.track import Tracker, TrackSettings
from signum.report.rows import track_row
from signum.reproduce import Progress, figure8
from signum.tables.schemas import TRACK
from signum.tables.table import Table
from signum.world.camera import Pinhole
from signum.world.degrade import degrade
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Current, Vehicle
from signum.world.water import Water
from signum.world.world import World

SENSOR = Water(noise=2.0)
"""Clear water; the noise of the sensor only."""
DRIFT_M_S = 0.1, -0.06
"""The steady current of the tracking run, north and east, m/s."""
SURGE_PERIOD = 8.0
"""Period of the surge of all currents, seconds."""
HOLD_RATE = 10.0
"""Frames a second for which the station keeper's gains are tuned."""


def run_demo(board: Board, out: Path, sigma: float, window: int, progress: Progress) -> Path:
    """Fly, and write `mosaic.png`, `track.csv`, the mosaic's tables, `overview.png` and `report.html`.

    Args:
        board: any.
        out: folder; made if missing.
        sigma: of the LoG, pixels.
        window: side of the correlation windows, pixels.
        progress: makes progress lines.

    Returns:
        The report's path.
    """
    from signum.demo.overview import overview
    from signum.demo.page import write_demo_report

    out.mkdir(parents=True, exist_ok=True)
    flight = DemoFlight(board.name, sigma, window)
    camera = Pinhole(CAMERA_SIZE, CAMERA_FOCAL)
    pixel = FLIGHT_HEIGHT_M / CAMERA_FOCAL
    floor = Seafloor(extent=1024 * pixel, texel=pixel, quilted=False)
    with _phase(flight, board, "filter", progress, 3) as step:
        _filter(flight, board, camera, floor, step)
    with _phase(flight, board, "flow and tracking", progress, TRACKED) as step:
        _track(flight, board, camera, floor, out, step)
    with _phase(flight, board, "mosaic", progress, None) as step:
        _mosaic(flight, board, camera, floor, out, step)
    with _phase(flight, board, "station keeping", progress, round((HELD_SECONDS + FREE_SECONDS) * HOLD_RATE)) as step:
        _station(flight, board, camera, floor, step)
    write_picture(out / "overview.png", overview(flight))
    return write_demo_report(flight, out)


@contextmanager
def _phase(flight: DemoFlight, board: Board, name: str, progress: Progress, total: int | None
           ) -> Iterator[Callable[[str], None]]:
    phase = Phase(name)
    clocks, began = board.clocks, time.perf_counter()
    with progress(name, total) as tell:
        def step(state: str) -> None:
            phase.frames += 1
            tell(state)

        yield step
    phase.clocks, phase.seconds = board.clocks - clocks, time.perf_counter() - began
    flight.phases.append(phase)


def _filter(flight: DemoFlight, board: Board, camera: Pinhole, floor: Seafloor, step: Callable[[str], None]) -> None:
    measurer = Measurer(board, camera.size, flight.sigma)
    picture = World(floor, SENSOR).look(camera, DOWN.sight(Vehicle())).frame
    flight.stage = picture, measurer.signs(measurer.view(picture))
    step("")
    photo = next(figure8.photographs())[1]
    degraded = degrade(photo)
    measurer = Measurer(board, (photo.shape[1], photo.shape[0]), 1.5)
    planes = []
    for image in (photo, degraded):
        planes.append(measurer.signs(measurer.view(image)))
        step("")
    flight.snow = photo, planes[0] * np.uint8(255), degraded, planes[1] * np.uint8(255)
    flight.agreement = figure8.agreement(planes[0], planes[1])


def _track(flight: DemoFlight, board: Board, camera: Pinhole, floor: Seafloor, out: Path,
           step: Callable[[str], None]) -> None:
    current = Current(steady=DRIFT_M_S, surge=(0.03, 0.03, 0.01), period=SURGE_PERIOD)
    world = World(floor, SENSOR, current=current, seed=3)
    vehicle = Vehicle(current=current, position=np.array([-0.6, 0.6, -FLIGHT_HEIGHT_M]),
                      velocity=np.array([*DRIFT_M_S, 0.0, 0.0, 0.0, 0.0]))
    fit = Fit(CAMERA_SIZE, CAMERA_SIZE)
    settings = TrackSettings(window=flight.window, features=FEATURES)
    tracker = Tracker(Measurer(board, camera.size, flight.sigma), settings)
    pictures, sights = [], []
    born: dict[int, tuple[int, Floats]] = {}
    errors = []
    measured = valid = 0
    table = Table(out / "track.csv", TRACK)
    for index in range(TRACKED):
        sights.append(DOWN.sight(vehicle))
        pictures.append(world.look(camera, sights[-1]).frame)
        seen = Frame(str(index), pictures[-1], vehicle.time)
        points = tracker.step(pictures[-1])
        for p in points:
            table.write(track_row(seen, p, fit))
            at = np.array([p.x, p.y])
            if p.feature not in born:
                born[p.feature] = index, at
                continue
            measured += p.reason != "outside"
            if p.valid:
                valid += 1
                since, start = born[p.feature]
                errors.append(at - _moved(camera, floor, sights[since], sights[-1], start))
        if index == 0:
            flight.initial = points
        flight.points = points
        vehicle.step(np.zeros(6), DT)
        world.step(DT)
        step(f"{sum(p.valid for p in points)} of {len(points)} features")
    table.close()
    flight.first, flight.last = pictures[0], pictures[-1]
    flight.errors, flight.tracked = np.array(errors).reshape(-1, 2), (measured, valid)
    measurer = Measurer(board, camera.size, flight.sigma)
    early, late = TRACKED - 1 - FLOW_FRAMES, TRACKED - 1
    views = measurer.view(pictures[early]), measurer.view(pictures[late])
    centre = np.array(camera.centre)
    true = _moved(camera, floor, sights[early], sights[late], centre) - centre
    window = min(flight.window, 48)
    found = measure_flow(measurer, *views, window=(window, window), step=32, support=1)
    flight.flow = pictures[early], pictures[late], found, (float(true[0]), float(true[1]))
    rows, columns = np.nonzero(found.valid)
    flight.flow_errors = np.array([
        (x + found.dx[j, i], y + found.dy[j, i]) - _moved(camera, floor, sights[early], sights[late], np.array([x, y]))
        for j, i, x, y in zip(rows, columns, found.x[columns], found.y[rows], strict=True)]).reshape(-1, 2)


def _mosaic(flight: DemoFlight, board: Board, camera: Pinhole, floor: Seafloor, out: Path,
            step: Callable[[str], None]) -> None:
    def measurer(size: tuple[int, int], sigma: float) -> Measurer:
        return Measurer(board, size, sigma)

    current = Current(steady=(0.05, 0.02), surge=(0.03, 0.015, 0.0), period=SURGE_PERIOD)
    world = World(floor, SENSOR, current=current, seed=1)
    vehicle = Vehicle(current=current, position=np.array([-2.0, 0.0, -FLIGHT_HEIGHT_M]))
    registrar = Registrar.on(measurer, Fit(CAMERA_SIZE, CAMERA_SIZE), flight.window, flight.sigma)
    taken: list[Sight] = []
    with Survey(registrar, out, settings=SurveySettings(loops=False)) as survey:
        for live in fly_column(world, vehicle, camera, survey, COLUMN_IMAGES, flight.window, DT):
            if live.stored > len(taken):
                taken.append(live.sight)
            step(f"{live.stored} of {COLUMN_IMAGES} images, error {np.hypot(*live.error):.0f} px")
    centre = np.array(camera.centre)
    for pose, sight in zip(survey.poses(survey.pieces[0]), taken, strict=False):
        there = _moved(camera, floor, sight, taken[0], centre)
        flight.poses.append(((pose.x_px, pose.y_px), (float(there[0]), float(there[1]))))
    flight.edges = len(survey.edges), sum(e.accepted for e in survey.edges)
    flight.mosaic = np.asarray(cv2.imread(str(out / "mosaic.png"), cv2.IMREAD_UNCHANGED), np.uint8)


def _station(flight: DemoFlight, board: Board, camera: Pinhole, floor: Seafloor, step: Callable[[str], None]) -> None:
    for control, seconds, kept in ((True, HELD_SECONDS, flight.held), (False, FREE_SECONDS, flight.free)):
        scenario = Scenario(seconds, HOLD_RATE, FLIGHT_HEIGHT_M, water=SENSOR, level_noise=0.0, seed=2,
                            window=flight.window, control=control)
        for moment in simulate_hold(lambda size: Measurer(board, size, flight.sigma), scenario, camera, floor):
            kept.append(moment)
            step(f"{100 * float(np.hypot(*moment.truth[:2])):.1f} cm off" + ("" if control else ", drifting free"))


def _moved(camera: Pinhole, floor: Seafloor, then: Sight, now: Sight, at: Floats) -> Floats:
    """Pixel (2,) in the view from `now` of the ground point at pixel `at` of the view from `then`."""
    u, v = at.astype(np.float32)[:, None]
    depth = np.asarray(cv2.remap(camera.meet(then, floor), u, v, cv2.INTER_LINEAR), np.float64)
    return np.asarray(camera.project(now, camera.unproject(then, at, depth.ravel()))[0])
