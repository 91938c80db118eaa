"""`signum follow`."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, islice, zip_longest
from pathlib import Path
from typing import Annotated

import typer

from signum.applications.follow.eyes import MOTION_WINDOW, RANGE_WINDOW, Eye, MotionEye, RangeEye
from signum.applications.follow.follower import State, Target
from signum.applications.follow.judge import judge_chase
from signum.applications.follow.page import draw_chase, draw_states, follow_bars, follow_section
from signum.applications.follow.pilot import Where
from signum.applications.follow.record import FollowRecord
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.applications.follow.watch import watch_fish
from signum.boards.board import BoardBase
from signum.commands.common import (
    BoardName,
    BoardOption,
    OutOption,
    SigmaOption,
    app,
    board_of,
    clocks_line,
    fit_to,
    guarded,
)
from signum.common.arrays import Image
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.calibration import Rectifier, StereoGeometry, read_stereo
from signum.measure.measurer import Measurer
from signum.report.page import Section, write_page
from signum.sources.open import open_source
from signum.world.camera import Pinhole


@app.command()
@guarded
def follow(
    source: Annotated[str | None, typer.Option("--source", show_default="simulated world",
                                               help="Recorded or live frames instead: video, folder of pictures, .npy "
                                               "array, camera number; segmented by motion, or with --right by "
                                               "range.")] = None,
    right: Annotated[str | None, typer.Option("--right", help="The right camera's frames, for range; needs "
                                              "--calibration.", show_default=False)] = None,
    calibration: Annotated[Path | None, typer.Option("--calibration", show_default=False,
                                                     help="OpenCV YAML of the stereo pair (K1 D1 K2 D2 R T).")] = None,
    nearer: Annotated[float, typer.Option("--nearer", min=0.2, help="Nearer than this is fish, metres.")] = 4.0,
    output: OutOption = Path("out/follow"),
    where: Annotated[Where, typer.Option("--where", help="Simulated: midwater, by range; terrain, by motion.")
                     ] = Where.MIDWATER,
    seconds: Annotated[float | None, typer.Option("--seconds", min=1.0, show_default="60; a source's whole length",
                                                  help="Length of the run.")] = None,
    rate: Annotated[float, typer.Option("--rate", min=0.1, max=1000.0, help="Frames per second of the source.")] = 10.0,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the simulated world.")] = 0,
    darts: Annotated[float | None, typer.Option("--darts", min=1.0, show_default="never",
                                                help="Second at which the simulated fish darts out of view.")] = None,
    film: Annotated[bool, typer.Option("--film", help="Write follow.mp4 too.")] = False,
    sigma: SigmaOption = 2.0,
    window: Annotated[int | None, typer.Option("--window", min=8, max=128, help="Side of the windows, pixels of the "
                                               "board's picture.",
                                               show_default=f"{RANGE_WINDOW} by range, {MOTION_WINDOW} by motion")
                      ] = None,
    board: BoardOption = BoardName.golden,
) -> None:
    """Follow a fish: `follow.csv` with its blob for every frame and `report.html`. A simulated vehicle with a pan/tilt
    in closed loop, or with `--source` open loop on frames of your own.

    Example: `signum follow --source dive.mp4 --out out/follow`
    """
    if source is None and (right or calibration):
        raise SignumError("--right and --calibration belong to a --source")
    if (right is None) != (calibration is None):
        raise SignumError("range needs both --right and --calibration; leave both out to segment by motion")
    with board_of(board, window or 8) as b:
        output.mkdir(parents=True, exist_ok=True)
        if source is None:
            chase = Chase(where, seconds or 60.0, darts=() if darts is None else (darts,), seed=seed,
                          window=window)
            _chase(b, chase, output, film, sigma)
        else:
            _watch(b, source, right, calibration, nearer, output, seconds, rate, film, sigma, window)


def _chase(board: BoardBase, chase: Chase, output: Path, film: bool, sigma: float) -> None:
    camera, rows = Pinhole(), []
    record = FollowRecord(output, True, chase.rate, film, max(2.0, chase.seconds / 6))
    total = round(chase.seconds * chase.rate)
    out.print(f"seed {chase.seed}")
    try:
        with progress("following", total) as tell:
            for k, g in enumerate(simulate_chase(lambda size: Measurer(board, size, sigma), chase, camera)):
                record.add(str(k), g.time, g.target, g.frame,
                           truth=(*g.truth, g.range_m, *(57.29578 * a for a in g.head)))
                rows.append(g.row(camera))
                tell(str(g.target.state))
    finally:
        record.close()
        if rows:
            figures = judge_chase(rows, chase.rate, min(5.0, chase.seconds / 2))
            bars = follow_bars(chase.where, figures)
            about = (f"A simulated fish in turbid water, {chase.where}; a pan/tilt follows it, the vehicle follows the "
                     f"pan/tilt; seed {chase.seed}.")
            facts = [("in view", f"{figures.in_view:.1%}"), ("times found again", str(figures.finds)),
                     ("longest time lost, s", f"{figures.longest_lost_s:.1f}"),
                     ("frames with the target off the fish", f"{figures.wrong:.1%}")]
            _page(output, follow_section("Object following, simulated", about, record, draw_chase(rows, camera.size),
                                         "Where the fish was (truth); green: the centre quarter.", facts, bars))
            for bar in bars:
                out.print(str(bar), markup=False)
    _done(board, output, record)


def _watch(board: BoardBase, source: str, right: str | None, calibration: Path | None, nearer: float, output: Path,
           seconds: float | None, rate: float, film: bool, sigma: float, window: int | None) -> None:
    frames = open_source(source)
    others = open_source(right) if right is not None else None
    rectifier = read_stereo(calibration) if calibration is not None else None
    left = iter(frames)
    first = next(left)
    fit = fit_to(first, board, max(64, window or 0), frames)
    measurer = Measurer(board, fit.board, sigma)
    eye: Eye = MotionEye(measurer, window=window or MOTION_WINDOW)
    if rectifier is not None:
        g, k = rectifier.geometry, fit.factor[0]
        scaled = StereoGeometry(g.focal / k, g.baseline, (g.centre[0] / k, g.centre[1] / k), g.shift / k)
        eye = RangeEye(measurer, scaled, nearer, window=window or RANGE_WINDOW)
    total = frames.count if seconds is None else min(round(seconds * rate), frames.count or round(seconds * rate))
    names: list[str] = []
    shown: list[Image] = []

    def pictures() -> Iterator[tuple[Image, ...]]:
        partners = iter(others) if others is not None else iter(())
        stop = total if seconds is not None else None
        pairs: Iterator[tuple[Frame, Frame | None]] = (
            zip_longest(chain([first], left), partners) if others is not None
            else ((f, None) for f in chain([first], left)))
        for one, two in islice(pairs, stop):
            if others is not None and (one is None or two is None):
                raise SignumError(f"{frames.label} and {others.label}: one has fewer frames than the other; give "
                                  "frames of the same moments")
            pair = _prepared(one, two, rectifier, fit)
            names.append(one.name)
            shown[:] = pair[:1]
            yield pair

    record = FollowRecord(output, False, rate, film, max(2.0, (total or 600) / rate / 6))
    try:
        with progress("following", total) as tell:
            for k, target in enumerate(watch_fish(eye, pictures())):
                record.add(names[-1], k / rate, target, shown[0], fit.factor)
                tell(_word(target))
    finally:
        record.close()
        if record.states:
            how = f"by range, nearer than {nearer:g} m" if rectifier else "by motion against the scene"
            _page(output, follow_section("Object following, open loop", f"{frames.label}, segmented {how}.", record,
                                         draw_states(record.states), "What was known of it."))
    _done(board, output, record)


def _prepared(one: Frame, two: Frame | None, rectifier: Rectifier | None, fit: Fit) -> tuple[Image, ...]:
    if rectifier is None or two is None:
        return (fit.show(one.picture),)
    return tuple(fit.show(p) for p in rectifier(one.grey, two.grey))


def _word(target: Target) -> str:
    return str(target.state) if target.lost else f"{target.state} at {target.x:.0f}, {target.y:.0f}"


def _page(output: Path, section: Section) -> None:
    write_page(output / "report.html", "Object following", [section])


def _done(board: BoardBase, output: Path, record: FollowRecord) -> None:
    notes.print(clocks_line(board, len(record.states)))
    out.print(f"{output / 'follow.csv'}: {len(record.states)} frames, lost in {record.share(State.LOST):.0%}; "
              f"{output / 'report.html'}")
