"""`signum hold`."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import replace
from itertools import chain, islice
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from signum.applications.hold.judge import judge_hold_rows
from signum.applications.hold.mavlink import MavlinkSink
from signum.applications.hold.page import hold_bars, hold_section
from signum.applications.hold.reading import Reading
from signum.applications.hold.record import HoldRecord
from signum.applications.hold.simulate import SURGE, Scenario, simulate_hold
from signum.applications.hold.watch import watch_station
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
)
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.frames.frame import Source
from signum.geometry.calibration import read_mono
from signum.measure.measurer import Measurer
from signum.report.page import write_page
from signum.sources.files import VideoSource
from signum.sources.open import open_source
from signum.world.vehicle import Current
from signum.world.water import PAPER

GUESS_M = 2.0
FRAME_RATE = 10.0
VIEW = 400 / 384
"""Focal length per picture width where none is given: about 51 degrees across, a common lens under water."""


class Beat:
    """Keeps step with real time: a MAVLink receiver judges messages by when they come."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    def wait(self, moment: float) -> None:
        """Sleep until `moment` seconds after the start."""
        time.sleep(max(0.0, self._start + moment - time.monotonic()))


@app.command()
@guarded
def hold(
    source: Annotated[str | None, typer.Option("--source", show_default="simulated world",
                                               help="Recorded or live frames to measure instead: video, folder of "
                                               "pictures, .npy array, camera number.")] = None,
    output: OutOption = Path("out/hold"),
    seconds: Annotated[float | None, typer.Option("--seconds", min=1.0, show_default="60; a source's whole length",
                                                  help="Length of the run.")] = None,
    range_m: Annotated[float | None, typer.Option(
        "--range", min=0.1, show_default="measured by stereo in simulation; 2.0 for a source",
        help="Range taken for true, metres: a guess scales the offsets.")] = None,
    focal: Annotated[float | None, typer.Option("--focal", min=1.0, show_default="of --calibration, or 1.04 widths",
                                                help="Focal length in pixels of the source's frames.")] = None,
    calibration: CalibrationOption = None,
    rate: Annotated[float | None, typer.Option("--rate", min=0.1, max=1000.0, show_default="the video's own, else 10",
                                               help="Frames per second of the source.")] = None,
    mavlink: Annotated[str | None, typer.Option("--mavlink", help="Send VISION_POSITION_DELTA at 10 Hz, in real time, "
                                                "to udpout:HOST:PORT.", show_default=False)] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the simulated world.")] = 0,
    altitude: Annotated[float, typer.Option("--altitude", min=0.5, max=8.0, help="Simulated height, metres.")] = 2.0,
    current: Annotated[float, typer.Option("--current", min=0.0, max=1.0,
                                           help="Simulated current, m/s; surge comes with it.")] = 0.2,
    snow: Annotated[int, typer.Option("--snow", min=0, max=5000, help="Simulated snow flakes in view.")] = 250,
    occluded: Annotated[float | None, typer.Option("--occluded", min=1.0, show_default="never",
                                                   help="Second at which the view is blocked for 3 s.")] = None,
    shoved: Annotated[float | None, typer.Option("--shoved", min=1.0, show_default="never",
                                                 help="Second at which the vehicle is pushed out of sight.")] = None,
    pan_tilt: Annotated[bool, typer.Option("--pan-tilt", help="Simulated camera on a pan/tilt that keeps looking at "
                                           "the station.")] = False,
    sigma: SigmaOption = 2.0,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
) -> None:
    """Station keeping against the first picture: `hold.csv` and `report.html`. A simulated vehicle in closed loop, or
    with `--source` the same measurements on frames of your own.

    Example: `signum hold --source dive.mp4 --range 1.5 --mavlink udpout:127.0.0.1:14550`
    """
    with ExitStack() as stack:
        sink = stack.enter_context(MavlinkSink(mavlink)) if mavlink else None
        b = stack.enter_context(board_of(board, window))
        output.mkdir(parents=True, exist_ok=True)
        if source is not None:
            _measure(b, source, output, seconds, range_m, focal, calibration, rate, sink, sigma, window)
        else:
            if window != 64 or focal or calibration or rate:
                raise SignumError("--window, --focal, --calibration and --rate belong to a --source")
            k = current / SURGE.steady[0]
            scenario = Scenario(
                seconds=seconds or 60.0, range_m=altitude, guess_m=range_m, head=pan_tilt, seed=seed,
                current=Current((current, 0.0), tuple(k * s for s in SURGE.surge), SURGE.period),  # type: ignore[arg-type]
                water=replace(PAPER, snow=snow), occluded=(occluded, occluded + 3) if occluded else None,
                shoved=(shoved, shoved + 3) if shoved else None)
            _fly(b, scenario, output, sink, sigma)


def _fly(board: BoardBase, scenario: Scenario, output: Path, sink: MavlinkSink | None, sigma: float) -> None:
    """The closed loop."""
    record, rows = HoldRecord(output, truth=True, often=max(10.0, scenario.seconds / 4)), []
    beat, total = Beat(), round(scenario.seconds * scenario.rate)
    out.print(f"seed {scenario.seed}")
    try:
        with progress("holding", total) as tell:
            for k, m in enumerate(simulate_hold(lambda size: Measurer(board, size, sigma), scenario)):
                record.add(str(k), m.time, m.reading, m.frame, m.features,
                           truth=(m.truth[0], m.truth[1], m.truth[3], m.range_m))
                rows.append(m.row)
                _send(sink, beat, m.time, m.reading)
                tell(_word(m.reading))
    finally:
        record.close()
        if rows:
            about = (f"A simulated vehicle {scenario.range_m:g} m above the floor, current "
                     f"{scenario.current.steady[0]:g} m/s with surge, {scenario.water.snow} snow flakes in view, light "
                     f"and contrast as in the paper's figure 8; seed {scenario.seed}.")
            figures = judge_hold_rows(np.array(rows), settle=min(10.0, scenario.seconds / 2), apart=scenario.apart)
            bars = hold_bars(figures)
            write_page(output / "report.html", "Station keeping",
                       [hold_section("Station keeping, simulated", about, record.series, record.shots, bars)])
            for bar in bars:
                out.print(str(bar), markup=False)
    notes.print(clocks_line(board, total))
    _done(output, record, sink)


def _measure(board: BoardBase, source: str, output: Path, seconds: float | None, range_m: float | None,
             focal: float | None, calibration: Path | None, rate: float | None, sink: MavlinkSink | None, sigma: float,
             window: int) -> None:
    """Open loop, on frames from elsewhere."""
    frames = open_source(source, calibration)
    rate = rate or _rate_of(source, frames)
    pictures = iter(frames)
    first = next(pictures)
    fit = fit_to(first, board, window, frames)
    if focal is None:
        focal = float(read_mono(calibration)[0][0, 0]) if calibration else VIEW * first.size[0]
        if calibration is None:
            notes.print(f"no --focal or --calibration: taking {focal:.0f} px; metres scale with it")
    if range_m is None:
        range_m = GUESS_M
        notes.print(f"no --range: taking {range_m:g} m; metres scale with it")
    total = frames.count
    if seconds is not None:
        total = min(round(seconds * rate), total or round(seconds * rate))
    record = HoldRecord(output, truth=False, often=max(2.0, (total or 600) / rate / 6))
    beat = Beat()
    pictures = islice(chain([first], pictures), total if seconds is not None else None)
    try:
        with progress("measuring", total) as tell:
            for seen in watch_station(Measurer(board, fit.board, sigma), pictures, fit, focal, range_m, rate, window):
                record.add(seen.name, seen.time, seen.reading, seen.picture, seen.features, window)
                _send(sink, beat, seen.time, seen.reading)
                tell(_word(seen.reading))
    finally:
        record.close()
        if record.rows:
            about = (f"{frames.label} against its first frame; {rate:g} frames a second, focal length {focal:.0f} px, "
                     f"range {range_m:g} m at the start.")
            write_page(output / "report.html", "Station keeping",
                       [hold_section("Station keeping, open loop", about, record.series, record.shots)])
    notes.print(clocks_line(board, len(record.rows)))
    _done(output, record, sink)


def _rate_of(source: str, frames: Source) -> float:
    if not isinstance(frames, VideoSource):
        return FRAME_RATE
    capture = cv2.VideoCapture(source)
    found = float(capture.get(cv2.CAP_PROP_FPS))
    capture.release()
    return found if 0.1 <= found <= 1000 else FRAME_RATE


def _send(sink: MavlinkSink | None, beat: Beat, moment: float, reading: Reading) -> None:
    if sink is not None:
        beat.wait(moment)
        sink.send(moment, reading)


def _word(r: Reading) -> str:
    return f"{100 * r.forward:+.1f}, {100 * r.right:+.1f} cm, confidence {r.confidence}" if r.valid else "confidence 0"


def _done(output: Path, record: HoldRecord, sink: MavlinkSink | None) -> None:
    sent = f", {sink.sent} MAVLink messages" if sink else ""
    out.print(f"{output / 'hold.csv'}: {len(record.rows)} frames, {record.valid} with a reading{sent}; "
              f"{output / 'report.html'}")
