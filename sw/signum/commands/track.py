"""`signum track`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import cv2
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
from signum.measure.measurer import Measurer
from signum.measure.track import PRECISE_PX, Tracker, TrackPoint, TrackSettings
from signum.report.draw import draw_tracks
from signum.report.rows import drift_row, track_row
from signum.sources.open import open_source
from signum.tables.schemas import DRIFT, TRACK
from signum.tables.table import Table

KEPT = 5
"""Frames for which a lost feature still has rows, marked as not valid."""


@app.command()
@guarded
def track(
    source: Annotated[str, typer.Argument(help="Video, folder of pictures, ROS bag, .npy array or camera number.",
                                          show_default=False)],
    output: OutOption = Path("out/track"),
    sigma: SigmaOption = 2.5,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
    calibration: CalibrationOption = None,
    features: Annotated[int, typer.Option("--features", min=1, max=200, help="Features to keep in view.")] = 30,
) -> None:
    """Track features against the image they were chosen in: `track.csv`, `drift.csv` (what is known of the error, frame
    by frame), `track.png` (the last frame with them), `report.html`.

    Example: `signum track dive.mp4 --window 64 --out out/track`
    """
    frames = open_source(source, calibration)
    missing: dict[int, int] = {}
    points: list[TrackPoint] = []
    measured = valid = done = 0
    with board_of(board, window) as b, progress("tracking", frames.count) as tell:
        output.mkdir(parents=True, exist_ok=True)
        table, drift = Table(output / "track.csv", TRACK), Table(output / "drift.csv", DRIFT)
        tracker: Tracker | None = None
        frame: Frame | None = None
        try:
            for frame in frames:
                if tracker is None:
                    fit = fit_to(frame, b, window, frames)
                    settings = TrackSettings(window=window, features=features, precise_px=PRECISE_PX / max(fit.factor))
                    tracker = Tracker(Measurer(b, fit.board, sigma), settings)
                points = _shown(tracker.step(fit.show(frame.picture)), missing)
                for point in points:
                    table.write(track_row(frame.name, point, fit))
                drift.write(drift_row(frame.name, points, fit))
                measured, valid, done = measured + len(points), valid + sum(p.valid for p in points), done + 1
                tell(f"{sum(p.valid for p in points)} of {len(points)} valid")
        finally:
            table.close()
            drift.close()
            if frame is not None and points:
                cv2.imwrite(str(output / "track.png"), draw_tracks(fit.show(frame.picture), points, window))
            if done:
                write_report(output)
        notes.print(clocks_line(b, done))
    out.print(f"{output / 'track.csv'}: {done} frames, {measured} measurements, {valid} valid")


def _shown(points: list[TrackPoint], missing: dict[int, int]) -> list[TrackPoint]:
    """The points without those lost for more than `KEPT` frames, which the tracker still looks for; `missing` counts
    the frames since each was valid."""
    for p in points:
        missing[p.feature] = 0 if p.valid else missing.get(p.feature, 0) + 1
    return [p for p in points if missing[p.feature] <= KEPT]
