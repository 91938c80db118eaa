# SPDX-License-Identifier: Apache-2.0
"""`signum hold`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from signum.applications.hold.judge import judge_hold_rows
from signum.applications.hold.page import hold_bars, hold_section
from signum.applications.hold.reading import Reading
from signum.applications.hold.record import HoldRecord
from signum.applications.hold.simulate import SURGE, Scenario, simulate_hold
from signum.applications.hold.watch import Sensors, watch_station
from signum.applications.mavlink.sink import MavlinkSink
from signum.commands.app import command
from signum.commands.autopilot import Autopilot
from signum.commands.focal import focal_px
from signum.commands.options import (
    AUTOPILOT,
    SIMULATION,
    SOURCE,
    BoardOptions,
    CalibrationOption,
    FocalOption,
    MavlinkOption,
    OutOption,
    SecondsOption,
    SeedOption,
)
from signum.commands.outputs import PAGE
from signum.commands.session import Session
from signum.common.console import notes, out
from signum.common.errors import SignumError
from signum.frames.clock import FRAME_RATE
from signum.report.about import head
from signum.report.page import write_page
from signum.world.vehicle import Current
from signum.world.water import PAPER

BOARD_DEFAULTS = BoardOptions()
GUESS_M = 2.0
"""Range of a source where none is given, metres."""
TITLE = "Signum: Station keeping"
"""Of the report."""
SHOT_S = 5.0
"""Seconds between the report's pictures of a source of unknown length; more when it is long."""
BLIND_S = 3.0
"""Seconds for which the simulated view is blocked, or the simulated vehicle pushed."""


@dataclass(frozen=True)
class HoldSource:
    """Frames from elsewhere that are measured instead of the simulated world."""

    source: Annotated[str | None, typer.Option(
        "--source", rich_help_panel=SOURCE, show_default="simulated world", help="Recorded or live frames to measure "
        "instead: video, folder of pictures, ROS bag, .npy array, camera number, stream (udp://:5600, rtsp://, "
        "http://) or world:NAME=VALUE.")] = None
    calibration: CalibrationOption = None
    focal: FocalOption = None
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.1, max=1000.0, show_default="the video's own, else 10",
        help="Frames per second of the source.")] = None


@dataclass(frozen=True)
class HoldWorld:
    """The simulated world."""

    seed: SeedOption = 0
    altitude: Annotated[float, typer.Option("--altitude", rich_help_panel=SIMULATION, min=0.5, max=8.0,
                                            help="Height over the floor, metres.")] = 2.0
    current: Annotated[float, typer.Option("--current", rich_help_panel=SIMULATION, min=0.0, max=1.0,
                                           help="Current, m/s; its surge grows with it.")] = 0.2
    snow: Annotated[int, typer.Option("--snow", rich_help_panel=SIMULATION, min=0, max=5000,
                                      help="Snow flakes in view.")] = 250
    occluded: Annotated[float | None, typer.Option(
        "--occluded", rich_help_panel=SIMULATION, min=1.0, show_default="never",
        help="Second at which the view is blocked for 3 s.")] = None
    shoved: Annotated[float | None, typer.Option(
        "--shoved", rich_help_panel=SIMULATION, min=1.0, show_default="never",
        help="Second at which the vehicle is pushed out of sight of its station.")] = None
    pan_tilt: Annotated[bool, typer.Option(
        "--pan-tilt", rich_help_panel=SIMULATION, help="The camera is on a pan/tilt that keeps it pointed at the "
        "station.")] = False

    def scenario(self, seconds: float, range_m: float | None) -> Scenario:
        """What is simulated; `range_m` is taken for the range, or measured by stereo if None."""
        k = self.current / SURGE.steady[0]
        current = Current((self.current, 0.0), tuple(k * s for s in SURGE.surge), SURGE.period)  # type: ignore[arg-type]
        occluded, shoved = ((at, at + BLIND_S) if at else None for at in (self.occluded, self.shoved))
        return Scenario(seconds=seconds, range_m=self.altitude, guess_m=range_m, head=self.pan_tilt, seed=self.seed,
                        current=current, water=replace(PAPER, snow=self.snow), occluded=occluded, shoved=shoved)


class Message(StrEnum):
    """The messages of `MavlinkSink`, for the choice on the command line."""

    delta = "delta"
    estimate = "estimate"
    odometry = "odometry"


NO_SOURCE, WORLD_DEFAULTS = HoldSource(), HoldWorld()


@command()
def hold(
    recorded: HoldSource = NO_SOURCE,
    output: OutOption = Path("out/hold"),
    seconds: SecondsOption = None,
    range_m: Annotated[float | None, typer.Option(
        "--range", min=0.1, show_default="measured by stereo in simulation; 2.0 for a source",
        help="Range at the start that the measurements assume, metres: the offsets scale with it.")] = None,
    mavlink: MavlinkOption = None,
    message: Annotated[Message, typer.Option(
        "--message", rich_help_panel=AUTOPILOT, help="What is sent: VISION_POSITION_DELTA at up to 10 Hz, or at up to "
        "30 Hz VISION_POSITION_ESTIMATE or ODOMETRY.")] = Message.delta,
    sense: Annotated[bool | None, typer.Option(
        "--sense/--no-sense", rich_help_panel=AUTOPILOT, show_default="with a live source", help="Take roll, pitch, "
        "yaw rate and range of the vehicle from the link: to level, to predict, and instead of --range.")] = None,
    follow_ground: Annotated[bool, typer.Option(
        "--follow-ground", rich_help_panel=SOURCE, help="On a way: take another frame for the reference before the "
        "present one leaves the view. Readings stay relative to the first frame; errors add up.")] = False,
    board: BoardOptions = BOARD_DEFAULTS,
    simulation: HoldWorld = WORLD_DEFAULTS,
) -> None:
    """Station keeping against the first picture: `hold.csv` and `report.html`. A simulated vehicle in closed loop, or
    with `--source` the same measurements on frames of your own.

    Example: `signum hold --source dive.mp4 --range 1.5 --mavlink udpout:127.0.0.1:14550`
    """
    if recorded.source is None and (board.window != BOARD_DEFAULTS.window or recorded.focal or recorded.calibration
                                    or recorded.rate):
        raise SignumError("--window, --focal, --calibration and --rate belong to a --source")
    if follow_ground and recorded.source is None:
        raise SignumError("--follow-ground belongs to a --source")
    if sense and (recorded.source is None or mavlink is None):
        raise SignumError("--sense belongs to a --source and to --mavlink")
    with Session("hold", board, output, recorded.source, recorded.calibration, recorded.rate) as run:
        sink = run.open(MavlinkSink(mavlink, message=message)) if mavlink is not None else None
        autopilot = Autopilot(sink, paced=not run.live, sensing=run.live if sense is None else sense)
        if recorded.source is not None:
            _measure(run, recorded, seconds, range_m, autopilot, follow_ground)
        else:
            _fly(run, simulation.scenario(seconds or 60.0, range_m), autopilot)


def _fly(run: Session, scenario: Scenario, autopilot: Autopilot) -> None:
    """The closed loop."""
    record = _record(run, True, max(10.0, scenario.seconds / 4), autopilot)
    rows: list[tuple[float, ...]] = []

    def report() -> None:
        about = (f"A simulated vehicle {scenario.range_m:g} m above the floor, current "
                 f"{scenario.current.steady[0]:g} m/s with surge, {scenario.water.snow} snow flakes in view, light "
                 f"and contrast as in the paper's figure 8; seed {scenario.seed}.")
        figures = judge_hold_rows(np.array(rows), settle=min(10.0, scenario.seconds / 2), apart=scenario.apart)
        bars = hold_bars(figures)
        page = run.folder / PAGE
        write_page(page, TITLE, [hold_section("Station keeping, simulated", about, record.series, record.shots, bars,
                                             (record.count, record.valid))],
                   head(page, run.about()))
        for bar in bars:
            out.print(str(bar), markup=False)

    out.print(f"seed {scenario.seed}")
    moments = simulate_hold(run.measurer, scenario)
    autopilot.begin(None)
    for k, m in enumerate(run.steps("holding", moments, round(scenario.seconds * scenario.rate))):
        record.add(str(k), m.time, m.reading, m.frame, m.features,
                   truth=(m.truth[0], m.truth[1], m.truth[3], m.range_m))
        rows.append(m.row)
        run.report = report
        autopilot.send(m.time, m.reading)
        run.refused["no reading"] += not m.reading.valid
        run.tell(_word(m.reading))


def _measure(run: Session, recorded: HoldSource, seconds: float | None, range_m: float | None,
             autopilot: Autopilot, follow_ground: bool) -> None:
    """Open loop, on frames from elsewhere."""
    sensors = Sensors(autopilot.at, ranged=range_m is None and autopilot.sensing)
    if sensors.ranged:
        autopilot.await_range()
    frames, fit = run.source, run.fit
    autopilot.begin(run.first.time_s)
    rate = recorded.rate or frames.rate or FRAME_RATE
    focal = focal_px(recorded.focal, recorded.calibration, fit.source, "metres scale")
    if range_m is None:
        range_m = autopilot.range_m or GUESS_M
        notes.print(f"no --range: {range_m:.2f} m by the vehicle's range finder" if autopilot.range_m else
                    f"no --range: taking {range_m:g} m; metres scale with it")
    total = frames.count
    if seconds is not None:
        total = min(round(seconds * rate), total or round(seconds * rate))
    record = _record(run, False, max(2.0, total / rate / 6) if total else SHOT_S, autopilot)
    pace = f"{rate:g} frames a second, " if recorded.rate or frames.rate else ""
    about = (f"{frames.label} against its first frame; {pace}focal length {focal:.0f} px, "
             f"range {range_m:g} m at the start.")

    def report() -> None:
        page = run.folder / PAGE
        write_page(page, TITLE, [hold_section("Station keeping, open loop", about, record.series, record.shots,
                                             counts=(record.count, record.valid))],
                   head(page, run.about()))

    window = run.chosen.window
    seen_ones = watch_station(run.measurer(fit.board), run.frames(), fit, focal, range_m, rate, window, seconds,
                              sensors, follow_ground)
    references = 0
    for seen in run.steps("measuring", seen_ones, total):
        record.add(seen.name, seen.time, seen.reading, seen.picture, seen.features, window)
        run.report = report
        autopilot.send(seen.time, seen.reading)
        if seen.reading.valid and seen.reading.reference > references:
            references = seen.reading.reference
            notes.print(f"frame {seen.name}: range {seen.reading.range_m:.2f} m by the vehicle's range finder; metres "
                        "before this frame are by another")
        if seen.anchored:
            references += 1
            notes.print(f"frame {seen.name}: the reference from here on, {seen.reading.forward:+.2f} m ahead, "
                        f"{seen.reading.right:+.2f} m to the right; standard error so far "
                        f"{100 * seen.reading.offset_error:.1f} cm, {math.degrees(seen.reading.heading_error):.2f} "
                        "degrees")
        run.refused["no reading"] += not seen.reading.valid
        run.tell(_word(seen.reading))


def _record(run: Session, truth: bool, often: float, autopilot: Autopilot) -> HoldRecord:
    """The record of a run, closed with it, and the line on its outcome."""
    run.page()
    record = HoldRecord(run.file("hold.csv").parent, truth, often)
    run.at_end(record.close)
    run.measured = lambda: max(record.valid - 1, 0)  # beyond the station itself
    run.summary = lambda: (f"{run.folder / 'hold.csv'}: {record.count} frames, {record.valid} with a reading"
                           f"{autopilot.said}; {run.folder / 'report.html'}")
    return record


def _word(r: Reading) -> str:
    """A reading for the progress line."""
    return f"{100 * r.forward:+.1f}, {100 * r.right:+.1f} cm, confidence {r.confidence}" if r.valid else "confidence 0"
