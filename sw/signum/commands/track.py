# SPDX-License-Identifier: Apache-2.0
"""`signum track`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from signum.commands.app import command
from signum.commands.options import BoardOptions, CalibrationOption, OutOption, SourceArgument
from signum.commands.session import Session
from signum.common.files import write_picture
from signum.measure.track import PRECISE_PX, Tracker, TrackPoint, TrackSettings
from signum.report.draw import draw_tracks
from signum.report.rows import drift_row, track_row
from signum.tables.schemas import DRIFT, TRACK

LOST_FRAMES = 5
"""Frames for which a lost feature still has rows, marked as not valid."""
BOARD_DEFAULTS = BoardOptions(sigma=2.5)


@command()
def track(
    source: SourceArgument,
    calibration: CalibrationOption = None,
    output: OutOption = Path("out/track"),
    board: BoardOptions = BOARD_DEFAULTS,
    features: Annotated[int, typer.Option("--features", min=1, max=200, help="Features to keep in view.")] = 30,
) -> None:
    """Track features against the image they were chosen in: `track.csv`, `drift.csv` (the estimated error, frame by
    frame), `track.png` (the last frame with the features), `report.html`.

    Example: `signum track dive.mp4 --window 64 --out out/track`
    """
    missing: dict[int, int] = {}
    points: list[TrackPoint] = []
    measured = valid = found = 0
    with Session("track", board, output, source, calibration) as run:
        fit = run.fit
        settings = TrackSettings(window=board.window, features=features, precise_px=PRECISE_PX / max(fit.factor))
        tracker = Tracker(run.measurer(fit.board), settings)
        run.page()
        table, drift = run.table("track.csv", TRACK), run.table("drift.csv", DRIFT)
        picture = run.file("track.png")

        def draw() -> None:
            if points:
                write_picture(picture, draw_tracks(fit.show(frame.picture), points, board.window))

        run.at_end(draw)
        run.measured = lambda: found
        run.summary = lambda: (f"{output / 'track.csv'}: {run.done} frames, {measured} measurements, {valid} valid")
        for frame in run.steps("tracking", run.frames(), run.source.count):
            before = set(missing)
            points = _shown(tracker.step(fit.show(frame.picture)), missing)
            for point in points:
                table.write(track_row(frame, point, fit))
            drift.write(drift_row(frame, points, fit))
            found += any(p.valid and p.feature in before for p in points)  # a new one is valid by itself
            run.refused.update(p.reason for p in points if not p.valid)
            measured, valid = measured + len(points), valid + sum(p.valid for p in points)
            run.report = run.report_folder
            run.tell(f"{sum(p.valid for p in points)} of {len(points)} valid")


def _shown(points: list[TrackPoint], missing: dict[int, int]) -> list[TrackPoint]:
    """The points without those lost for more than `LOST_FRAMES` frames, which the tracker still searches for;
    `missing` counts the frames since each was valid."""
    for p in points:
        missing[p.feature] = 0 if p.valid else missing.get(p.feature, 0) + 1
    return [p for p in points if missing[p.feature] <= LOST_FRAMES]
