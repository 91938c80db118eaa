# SPDX-License-Identifier: Apache-2.0
"""`signum stereo`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import chain, zip_longest
from pathlib import Path
from typing import Annotated

import numpy as np
import tifffile
import typer

from golden.params import DENSE, FULL
from signum.applications.mavlink.distance import DistanceSink
from signum.commands.app import command
from signum.commands.in_step import InStep
from signum.commands.options import (
    AUTOPILOT,
    SOURCE,
    BoardOptions,
    DenseOption,
    MavlinkOption,
    OutOption,
    PairOption,
    tell_defaults,
)
from signum.commands.outputs import identity
from signum.commands.session import Session
from signum.common.arrays import Image
from signum.common.console import notes
from signum.common.errors import SourceError
from signum.common.files import name_part, replacing, write_picture
from signum.frames.clock import FRAME_RATE
from signum.frames.fit import Fit
from signum.frames.frame import Frame, Source, grey
from signum.geometry.calibration import Rectifier, StereoGeometry
from signum.measure.dense_stereo import measure_dense_range
from signum.measure.stereo import RangeMap, measure_range
from signum.measure.winners import REACH
from signum.report.ranges import draw_range, write_ply
from signum.report.rows import disparity_rows
from signum.sources.open import open_rig, open_source
from signum.tables.schemas import DISPARITY

BOARD_DEFAULTS = BoardOptions(sigma=1.0, window=16)
SEARCH = "Search"
GRID = 8
"""Grid of a map without --dense, and least one of the table, pixels of the board's picture."""
FEW = 0.1
"""Share of the first pair's windows below which it is asked whether the pictures are exchanged."""
EXCHANGED = 3.0
"""They are if so many times as many windows are valid in the other order, and 2 FEW of all."""


@dataclass(frozen=True)
class DisparityOptions:
    """Which disparities are searched for, and where."""

    most: Annotated[int | None, typer.Option(
        "--most", rich_help_panel=SEARCH, min=2, show_default="a quarter of the width",
        help="Largest disparity searched for, original pixels.")] = None
    least: Annotated[int, typer.Option("--least", rich_help_panel=SEARCH,
                                       help="Smallest disparity, original pixels.")] = 0
    step: Annotated[int | None, typer.Option("--step", rich_help_panel=SEARCH, min=1, max=255,
                                             show_default="8; 1 with --dense",
                                             help="Grid of the map, pixels of the board's picture.")] = None
    dense: DenseOption = False

    @property
    def grid(self) -> int:
        """Grid of the map, pixels of the board's picture."""
        return self.step or (1 if self.dense else GRID)

    def disparities(self, fit: Fit) -> tuple[int, int]:
        """Smallest and largest disparity, pixels of the board's picture.

        Raises:
            SourceError: if there are fewer than three, or the dense engine does not reach them.
        """
        factor = fit.factor[0]
        low = int(np.floor(self.least / factor))
        high = fit.board[0] // 4 if self.most is None else int(np.ceil(self.most / factor))
        if high < low + 2:
            raise SourceError(f"--least {self.least} to --most {self.most}: search at least three disparities")
        if self.dense and max(-low, high) > REACH:
            far = int(REACH * factor)
            raise SourceError(f"--least {self.least}, --most {round(high * factor)}: the dense engine searches from "
                              f"{-far} to {far}; choose disparities in between, or leave --dense out")
        return low, high


class Facing(StrEnum):
    """The directions of `distance.FACING`, for the choice on the command line."""

    down = "down"
    forward = "forward"


@dataclass(frozen=True)
class RangeOptions:
    """Where ranges are sent."""

    mavlink: MavlinkOption = None
    facing: Annotated[Facing, typer.Option("--facing", rich_help_panel=AUTOPILOT,
                                           help="Where the cameras look.")] = Facing.down
    rate: Annotated[float | None, typer.Option(
        "--rate", rich_help_panel=SOURCE, min=0.1, max=1000.0, show_default="10", help="Pairs per second of sources "
        "whose frames have no times.")] = None


DISPARITY_DEFAULTS, TOLD_DEFAULTS = DisparityOptions(), RangeOptions()


class RangeTeller(InStep):
    """Sends the distances that pairs show, if anywhere, in step with real time.

    Args:
        run: the session, whose source is live or is played in real time.
        told: where to.
        search: for disparities.
        geometry: of the rectified pair; given where anything is sent.
    """

    def __init__(self, run: Session, told: RangeOptions, search: DisparityOptions, geometry: StereoGeometry | None
                 ) -> None:
        self._sink, self._geometry, self._sent = None, geometry, 0
        self._rate, self._origin = told.rate or run.source.rate or FRAME_RATE, 0.0
        if told.mavlink is not None and geometry is not None:
            far, near = (geometry.focal * geometry.baseline / max(d * run.fit.factor[0] + geometry.shift, 1.0)
                         for d in search.disparities(run.fit))
            across, down = (2 * math.atan(side / 4 / geometry.focal) for side in run.fit.source)
            self._sink = run.open(DistanceSink(told.mavlink, told.facing, (near, far), (across, down)))
        super().__init__(self._sink, paced=not run.live)

    def send(self, time_s: float | None, found: RangeMap) -> None:
        """Send the distance of a pair, in original pixels, at its time."""
        if self._sink is None or self._geometry is None:
            return
        if not self._sent:
            self._origin = time_s or 0.0
            self.begin(time_s)
        moment = self._sent / self._rate if time_s is None else time_s - self._origin
        self._sent += 1
        self.wait(moment)
        self._sink.send(moment, self._geometry.depth(found.disparity))


@command()
def stereo(
    left: Annotated[str, typer.Argument(help="Left camera's picture, folder, video or bag.", show_default=False)],
    right: Annotated[str, typer.Argument(help="Right camera's picture, folder, video or bag, with as many frames "
                                         "as the left.", show_default=False)],
    calibration: PairOption = None,
    rectified: Annotated[bool, typer.Option("--rectified", rich_help_panel=SOURCE, help="The frames are rectified "
                                            "already: use the calibration for ranges only.")] = False,
    output: OutOption = Path("out/stereo"),
    board: BoardOptions = BOARD_DEFAULTS,
    search: DisparityOptions = DISPARITY_DEFAULTS,
    told: RangeOptions = TOLD_DEFAULTS,
) -> None:
    """Range from a stereo pair: `range.png`, `range.tiff`, `points.ply`, `disparity.csv`, `report.html`; to an
    autopilot, DISTANCE_SENSOR. Without a calibration the frames must be rectified, and only disparities are written.

    With `--dense` the map has every pixel, and the table every eighth one across and down.

    Of folders and videos every frame's files carry its name, `range_0001.png`.

    Example: `signum stereo left.png right.png --calibration rig.yaml --out out/stereo`
    """
    if told.mavlink is not None and calibration is None:
        raise SourceError("--mavlink: without a --calibration there is no range to send")
    shares: list[float] = []
    tell_defaults({"step": (search.step, search.grid)})
    session = Session("stereo", board, output, left, rate=told.rate, config=DENSE if search.dense else FULL)
    other = open_source(right)
    session.name += f" and {identity(right)}"
    rig = open_rig(calibration).rectifier(session.first.size) if calibration is not None else None
    geometry = None if rig is None else (rectified and rig.given) or rig.geometry
    with session as run:
        teller = RangeTeller(run, told, search, geometry)
        rectify = None if rectified else rig
        search.disparities(run.fit)
        pairs = _pairs(run, other)
        first = next(pairs)  # whatever is wrong with it is said before anything in the folder is touched
        run.page()
        table = run.table("disparity.csv", DISPARITY)
        run.measured = lambda: sum(s > 0 for s in shares)
        run.summary = lambda: (f"{output / 'disparity.csv'}: {run.done} pairs, {np.mean(shares):.0%} of the "
                               f"{'pixels' if search.dense else 'windows'} valid{teller.said}")
        for frame, seen in run.steps("stereo", chain([first], pairs), run.source.count):
            shown, found = _measure(run, seen, rectify, search)
            if not shares and found.valid.mean() < FEW:
                _tell_exchanged(run, seen, rectify, search, float(found.valid.mean()))
            whole = found.to_source(run.fit)
            teller.send(frame.time_s, whole)
            ending = "" if run.source.count == 1 else f"_{name_part(frame.name)}"
            _write(run, ending, run.fit, found, geometry, shown)
            if search.dense:
                whole = whole.thinned(-(-GRID // search.grid))
            for line in disparity_rows(frame, whole, geometry):
                table.write(line)
            run.refused.update(found.refused)
            shares.append(float(found.valid.mean()))
            run.report = run.report_folder
            run.tell(f"{shares[-1]:.0%} valid")


def _measure(run: Session, pair: tuple[Image, Image], rig: Rectifier | None, search: DisparityOptions
             ) -> tuple[Image, RangeMap]:
    """The left picture as the board sees it, rectified by `rig`, and the map of a pair of grey pictures."""
    measurer, window = run.measurer(run.fit.board), run.chosen.window
    left, right = (run.fit.show(p) for p in (rig(*pair) if rig else pair))
    views, disparities = measurer.pair(left, right), search.disparities(run.fit)
    if search.dense:
        return left, measure_dense_range(measurer, *views, disparities, window, search.grid)
    return left, measure_range(measurer, *views, disparities, (window, window), search.grid)


def _tell_exchanged(run: Session, pair: tuple[Image, Image], rig: Rectifier | None, search: DisparityOptions,
                    share: float) -> None:
    """Say so if the pictures of the first pair, of which only this share of the windows is valid, suit each other in
    the other order."""
    other = float(_measure(run, pair[::-1], rig, search)[1].valid.mean())
    if other > max(2 * FEW, EXCHANGED * share):
        notes.print(f"the pictures look exchanged: {share:.0%} of the windows are valid as they are given, {other:.0%} "
                    "in the other order; give the left camera's first")


def _pairs(run: Session, other: Source) -> Iterator[tuple[Frame, tuple[Image, Image]]]:
    """The left frame, and the grey pictures of both cameras."""
    frames: Iterator[tuple[Frame | None, Frame | None]] = zip_longest(run.frames(), other)
    for a, b in frames:
        if a is None or b is None:
            short, longer = (run.source, other) if a is None else (other, run.source)
            raise SourceError(f"{short.label}: fewer frames than {longer.label}: every left frame needs its right one")
        if a.size != b.size:
            raise SourceError(f"frame {a.name} is {a.size[0]}x{a.size[1]}, its right one {b.size[0]}x{b.size[1]}: "
                              "both cameras must give pictures of one size")
        yield a, (grey(a.picture), grey(b.picture))


def _write(run: Session, suffix: str, fit: Fit, found: RangeMap, geometry: StereoGeometry | None, shown: Image
           ) -> None:
    """A pair's map as a picture and as values, and its points where the geometry is known."""
    whole = found.to_source(fit)
    values = whole.disparity if geometry is None else geometry.depth(whole.disparity)
    picture = draw_range(found, geometry and geometry.shrunk(fit.factor), shown)
    write_picture(run.file(f"range{suffix}.png"), picture)
    with replacing(run.file(f"range{suffix}.tiff")) as half:
        tifffile.imwrite(half, values.astype(np.float32), metadata={
            "unit": "px of disparity" if geometry is None else "m", "first_x_px": float(whole.x[0]),
            "first_y_px": float(whole.y[0]), "step_x_px": float(np.diff(whole.x[:2]).sum()),
            "step_y_px": float(np.diff(whole.y[:2]).sum())})
    if geometry is not None:
        with replacing(run.file(f"points{suffix}.ply")) as half:
            write_ply(half, whole.points(geometry))
