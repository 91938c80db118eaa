"""`signum navigate`."""

from __future__ import annotations

from enum import StrEnum
from itertools import count
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from signum.applications.navigate.aim import Aim, TargetFinder
from signum.applications.navigate.chart import Chart
from signum.applications.navigate.draw import draw_path
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.place import ANY_HEADING, LocaliseLimits, Place
from signum.boards.board import BoardBase
from signum.commands.common import (
    BoardName,
    BoardOption,
    CalibrationOption,
    OutOption,
    SigmaOption,
    WindowOption,
    app,
    board_of,
    clocks_line,
    fit_to,
    guarded,
    write_report,
)
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.frames.fit import Fit
from signum.measure.measurer import Measurer
from signum.sources.open import open_source
from signum.tables.schemas import GOTO, NAVIGATE
from signum.tables.table import Table


class Simulated(StrEnum):
    """What carries a simulated camera."""

    pan_tilt = "pan-tilt"
    vehicle = "vehicle"


SIMULATED = "simulated.txt"
"""Marks a mosaic that may be simulated anew."""
EVERY = 30
"""Frames between two looks at how far it has come."""


@app.command()
@guarded
def navigate(
    mosaic: Annotated[Path, typer.Argument(help="The --out folder of `signum mosaic`, or a picture of a mosaic. With "
                                           "--simulate the folder the simulated survey's mosaic goes to.",
                                           show_default=False)],
    source: Annotated[str | None, typer.Argument(help="Video, folder of pictures, ROS bag, .npy array or camera number "
                                                 "of the same camera.", show_default=False)] = None,
    output: OutOption = Path("out/navigate"),
    sigma: SigmaOption = 2.0,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
    calibration: CalibrationOption = None,
    goto: Annotated[str | None, typer.Option("--goto", help="Where to look: X,Y in pixels of mosaic.png, or a name of "
                                             "places.csv (name,x_px,y_px) beside it; goto.csv says where it is in each "
                                             "frame.", show_default=False)] = None,
    prior: Annotated[bool, typer.Option("--prior/--no-prior", help="Look where the frame before was found first, or "
                                        "everywhere each time.")] = True,
    any_heading: Annotated[bool, typer.Option("--any-heading", help="The camera may be turned any way against the "
                                              "mosaic.")] = False,
    simulate: Annotated[Simulated | None, typer.Option(
        "--simulate", help="A simulated camera surveys its floor, is taken somewhere else, and goes --goto: on a "
        "pan/tilt, or on a vehicle in a current.", show_default=False)] = None,
    seed: Annotated[int, typer.Option("--seed", help="Of the simulated world.")] = 0,
) -> None:
    """Find frames in a finished mosaic: `navigate.csv`, `path.png`, `report.html`; or look at a place of it.

    Example: `signum navigate out/mosaic dive2.mp4 --goto 420,310 --out out/navigate`
    """
    if (simulate is None) == (source is None):
        raise SignumError("give a SOURCE of recorded frames, or --simulate pan-tilt (or vehicle)")
    with board_of(board, window) as b:
        if simulate is not None:
            _simulated(b, simulate, mosaic, output, goto, seed)
        else:
            limits = LocaliseLimits(turns_deg=ANY_HEADING) if any_heading else LocaliseLimits()
            _recorded(b, Chart.load(mosaic), str(source), output, sigma, window, calibration, goto, prior, limits)


class _Log:
    """What is written of a run, frame by frame."""

    def __init__(self, output: Path, chart: Chart, target: tuple[float, float] | None) -> None:
        output.mkdir(parents=True, exist_ok=True)
        self.output, self.chart, self.target = output, chart, target
        self._table = Table(output / "navigate.csv", NAVIGATE)
        (output / "goto.csv").unlink(missing_ok=True)
        self._goto = Table(output / "goto.csv", GOTO) if target else None
        self.places: list[Place] = []
        self._size = (0, 0)

    def write(self, frame: str, size: tuple[int, int], aim: Aim) -> None:
        """Take in a frame; `aim` is what was found of it."""
        place, s = aim.place, aim.place.similarity
        figures = [""] * 4 if s is None else [f"{place.centre[0]:.2f}", f"{place.centre[1]:.2f}", f"{s.rot_deg:.3f}",
                                              f"{s.scale:.5f}"]
        self._table.write([frame, *figures, f"{place.score:.4f}", place.confidence])
        if self._goto is not None:
            self._goto.write([frame, *("" if not aim.known else f"{v:.2f}" for v in aim.error), int(aim.sharp)])
        self.places.append(place)
        self._size = size
        if len(self.places) % EVERY == 0:
            self.picture()

    def picture(self) -> None:
        """The mosaic with the way so far."""
        centres = [p.centre for p in self.places]
        last = self.places[-1].similarity if self.places else None
        cv2.imwrite(str(self.output / "path.png"), draw_path(self.chart, centres, last, self._size, self.target))

    def close(self) -> None:
        """Finish the files, and report."""
        self._table.close()
        if self._goto is not None:
            self._goto.close()
        if self.places:
            self.picture()
            write_report(self.output)


def _recorded(board: BoardBase, chart: Chart, source: str, output: Path, sigma: float, window: int,
              calibration: Path | None, goto: str | None, prior: bool, limits: LocaliseLimits) -> None:
    frames = open_source(source, calibration)
    target = None if goto is None else chart.place(goto)
    log = _Log(output, chart, target)
    pilot: TargetFinder | None = None
    try:
        with progress("navigate", frames.count) as tell:
            for frame in frames:
                if pilot is None:
                    fit = fit_to(frame, board, window, frames)
                    pilot = TargetFinder(_localiser(board, fit, chart, window, sigma, limits), target, patience=0)
                if not prior:
                    pilot.forget()
                aim = pilot.look(frame.picture)
                log.write(frame.name, frame.size, aim)
                tell(_said(aim))
    finally:
        log.close()
    found = sum(p.known for p in log.places)
    notes.print(clocks_line(board, len(log.places)))
    out.print(f"{output / 'navigate.csv'}: {found} of {len(log.places)} frames found")


def _simulated(board: BoardBase, kind: Simulated, mosaic: Path, output: Path, goto: str | None, seed: int) -> None:
    from signum.applications.navigate.simulate.pan_tilt import PanTiltScene, PanTiltSite, Step
    from signum.applications.navigate.simulate.truth import SURVEY_SIGMA, SURVEY_WINDOW
    from signum.applications.navigate.simulate.vehicle import Dive, VehicleSite

    if (mosaic / "mosaic.png").exists() and not (mosaic / SIMULATED).exists():
        raise SignumError(f"{mosaic}: holds a mosaic that was not simulated; give another folder for the simulated one")
    site = PanTiltSite(PanTiltScene(seed=seed)) if kind is Simulated.pan_tilt else VehicleSite(Dive(seed=seed))
    mosaic.mkdir(parents=True, exist_ok=True)
    (mosaic / SIMULATED).write_text(f"{kind}, seed {seed}\n", encoding="utf-8")
    notes.print(f"simulated {kind}, seed {seed}")
    with progress("survey", None) as tell:
        chart = site.survey(lambda s, wide: Measurer(board, s, wide), mosaic, tell)
    if goto is None:
        out.print(f"{mosaic / 'mosaic.png'}: {chart.size[0]}x{chart.size[1]}; choose a place of it with --goto X,Y")
        return
    target = chart.place(goto)
    size = site.size
    localiser = _localiser(board, Fit(size, size), chart, SURVEY_WINDOW, SURVEY_SIGMA, LocaliseLimits())
    rng = np.random.default_rng([seed, 22])
    way = (site.go(localiser, target, site.random_head(rng)) if isinstance(site, PanTiltSite)
           else site.go(localiser, target, site.random_start(rng)))
    log, names = _Log(output, chart, target), count()
    last: Step | None = None
    try:
        with progress("look at that", None) as tell:
            for last in way:
                log.write(str(next(names)), size, last.aim)
                cv2.imwrite(str(output / "view.png"), last.frame)
                tell(_said(last.aim))
    finally:
        log.close()
    assert last is not None
    notes.print(clocks_line(board, len(log.places)))
    error, state = float(np.hypot(*last.truth)), "there" if last.aim.sharp else "not there"
    out.print(f"{output / 'navigate.csv'}: {len(log.places)} frames, {state} after {last.time:.1f} s; in truth "
              f"{error:.2f} px off, {100 * error / size[0]:.2f} % of the view")


def _localiser(board: BoardBase, fit: Fit, chart: Chart, window: int, sigma: float, limits: LocaliseLimits
               ) -> Localiser:
    largest = board.config.max_width, board.config.max_height
    return Localiser(lambda size, wide: Measurer(board, size, wide), largest, fit, chart, window, sigma, limits)


def _said(aim: Aim) -> str:
    if not aim.known:
        return f"not found: {aim.place.reason}"
    x, y = aim.place.centre
    way = f", {float(np.hypot(*aim.error)):.0f} px to go" if np.isfinite(aim.error).all() else ""
    return f"at {x:.0f},{y:.0f}, confidence {aim.place.confidence}{way}"
