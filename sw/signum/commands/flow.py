# SPDX-License-Identifier: Apache-2.0
"""`signum flow`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from golden.params import DENSE, FULL, MAX_SIGMA, MIN_SIGMA
from signum.applications.mavlink.flow import FlowSink
from signum.commands.app import command
from signum.commands.focal import focal_px
from signum.commands.in_step import InStep
from signum.commands.moving import MovingRecord
from signum.commands.options import (
    BOARD,
    SOURCE,
    BoardName,
    BoardOption,
    BoardOptions,
    CalibrationOption,
    DenseOption,
    FocalOption,
    MavlinkOption,
    OutOption,
    SourceArgument,
    tell_defaults,
)
from signum.commands.session import Session
from signum.common.errors import SignumError
from signum.common.files import name_part, write_picture
from signum.frames.clock import FRAME_RATE
from signum.frames.frame import Frame
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.flow import FlowField, measure_flow
from signum.measure.measurer import Measurer, View
from signum.report.draw import draw_flow
from signum.report.movie import Movie
from signum.report.outlines import draw_outlines
from signum.report.rows import flow_rows
from signum.report.wheel import draw_wheel_flow
from signum.tables.schemas import FLOW

LOST = 0.25
"""Share of valid windows below which the search is widened."""
LEAST_STEP = 4
"""Least grid of the field without --dense, pixels."""


@dataclass(frozen=True)
class FlowGrid:
    """The board, and the grid of the field; what is not given depends on whether it is dense."""

    board: BoardOption = BoardName.golden
    sigma: Annotated[float | None, typer.Option(
        "--sigma", rich_help_panel=BOARD, min=MIN_SIGMA, max=MAX_SIGMA, show_default="2.0; 1.5 with --dense",
        help="Width of the LoG's Gaussian, pixels of the board's picture.")] = None
    window: Annotated[int | None, typer.Option(
        "--window", rich_help_panel=BOARD, min=8, max=128, show_default="64; 32 with --dense",
        help="Side of the correlation windows, pixels of the board's picture; with --dense 8, 16 or 32.")] = None
    dense: DenseOption = False
    moving: Annotated[bool, typer.Option(
        "--moving", rich_help_panel=BOARD, help="With --dense: what moves by itself, too, against the motion that "
        "most of the picture has.")] = False
    step: Annotated[int | None, typer.Option(
        "--step", min=1, max=255, show_default="32; 8 with --dense",
        help="Grid of the field, pixels of the board's picture.")] = None
    reach: Annotated[int, typer.Option("--reach", min=2, max=64, help="Largest change of the flow from frame to frame, "
                                       "pixels of the board's picture.")] = 16

    @property
    def chosen(self) -> BoardOptions:
        """The board, its filter and window."""
        sigma, window = (1.5, 32) if self.dense else (2.0, 64)
        return BoardOptions(self.board, self.sigma or sigma, self.window or window)

    @property
    def grid(self) -> int:
        """Grid of the field, pixels of the board's picture.

        Raises:
            SignumError: if it is too fine for a board without the dense engine, or such a board is to find what moves.
        """
        if self.moving and not self.dense:
            raise SignumError("--moving: only the dense engine can tell it; add --dense")
        step = self.step or (8 if self.dense else 32)
        if step < LEAST_STEP and not self.dense:
            raise SignumError(f"--step {step}: choose {LEAST_STEP} or more, or --dense")
        return step


GRID_DEFAULTS = FlowGrid()


@dataclass(frozen=True)
class FlowLens:
    """What makes pixels a frame radians per second, for an autopilot."""

    focal: FocalOption = None
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.1, max=1000.0, show_default="10", help="Frames per second of a source "
        "whose frames have no times.")] = None


LENS_DEFAULTS = FlowLens()


@command()
def flow(
    source: SourceArgument,
    calibration: CalibrationOption = None,
    lens: FlowLens = LENS_DEFAULTS,
    mavlink: MavlinkOption = None,
    output: OutOption = Path("out/flow"),
    search: FlowGrid = GRID_DEFAULTS,
    pictures: Annotated[int, typer.Option("--pictures", min=1, help="Every how many frames the field is also written "
                                          "as a picture.")] = 10,
) -> None:
    """Optical flow from frame to frame: `flow.csv`, `flow.mp4`, every tenth field as `flow_NAME.png`, `report.html`;
    to an autopilot, OPTICAL_FLOW. With `--dense` windows lie side by side all over the picture, drawn as a colour wheel
    has it: the hue is the direction. With `--moving` what moves by itself is outlined there, listed in `moving.csv`,
    and masked in `moving_NAME.png`.

    Example: `signum flow dive.mp4 --step 24 --out out/flow`
    """
    shares: list[float] = []
    draw, config, step = draw_wheel_flow if search.dense else draw_flow, DENSE if search.dense else FULL, search.grid
    tell_defaults({"sigma": (search.sigma, search.chosen.sigma), "window": (search.window, search.chosen.window),
                   "step": (search.step, step)})
    with Session("flow", search.chosen, output, source, calibration, lens.rate, config) as run:
        teller = FlowTeller(run, run.open(FlowSink(mavlink)) if mavlink is not None else None, lens, calibration)
        fit, measurer = run.fit, run.measurer(run.fit.board)
        run.page()
        table, movie = run.table("flow.csv", FLOW), Movie(run.file("flow.mp4"))
        run.at_end(movie.close)
        movers = MovingRecord(run, search.reach) if search.moving else None
        run.measured = lambda: sum(s > 0 for s in shares)
        run.summary = lambda: f"{output / 'flow.csv'}: {run.done} frames" + (
            f", {np.mean(shares):.0%} of the windows valid" if shares else ": a single frame has no flow"
        ) + teller.said + (movers.said if movers else "")
        last: tuple[Frame, View] | None = None
        guess = (0.0, 0.0)
        for frame in run.steps("flow", run.frames(), run.source.count):
            live = measurer.view(fit.show(frame.picture))
            if last is not None:
                field = _measure(measurer, (last[1], live), search, run.chosen.window, step, guess)
                guess = field.dominant()
                teller.send(last[0], frame, field)
                run.refused.update(field.refused)
                table.write_numbers(*flow_rows(last[0], frame, field, fit))
                shown, due = draw(fit.show(last[0].picture), field), run.done % pictures == 1 % pictures
                if movers is not None:
                    moving = movers.find(measurer, (last[1], live), field)
                    movers.write(last[0], frame, moving, due)
                    shown = draw_outlines(shown, moving)
                measurer.release(last[1])
                movie.write(shown)
                if due:
                    write_picture(run.file(f"flow_{name_part(last[0].name)}.png"), shown)
                shares.append(float(field.valid.mean()))
                run.report = run.report_folder
            last = frame, live
            run.tell(f"{shares[-1]:.0%} valid" if shares else "")


class FlowTeller(InStep):
    """Sends the fields between frames, if anywhere, in step with real time.

    Args:
        run: the session, whose source is live or is played in real time.
        sink: of the messages.
        lens: the user's.
        calibration: of the camera.
    """

    def __init__(self, run: Session, sink: FlowSink | None, lens: FlowLens, calibration: Path | None) -> None:
        super().__init__(sink, paced=not run.live)
        self._sink, self._frames = sink, 0
        self._rate = lens.rate or run.source.rate or FRAME_RATE
        self._origin: float | None = None
        if sink is not None:
            focal = focal_px(lens.focal, calibration, run.fit.source, "rates of turn scale inversely")
            self._focal = focal / run.fit.factor[0], focal / run.fit.factor[1]

    def send(self, before: Frame, after: Frame, field: FlowField) -> None:
        """Send the field between two frames, in the board's pixels, at the later one's time."""
        if self._sink is None:
            return
        if self._origin is None:
            self._origin = before.time_s or 0.0
            self.begin(before.time_s)
        self._frames += 1
        if before.time_s is None or after.time_s is None:
            moment, step = self._frames / self._rate, 1 / self._rate
        else:
            moment, step = after.time_s - self._origin, after.time_s - before.time_s
        self.wait(moment)
        self._sink.send(moment, step, field, self._focal)


def _measure(measurer: Measurer, views: tuple[View, View], search: FlowGrid, window: int, step: int,
             guess: tuple[float, float]) -> FlowField:
    """The field, searched for around the last field's motion; where that loses most windows, over a wider range."""
    def within(reach: int, guess: tuple[float, float]) -> FlowField:
        if search.dense:
            return measure_dense_flow(measurer, *views, window, step, (reach, reach), guess)
        return measure_flow(measurer, *views, (window, window), step, (reach, reach), guess, support=1)

    field = within(search.reach, guess)
    if field.valid.mean() < LOST:
        other = within(min(3 * search.reach, min(measurer.size) // 2), (0.0, 0.0))
        field = other if other.valid.sum() > field.valid.sum() else field
    return field
