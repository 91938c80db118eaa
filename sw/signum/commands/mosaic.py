"""`signum mosaic`."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from signum.applications.mosaic.accuracy import ACCURACY, Track, accuracy_rows, pose_errors, read_track
from signum.applications.mosaic.georeference import Georeference, ground_by_log, ground_by_range
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.settings import CURVED, SurveySettings
from signum.applications.mosaic.shelf import Shelf, SurveyRun
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.ways import WAYS
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
from signum.frames.frame import Frame, Source
from signum.geometry.calibration import read_mono
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.sources.open import open_source
from signum.tables.table import Table

LIVE_EVERY = 2.0
"""Seconds between two looks at the growing mosaic."""


class Columns(StrEnum):
    """How a survey was flown."""

    auto = "auto"
    single = "single"
    turned = "turned"


@app.command()
@guarded
def mosaic(
    source: Annotated[str, typer.Argument(help="Folder of overlapping pictures, video, ROS bag, .npy array or camera "
                                          "number.", show_default=False)],
    output: OutOption = Path("out/mosaic"),
    sigma: SigmaOption = 2.5,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
    calibration: CalibrationOption = None,
    columns: Annotated[Columns, typer.Option(
        "--columns", help="auto: any track, all neighbours linked and placed by least squares; single: each frame "
        "against the one before only; turned: the camera turned in place, loops bend and are made to close.")
                       ] = Columns.auto,
    range_m: Annotated[float | None, typer.Option(
        "--range", min=0.01, help="Metres from camera to seabed at the first frame: the mosaic gets a scale; needs "
        "--focal or --calibration.")] = None,
    focal: Annotated[float | None, typer.Option("--focal", min=1.0, help="Focal length, pixels of the frames.")] = None,
    navigation: Annotated[Path | None, typer.Option(
        "--navigation", help="CSV with frame, east_m, north_m: the mosaic is laid north up on the ground.")] = None,
    epsg: Annotated[int, typer.Option("--epsg", min=0, max=65535, help="EPSG code of the log's projected coordinates, "
                                      "e.g. 32755.")] = 0,
    truth: Annotated[Path | None, typer.Option(
        "--truth", help="CSV with frame and east_m, north_m (or x_px, y_px), and heading_deg if known: errors of the "
        "poses go to accuracy.csv.")] = None,
    resume: Annotated[bool | None, typer.Option(
        "--resume/--anew", help="Go on with the survey in --out, or start it anew. By default an interrupted one of "
        "the same source is gone on with.", show_default=False)] = None,
    live: Annotated[bool, typer.Option("--live/--no-live", help="Write mosaic.png every few seconds as it grows.")
                    ] = True,
) -> None:
    """Mosaic of a survey, whatever its track: `mosaic.png`, `poses.csv`, `edges.csv`, `report.html`, and with a scale
    `mosaic.tif`. It grows while frames come; stopped, it goes on where it was when called again.

    Example: `signum mosaic survey/ --out out/mosaic`
    """
    frames = open_source(source, calibration)
    known = None if truth is None else read_track(truth, frames.label)
    ground = _ground(range_m, focal, calibration, None if navigation is None else read_track(navigation, frames.label),
                     epsg)
    survey: Survey | None = None
    settings = CURVED if columns is Columns.turned else SurveySettings(loops=columns is Columns.auto)
    every = LIVE_EVERY if live else float("inf")
    done = 0
    with board_of(board, window) as b:
        def measurer(size: tuple[int, int], wide: float) -> Measurer:
            return Measurer(b, size, wide)

        finished = False
        try:
            with progress("mosaic", frames.count) as tell:
                for frame in frames:
                    if survey is None:
                        fit = fit_to(frame, b, window, frames)
                        survey = Survey(Registrar.on(measurer, fit, window, sigma), output, not frames.snapshots,
                                        settings, frames.label, _resumes(resume, output, frames, frame, window, sigma,
                                                                         settings), every)
                        survey.results.ground = ground
                    tell(survey.add(frame))
                    done += 1
            assert survey is not None
            survey.settle()
            with progress("neighbours", None) as tell:
                for said in survey.finish():
                    tell(said)
            finished = True
        finally:
            if survey is not None:
                if done > 1:
                    notes.print("blending the mosaic")
                survey.close(finished)
                if known is not None and finished:
                    _judge(survey, known)
                write_report(output)
        notes.print(clocks_line(b, done))
    _tell(survey, done, known is not None)
    if survey.results.trouble:
        raise SignumError(survey.results.trouble)


def _resumes(asked: bool | None, output: Path, frames: Source, frame: Frame, window: int, sigma: float,
             settings: SurveySettings) -> bool:
    """Whether to go on with what is in the folder."""
    if asked is not None:
        return asked
    before = Shelf(output).described()
    run = SurveyRun(frames.label, frame.size, not frames.snapshots, window, sigma, settings.columns)
    if before is None or before[1] or before[0] != run:
        return False
    notes.print(f"{output}: going on with the survey interrupted there; --anew starts it again")
    return True


def _ground(range_m: float | None, focal: float | None, calibration: Path | None, log: Track | None,
            epsg: int) -> Callable[[list[Pose], tuple[float, float]], Georeference | None] | None:
    """How a piece finds its place on the ground.

    Raises:
        SignumError: for a range without a focal length.
    """
    if log is not None:
        return lambda poses, _: ground_by_log(poses, log, epsg)
    if range_m is None:
        return None
    if focal is None:
        if calibration is None:
            raise SignumError("--range needs the camera's focal length: add --focal (pixels) or --calibration")
        focal = float(read_mono(calibration)[0][0, 0])
    return partial(_scaled, range_m, focal)


def _scaled(range_m: float, focal: float, poses: list[Pose], centre: tuple[float, float]) -> Georeference:
    return ground_by_range(range_m, focal, centre)


def _judge(survey: Survey, truth: Track) -> None:
    """Write `accuracy.csv`: of the largest piece, by the ways its frames can be placed."""
    piece = survey.ranked()[0]
    table = Table(survey.out / "accuracy.csv", ACCURACY)
    try:
        for way, place in WAYS.items():
            poses = place(survey.ledger, piece)
            if poses:
                table_rows = accuracy_rows(way, pose_errors(poses, truth), truth.unit)
                for line in table_rows:
                    table.write(line)
                if way == "all links":
                    for line in table_rows:
                        out.print(f"{line[1]}: RMS {line[3]} {line[2]}, median {line[5]}, most {line[8]}")
    finally:
        table.close()


def _tell(survey: Survey, done: int, judged: bool) -> None:
    """The outcome on the terminal."""
    chained = [edge for edge in survey.edges if edge.kind in ("sequence", "live")]
    others = [edge for edge in survey.edges if edge.kind not in ("sequence", "live")]
    for edge in chained:
        if not edge.accepted:
            out.print(f"refused: {edge.frame_a} to {edge.frame_b} ({edge.reason})")
    if len(survey.pieces) > 1:
        out.print(f"the chain broke: {len(survey.pieces)} pieces, of which mosaic.png and poses.csv are the largest")
    stored = {edge.frame_b for edge in chained if edge.accepted and edge.kind == "sequence"}
    chained = [edge for edge in chained if edge.kind == "sequence" or edge.frame_b not in stored]
    out.print(f"{survey.out / 'mosaic.png'}: {done} frames, {sum(k.accepted for k in chained)} of {len(chained)} edges "
              f"accepted" + (f", {sum(k.accepted for k in others)} of {len(others)} across" if others else ""))
    if judged:
        out.print(f"{survey.out / 'accuracy.csv'}: errors against the truth")
