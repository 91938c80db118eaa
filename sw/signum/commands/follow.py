# SPDX-License-Identifier: Apache-2.0
"""`signum follow`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from math import degrees
from pathlib import Path
from typing import Annotated

import typer

from golden.params import DENSE, FULL
from signum.applications.follow.eyes import MOTION_WINDOW, RANGE_WINDOW, DenseEye, Eye, MotionEye, RangeEye
from signum.applications.follow.follower import State, Target
from signum.applications.follow.judge import ChaseRow, judge_chase
from signum.applications.follow.page import draw_chase, draw_states, follow_bars, follow_section
from signum.applications.follow.pilot import Where
from signum.applications.follow.record import FollowRecord
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.applications.follow.watch import watch_fish
from signum.commands.app import command
from signum.commands.options import (
    BOARD,
    OUTPUT,
    SIMULATION,
    SOURCE,
    BoardName,
    BoardOption,
    BoardOptions,
    OutOption,
    PairOption,
    SecondsOption,
    SeedOption,
    SigmaOption,
)
from signum.commands.outputs import PAGE
from signum.commands.session import Session
from signum.common.arrays import Image
from signum.common.console import out
from signum.common.errors import SignumError
from signum.frames.clock import FRAME_RATE
from signum.frames.frame import Frame, Source
from signum.geometry.calibration import Rectifier, StereoGeometry
from signum.report.about import head
from signum.report.page import Section, write_page
from signum.report.pictures import film as film_of
from signum.sources.open import open_rig, open_source
from signum.world.camera import Pinhole

LEAST = 64
"""Frames smaller than this on the board, pixels, are refused."""


@dataclass(frozen=True)
class FollowSource:
    """Frames from elsewhere that are used instead of the simulated world."""

    source: Annotated[str | None, typer.Option(
        "--source", rich_help_panel=SOURCE, show_default="simulated world", help="Recorded or live frames instead: "
        "video, folder of pictures, ROS bag, .npy array, camera number, stream or world:NAME=VALUE; segmented by "
        "motion, or with --right by range.")] = None
    right: Annotated[str | None, typer.Option(
        "--right", rich_help_panel=SOURCE, show_default=False, help="The right camera's frames, for range; needs "
        "--calibration.")] = None
    calibration: PairOption = None
    nearer: Annotated[float, typer.Option("--nearer", rich_help_panel=SOURCE, min=0.2,
                                          help="Objects nearer than this are taken for fish, metres.")] = 4.0
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.1, max=1000.0, show_default="the video's own, else 10",
        help="Frames per second of a source whose frames have no times.")] = None


@dataclass(frozen=True)
class FollowWorld:
    """The simulated world."""

    where: Annotated[Where, typer.Option(
        "--where", rich_help_panel=SIMULATION, help="midwater: fish segmented by range; terrain: by motion.",
    )] = Where.MIDWATER
    seed: SeedOption = 0
    darts: Annotated[float | None, typer.Option("--darts", rich_help_panel=SIMULATION, min=1.0, show_default="never",
                                                help="Second at which the fish darts out of view.")] = None


@dataclass(frozen=True)
class FollowBoard:
    """The board, its filter and the windows."""

    board: BoardOption = BoardName.golden
    sigma: SigmaOption = 2.0
    window: Annotated[int | None, typer.Option(
        "--window", rich_help_panel=BOARD, min=8, max=128, help="Side of the windows, pixels of the board's picture.",
        show_default=f"{RANGE_WINDOW} by range, {MOTION_WINDOW} by motion")] = None
    dense: Annotated[bool, typer.Option(
        "--dense", rich_help_panel=BOARD, help="By motion: find what moves by itself at every pixel, on a board "
        "with the dense engine.")] = False

    @property
    def chosen(self) -> BoardOptions:
        """The board, its filter, and the window that frames must hold."""
        return BoardOptions(self.board, self.sigma, (self.window or MOTION_WINDOW) if self.dense
                            else max(LEAST, self.window or 0))


NO_SOURCE, WORLD_DEFAULTS, BOARD_DEFAULTS = FollowSource(), FollowWorld(), FollowBoard()


@command()
def follow(
    recorded: FollowSource = NO_SOURCE,
    output: OutOption = Path("out/follow"),
    film: Annotated[bool, typer.Option("--film", rich_help_panel=OUTPUT, help="Write follow.mp4 too.")] = False,
    seconds: SecondsOption = None,
    chosen: FollowBoard = BOARD_DEFAULTS,
    simulation: FollowWorld = WORLD_DEFAULTS,
) -> None:
    """Follow a fish: `follow.csv` with its blob for every frame and `report.html`. A simulated vehicle with a pan/tilt
    in closed loop, or with `--source` open loop on frames of your own.

    Example: `signum follow --source dive.mp4 --out out/follow`
    """
    if recorded.source is None and (recorded.right or recorded.calibration):
        raise SignumError("--right and --calibration belong to a --source")
    if (recorded.right is None) != (recorded.calibration is None):
        raise SignumError("range needs both --right and --calibration; leave both out to segment by motion")
    if chosen.dense and (recorded.right if recorded.source else simulation.where is Where.MIDWATER):
        raise SignumError("--dense: finds what moves by itself, not what is near: choose "
                          + ("a --source without --right" if recorded.source else "--where terrain, or a --source"))
    with Session("follow", chosen.chosen, output, recorded.source, rate=recorded.rate,
                 config=DENSE if chosen.dense else FULL) as run:
        if recorded.source is None:
            chase = Chase(simulation.where, seconds or 60.0, seed=simulation.seed, window=chosen.window,
                          darts=() if simulation.darts is None else (simulation.darts,), dense=chosen.dense)
            _chase(run, chase, film)
        else:
            _watch(run, recorded, seconds, film, chosen)


def _chase(run: Session, chase: Chase, film: bool) -> None:
    """The closed loop."""
    camera, rows = Pinhole(), list[ChaseRow]()
    record = _record(run, FollowRecord(_claimed(run, film), True, chase.rate, film, max(2.0, chase.seconds / 6)))

    def report() -> None:
        figures = judge_chase(rows, chase.rate, min(5.0, chase.seconds / 2))
        bars = follow_bars(chase.where, figures)
        about = (f"A simulated fish in turbid water, {chase.where}; a pan/tilt follows it, the vehicle follows the "
                 f"pan/tilt; seed {chase.seed}.")
        facts = [("in view", f"{figures.in_view:.1%}"), ("times found again", str(figures.finds)),
                 ("longest time lost, s", f"{figures.longest_lost_s:.1f}"),
                 ("frames with the target off the fish", f"{figures.wrong:.1%}")]
        _page(run, follow_section("Object following, simulated", about, record, draw_chase(rows, camera.size),
                                  "True position of the fish; green: the centre quarter.", facts, bars))
        for bar in bars:
            out.print(str(bar), markup=False)

    out.print(f"seed {chase.seed}")
    glimpses = simulate_chase(run.measurer, chase, camera)
    for k, g in enumerate(run.steps("following", glimpses, round(chase.seconds * chase.rate))):
        record.add(str(k), g.time, g.target, g.frame, truth=(*g.truth, g.range_m, *(degrees(a) for a in g.head)))
        rows.append(g.row(camera))
        run.report = report
        run.refused["no target"] += g.target.lost
        run.tell(str(g.target.state))


def _watch(run: Session, recorded: FollowSource, seconds: float | None, film: bool, chosen: FollowBoard) -> None:
    """Open loop, on frames from elsewhere."""
    other = None if recorded.right is None else open_source(recorded.right)
    fit, measurer, rate = run.fit, run.measurer(run.fit.board), recorded.rate or run.source.rate or FRAME_RATE
    rectifier = None
    if recorded.calibration is not None:
        rectifier = open_rig(recorded.calibration).rectifier(run.first.size)
    eye: Eye = (DenseEye if chosen.dense else MotionEye)(measurer, window=chosen.window or MOTION_WINDOW)
    if rectifier is not None:
        g, k = rectifier.geometry, fit.factor[0]
        scaled = StereoGeometry(g.focal / k, g.baseline, (g.centre[0] / k, g.centre[1] / k), g.shift / k)
        eye = RangeEye(measurer, scaled, recorded.nearer, window=chosen.window or RANGE_WINDOW)
    count = run.source.count
    total = count if seconds is None else min(round(seconds * rate), count or round(seconds * rate))
    record = _record(run, FollowRecord(_claimed(run, film), False, rate, film, max(2.0, (total or 600) / rate / 6)))
    how = f"by range, nearer than {recorded.nearer:g} m" if rectifier else "by motion against the scene"

    def report() -> None:
        _page(run, follow_section("Object following, open loop", f"{run.source.label}, segmented {how}.", record,
                                  draw_states(record.states), "State of the target."))

    now: list[tuple[str, float, Image]] = []
    first = run.first.time_s

    def pictures() -> Iterator[tuple[Image, ...]]:
        for k, (frame, pair) in enumerate(_pairs(run, other, rectifier)):
            time = k / rate if frame.time_s is None or first is None else frame.time_s - first
            if seconds is not None and time >= seconds - 1e-6:
                return
            now[:] = [(frame.name, time, pair[0])]
            yield pair

    for target in run.steps("following", watch_fish(eye, pictures()), total):
        name, time, shown = now[0]
        record.add(name, time, target, shown, fit.factor)
        run.report = report
        run.refused["no target"] += target.lost
        run.tell(_word(target))


def _pairs(run: Session, other: Source | None, rectifier: Rectifier | None
           ) -> Iterator[tuple[Frame, tuple[Image, ...]]]:
    """Each frame and its picture for the board, with a rectifier those of both cameras."""
    if other is None or rectifier is None:
        yield from ((frame, (run.fit.show(frame.picture),)) for frame in run.frames())
        return
    frames: Iterator[tuple[Frame | None, Frame | None]] = zip_longest(run.frames(), other)
    for one, two in frames:
        if one is None or two is None:
            raise SignumError(f"{run.source.label} and {other.label}: one has fewer frames than the other; give "
                              "frames of the same moments")
        yield one, tuple(run.fit.show(p) for p in rectifier(one.grey, two.grey))


def _claimed(run: Session, film: bool) -> Path:
    """The folder, with the files of the record claimed."""
    run.page()
    for name in ("follow.csv", *(["follow.mp4"] if film else [])):
        run.file(name)
    return run.folder


def _record(run: Session, record: FollowRecord) -> FollowRecord:
    """The record, closed with the run, whose outcome it is."""
    run.at_end(record.close)
    run.summary = lambda: (f"{run.folder / 'follow.csv'}: {len(record.states)} frames, lost in "
                           f"{record.share(State.LOST):.0%}; {run.folder / 'report.html'}")
    return record


def _word(target: Target) -> str:
    """A target for the progress line."""
    return str(target.state) if target.lost else f"{target.state} at {target.x:.0f}, {target.y:.0f}"


def _page(run: Session, section: Section) -> None:
    page = run.folder / PAGE
    shown = film_of(run.folder / "follow.mp4")
    write_page(page, "Signum: Object following", [section, *([Section("Film", shown)] if shown else [])],
               head(page, run.about()))
