"""`signum flow`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

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
from signum.frames.frame import Frame
from signum.measure.flow import FlowField, draw_flow, measure_flow
from signum.measure.measurer import Measurer, View
from signum.report.movie import Movie
from signum.report.rows import flow_rows
from signum.sources.open import open_source
from signum.tables.schemas import FLOW
from signum.tables.table import Table

LOST = 0.25
"""Share of valid windows below which the search is widened."""


@app.command()
@guarded
def flow(
    source: Annotated[str, typer.Argument(help="Video, folder of pictures, ROS bag, .npy array or camera number.",
                                          show_default=False)],
    output: OutOption = Path("out/flow"),
    sigma: SigmaOption = 2.0,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
    calibration: CalibrationOption = None,
    step: Annotated[int, typer.Option("--step", min=4, help="Grid of the field, pixels of the board's picture.")] = 32,
    reach: Annotated[int, typer.Option("--reach", min=2, max=64, help="Largest change of the flow from frame to frame, "
                                       "pixels of the board's picture.")] = 16,
    pictures: Annotated[int, typer.Option("--pictures", min=1, help="Every how many frames the field is also written "
                                          "as a picture.")] = 10,
) -> None:
    """Optical flow from frame to frame: `flow.csv`, `flow.mp4`, every tenth field as `flow_NAME.png`, `report.html`.

    Example: `signum flow dive.mp4 --step 24 --out out/flow`
    """
    frames = open_source(source, calibration)
    done, shares = 0, []
    with board_of(board, window) as b, progress("flow", frames.count) as tell:
        output.mkdir(parents=True, exist_ok=True)
        for old in output.glob("flow_*.png"):
            old.unlink()
        table = Table(output / "flow.csv", FLOW)
        movie = Movie(output / "flow.mp4")
        last: tuple[Frame, View] | None = None
        guess = (0.0, 0.0)
        try:
            for frame in frames:
                if last is None:
                    fit = fit_to(frame, b, window, frames)
                    measurer = Measurer(b, fit.board, sigma)
                live = measurer.view(fit.show(frame.picture))
                if last is not None:
                    field = _measure(measurer, last[1], live, window, step, reach, guess)
                    guess = field.dominant()
                    measurer.release(last[1])
                    for line in flow_rows(last[0].name, frame.name, field, fit):
                        table.write(line)
                    shown = draw_flow(fit.show(last[0].picture), field)
                    movie.write(shown)
                    if done % pictures == 1 % pictures:
                        cv2.imwrite(str(output / f"flow_{last[0].name}.png"), shown)
                    shares.append(float(field.valid.mean()))
                last, done = (frame, live), done + 1
                tell(f"{shares[-1]:.0%} valid" if shares else "")
        finally:
            table.close()
            movie.close()
            if shares:
                write_report(output)
        notes.print(clocks_line(b, done))
    share = f", {np.mean(shares):.0%} of the windows valid" if shares else ": a single frame has no flow"
    out.print(f"{output / 'flow.csv'}: {done} frames{share}")


def _measure(measurer: Measurer, before: View, after: View, window: int, step: int, reach: int,
             guess: tuple[float, float]) -> FlowField:
    """The field about the last one's motion; where most windows lose it there, from everywhere."""
    field = measure_flow(measurer, before, after, (window, window), step, (reach, reach), guess, support=1)
    if field.valid.mean() < LOST:
        wide = min(3 * reach, min(measurer.size) // 2)
        other = measure_flow(measurer, before, after, (window, window), step, (wide, wide), support=1)
        field = other if other.valid.sum() > field.valid.sum() else field
    return field
