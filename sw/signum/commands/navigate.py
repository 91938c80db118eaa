# SPDX-License-Identifier: Apache-2.0
"""`signum navigate`."""

from __future__ import annotations

import os
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import count
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from signum.applications.mosaic.shelf import find_survey, survey_files
from signum.applications.navigate.aim import Aim, TargetFinder
from signum.applications.navigate.chart import Chart
from signum.applications.navigate.draw import draw_path
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.place import ANY_HEADING, LocaliseLimits, Place
from signum.commands.app import command
from signum.commands.options import SIMULATION, BoardOptions, CalibrationOption, OutOption, SeedOption
from signum.commands.outputs import lock
from signum.commands.session import Session, kind_of
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.common.files import real_path, write_picture, write_text
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.report.rows import seconds
from signum.tables.schemas import GOTO, NAVIGATE

BOARD_DEFAULTS = BoardOptions()
SEARCH = "Search"
SIMULATED = "simulated.txt"
"""File that marks a folder's mosaic as simulated, so that it may be overwritten."""
EVERY = 30
"""Frames between two pictures of the path so far."""


class Carrier(StrEnum):
    """What carries a simulated camera."""

    pan_tilt = "pan-tilt"
    vehicle = "vehicle"


@dataclass(frozen=True)
class SearchOptions:
    """Where a frame is looked for in the mosaic."""

    prior: Annotated[bool, typer.Option(
        "--prior/--no-prior", rich_help_panel=SEARCH, help="Search first around the place of the frame before, or "
        "everywhere each time.")] = True
    any_heading: Annotated[bool, typer.Option(
        "--any-heading", rich_help_panel=SEARCH, help="The camera may be turned by any angle against the mosaic.",
    )] = False


@dataclass(frozen=True)
class CarrierOptions:
    """The simulated camera that is navigated instead of recorded frames."""

    simulate: Annotated[Carrier | None, typer.Option(
        "--simulate", rich_help_panel=SIMULATION, show_default=False, help="A simulated camera surveys its floor, is "
        "moved somewhere else, and goes to the --goto place: on a pan/tilt, or on a vehicle in a current.")] = None
    seed: SeedOption = 0


SEARCH_DEFAULTS, NOT_SIMULATED = SearchOptions(), CarrierOptions()


@command()
def navigate(
    mosaic: Annotated[Path, typer.Argument(help="The --out folder of `signum mosaic`, or a picture of a mosaic. With "
                                           "--simulate the folder for the simulated survey's mosaic.",
                                           show_default=False)],
    source: Annotated[str | None, typer.Argument(help="Video, folder of pictures, ROS bag, .npy array, camera number "
                                                 "or stream of the same camera.", show_default=False)] = None,
    calibration: CalibrationOption = None,
    output: OutOption = Path("out/navigate"),
    board: BoardOptions = BOARD_DEFAULTS,
    goto: Annotated[str | None, typer.Option("--goto", help="Where to look: X,Y in pixels of mosaic.png, or a name of "
                                             "places.csv (name,x_px,y_px) beside it; goto.csv gives where it is in "
                                             "each frame.", show_default=False)] = None,
    search: SearchOptions = SEARCH_DEFAULTS,
    simulation: CarrierOptions = NOT_SIMULATED,
) -> None:
    """Find frames in a finished mosaic: `navigate.csv`, `path.png`, `report.html`; or look at a place of it.

    Example: `signum navigate out/mosaic dive2.mp4 --goto 420,310 --out out/navigate`
    """
    if (simulation.simulate is None) == (source is None):
        raise SignumError("give a SOURCE of recorded frames, or --simulate pan-tilt (or vehicle)")
    with Session("navigate", board, output, source, calibration) as run:
        if simulation.simulate is not None:
            _simulated(run, simulation.simulate, simulation.seed, mosaic, goto)
        else:
            _recorded(run, Chart.load(mosaic), goto, search)


class _Log:
    """The tables and the picture of a run, written frame by frame, and the report at its end."""

    def __init__(self, run: Session, chart: Chart, target: tuple[float, float] | None) -> None:
        self.chart, self.target = chart, target
        self._run = run
        run.page()
        self._table = run.table("navigate.csv", NAVIGATE)
        self._goto = run.table("goto.csv", GOTO) if target else None
        self._path = run.file("path.png")
        self.places: list[Place] = []
        self._size = (0, 0)
        run.at_end(self.draw)

    def write(self, frame: Frame, aim: Aim) -> None:
        """Take in a frame; `aim` is what was found of it."""
        place, s = aim.place, aim.place.similarity
        head = frame.name, seconds(frame.time_s)
        figures = [""] * 4 if s is None else [f"{place.centre[0]:.2f}", f"{place.centre[1]:.2f}", f"{s.rot_deg:.3f}",
                                              f"{s.scale:.5f}"]
        self._table.write([*head, *figures, f"{place.score:.4f}", place.confidence])
        if self._goto is not None:
            self._goto.write([*head, *("" if not aim.known else f"{v:.2f}" for v in aim.error), int(aim.sharp)])
        if not place.known:
            self._run.refused[kind_of(place.reason)] += 1
        self.places.append(place)
        self._size = frame.size
        self._run.report = self._run.report_folder
        if len(self.places) % EVERY == 0:
            self.draw()

    def draw(self) -> None:
        """Write the mosaic with the path so far, if there is one."""
        if self.places:
            centres = [p.centre for p in self.places]
            last = self.places[-1].similarity
            shown = draw_path(self.chart, centres, last, self._size, self.target)
            write_picture(self._path, shown)


def _recorded(run: Session, chart: Chart, goto: str | None, search: SearchOptions) -> None:
    """Frames from elsewhere."""
    target = None if goto is None else chart.place(goto)
    log = _Log(run, chart, target)
    limits = LocaliseLimits(turns_deg=ANY_HEADING) if search.any_heading else LocaliseLimits()
    localiser = _localiser(run, run.fit, chart, run.chosen.window, run.chosen.sigma, limits)
    finder = TargetFinder(localiser, target, patience=0)
    run.measured = lambda: sum(p.known for p in log.places)
    run.summary = lambda: (f"{run.folder / 'navigate.csv'}: {sum(p.known for p in log.places)} of {len(log.places)} "
                           "frames found")
    for frame in run.steps("navigate", run.frames(), run.source.count):
        if not search.prior:
            finder.forget()
        aim = finder.look(frame.picture)
        log.write(frame, aim)
        run.tell(_word(aim))


def _simulated(run: Session, carrier: Carrier, seed: int, mosaic: Path, goto: str | None) -> None:
    """A survey by a simulated camera, then its way to the target."""
    from signum.applications.navigate.simulate.pan_tilt import PanTiltScene, PanTiltSite, Step
    from signum.applications.navigate.simulate.truth import SURVEY_SIGMA, SURVEY_WINDOW
    from signum.applications.navigate.simulate.vehicle import Dive, VehicleSite

    survey = find_survey(mosaic)
    held = survey_files(mosaic) if mosaic.is_dir() else []
    if held and (not (mosaic / SIMULATED).exists() or (survey is not None and survey.source)):
        raise SignumError(f"{mosaic}: holds {held[0]} of a survey that was not simulated; give another folder for the "
                          "simulated one")
    site = PanTiltSite(PanTiltScene(seed=seed)) if carrier is Carrier.pan_tilt else VehicleSite(Dive(seed=seed))
    mosaic.mkdir(parents=True, exist_ok=True)
    if real_path(mosaic) != real_path(run.folder):
        run.at_end(partial(os.close, lock(mosaic)))
    write_text(mosaic / SIMULATED, f"{carrier}, seed {seed}\n")
    notes.print(f"simulated {carrier}, seed {seed}")
    with progress("survey", None) as tell:
        chart = site.survey(run.measurer, mosaic, tell)
    if goto is None:
        out.print(f"{mosaic / 'mosaic.png'}: {chart.size[0]}x{chart.size[1]}; choose a place of it with --goto X,Y")
        return
    target, size = chart.place(goto), site.size
    localiser = _localiser(run, Fit(size, size), chart, SURVEY_WINDOW, SURVEY_SIGMA, LocaliseLimits())
    rng = np.random.default_rng([seed, 22])
    way = (site.go(localiser, target, site.random_head(rng)) if isinstance(site, PanTiltSite)
           else site.go(localiser, target, site.random_start(rng)))
    log, names = _Log(run, chart, target), count()

    def outcome(last: Step) -> str:
        error, state = float(np.hypot(*last.truth)), "there" if last.aim.sharp else "not there"
        return (f"{run.folder / 'navigate.csv'}: {len(log.places)} frames, {state} after {last.time:.1f} s; in truth "
                f"{error:.2f} px off, {100 * error / size[0]:.2f} % of the view")

    for step in run.steps("look at that", way, None):
        log.write(Frame(str(next(names)), step.frame, step.time), step.aim)
        write_picture(run.file("view.png"), step.frame)
        run.summary = partial(outcome, step)
        run.tell(_word(step.aim))


def _localiser(run: Session, fit: Fit, chart: Chart, window: int, sigma: float, limits: LocaliseLimits) -> Localiser:
    largest = run.board.config.max_width, run.board.config.max_height
    return Localiser(run.measurer, largest, fit, chart, window, sigma, limits)


def _word(aim: Aim) -> str:
    """A frame's outcome for the progress line."""
    if not aim.known:
        return f"not found: {aim.place.reason}"
    x, y = aim.place.centre
    way = f", {float(np.hypot(*aim.error)):.0f} px to go" if np.isfinite(aim.error).all() else ""
    return f"at {x:.0f},{y:.0f}, confidence {aim.place.confidence}{way}"
