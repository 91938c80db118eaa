# SPDX-License-Identifier: Apache-2.0
"""`signum flow`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from signum.commands.app import command
from signum.commands.options import BoardOptions, CalibrationOption, OutOption, SourceArgument
from signum.commands.session import Session
from signum.common.files import name_part, write_picture
from signum.frames.frame import Frame
from signum.measure.flow import FlowField, measure_flow
from signum.measure.measurer import Measurer, View
from signum.report.draw import draw_flow
from signum.report.movie import Movie
from signum.report.rows import flow_rows
from signum.tables.schemas import FLOW

LOST = 0.25
"""Share of valid windows below which the search is widened."""
BOARD_DEFAULTS = BoardOptions()


@command()
def flow(
    source: SourceArgument,
    calibration: CalibrationOption = None,
    output: OutOption = Path("out/flow"),
    board: BoardOptions = BOARD_DEFAULTS,
    step: Annotated[int, typer.Option("--step", min=4, help="Grid of the field, pixels of the board's picture.")] = 32,
    reach: Annotated[int, typer.Option("--reach", min=2, max=64, help="Largest change of the flow from frame to frame, "
                                       "pixels of the board's picture.")] = 16,
    pictures: Annotated[int, typer.Option("--pictures", min=1, help="Every how many frames the field is also written "
                                          "as a picture.")] = 10,
) -> None:
    """Optical flow from frame to frame: `flow.csv`, `flow.mp4`, every tenth field as `flow_NAME.png`, `report.html`.

    Example: `signum flow dive.mp4 --step 24 --out out/flow`
    """
    shares: list[float] = []
    with Session("flow", board, output, source, calibration) as run:
        fit, measurer = run.fit, run.measurer(run.fit.board)
        run.page()
        table, movie = run.table("flow.csv", FLOW), Movie(run.file("flow.mp4"))
        run.at_end(movie.close)
        run.measured = lambda: sum(s > 0 for s in shares)
        run.summary = lambda: f"{output / 'flow.csv'}: {run.done} frames" + (
            f", {np.mean(shares):.0%} of the windows valid" if shares else ": a single frame has no flow")
        last: tuple[Frame, View] | None = None
        guess = (0.0, 0.0)
        for frame in run.steps("flow", run.frames(), run.source.count):
            live = measurer.view(fit.show(frame.picture))
            if last is not None:
                field = _measure(measurer, last[1], live, board.window, step, reach, guess)
                guess = field.dominant()
                run.refused.update(field.refused)
                measurer.release(last[1])
                table.write_all(flow_rows(last[0], frame, field, fit))
                shown = draw_flow(fit.show(last[0].picture), field)
                movie.write(shown)
                if run.done % pictures == 1 % pictures:
                    write_picture(run.file(f"flow_{name_part(last[0].name)}.png"), shown)
                shares.append(float(field.valid.mean()))
                run.report = run.report_folder
            last = frame, live
            run.tell(f"{shares[-1]:.0%} valid" if shares else "")


def _measure(measurer: Measurer, before: View, after: View, window: int, step: int, reach: int,
             guess: tuple[float, float]) -> FlowField:
    """The field, searched for around the last field's motion; where that loses most windows, over a wider range."""
    field = measure_flow(measurer, before, after, (window, window), step, (reach, reach), guess, support=1)
    if field.valid.mean() < LOST:
        wide = min(3 * reach, min(measurer.size) // 2)
        other = measure_flow(measurer, before, after, (window, window), step, (wide, wide), support=1)
        field = other if other.valid.sum() > field.valid.sum() else field
    return field
