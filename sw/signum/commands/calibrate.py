# SPDX-License-Identifier: Apache-2.0
"""`signum calibrate`."""

from __future__ import annotations

import time
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from signum.applications.calibrate.result import (
    corner_rows,
    draw_coverage,
    draw_residuals,
    draw_rows,
    draw_straight,
    view_rows,
)
from signum.applications.calibrate.solve import LEAST_VIEWS, LensFit, LensModel, RigFit, fit_lens, fit_rig
from signum.applications.calibrate.target import DICTIONARIES, Sighting, SquareBoard, TargetKind
from signum.applications.calibrate.views import BoardView, choose, frames_looked_at, look
from signum.commands.app import command
from signum.commands.options import GIVEN, SOURCE, OutOption
from signum.commands.outputs import PAGE, Outputs, identity
from signum.common.arrays import Image
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.common.files import write_picture, write_text
from signum.common.version import VERSION
from signum.frames.frame import Frame, Source
from signum.geometry.calibration import calibration_text
from signum.geometry.coverage import hints
from signum.sources.open import open_source
from signum.tables.schemas import CORNERS, VIEWS
from signum.tables.table import Table

TARGET = "Board of squares"
CAMERAS = "left", "right"
SQUARE_PX = 200
"""Side of a square of a board that is drawn for printing, pixels."""
EMPTY = 3
"""Frames without the board that are kept to find out what board they show instead."""


@dataclass(frozen=True)
class TargetOptions:
    """The board."""

    target: Annotated[TargetKind, typer.Option("--target", rich_help_panel=TARGET, help="Kind of the board.",
                                               )] = TargetKind.charuco
    across: Annotated[int, typer.Option("--across", rich_help_panel=TARGET, min=3, max=100,
                                        help="Squares across, black and white ones.")] = 11
    down: Annotated[int, typer.Option("--down", rich_help_panel=TARGET, min=3, max=100, help="Squares down.")] = 8
    square: Annotated[float, typer.Option("--square", rich_help_panel=TARGET, min=0.001, max=1.0,
                                          help="Side of a square, metres, as measured on the print.")] = 0.03
    marker: Annotated[float | None, typer.Option(
        "--marker", rich_help_panel=TARGET, min=0.0005, max=1.0, show_default="3/4 of a square",
        help="Side of a ChArUco board's markers, metres.")] = None
    dictionary: Annotated[str, typer.Option(
        "--dictionary", rich_help_panel=TARGET, help="Set of a ChArUco board's markers, as OpenCV names it.",
    )] = "5X5_100"

    def board(self) -> SquareBoard:
        """The board.

        Raises:
            SignumError: if there is none such.
        """
        name = self.dictionary.upper().removeprefix("DICT_").replace("_36H", "_36h")
        if name not in DICTIONARIES:
            raise SignumError(f"--dictionary {self.dictionary}: expected one of {', '.join(DICTIONARIES)}")
        marker = 0.75 * self.square if self.marker is None else self.marker
        if marker >= self.square:
            raise SignumError(f"--marker {marker:g}: a marker lies within a square of {self.square:g} m")
        return SquareBoard(self.target, (self.across, self.down), self.square, marker, name)


@dataclass
class _Found:
    """Views of the board so far, with the pictures of the latest, for drawing."""

    views: list[BoardView] = field(default_factory=list)
    pictures: tuple[Image, ...] = ()
    empty: list[Image] = field(default_factory=list)


TARGET_DEFAULTS = TargetOptions()


@command()
def calibrate(
    source: Annotated[str | None, typer.Argument(help="Pictures or video of the board, of the left camera for a pair; "
                                                 "without it the board is drawn for printing.", show_default=False,
                                                 )] = None,
    right: Annotated[str | None, typer.Option(
        "--right", rich_help_panel=SOURCE, show_default=False, help="Pictures or video by the right camera, of the "
        "same moments: calibrates the pair.")] = None,
    model: Annotated[LensModel, typer.Option(
        "--model", help="pinhole: most lenses; rational: strong distortion; fisheye: from about 110 degrees across.",
    )] = LensModel.pinhole,
    most: Annotated[int, typer.Option("--views", min=LEAST_VIEWS, max=500, help="Views that are used at most: those "
                                      "that differ most.")] = 40,
    board: TargetOptions = TARGET_DEFAULTS,
    output: OutOption = Path("out/calibrate"),
) -> None:
    """Calibrate a camera or a stereo pair from views of a board: `calibration.yaml`, which `--calibration` takes,
    `views.csv`, `corners.csv`, and `report.html` with coverage and residuals. Under water, calibrate under water.

    Example: `signum calibrate board.mp4 --across 11 --down 8 --square 0.03 --out out/calibrate`
    """
    target, began = board.board(), time.monotonic()
    if source is None and right is not None:
        raise SignumError("--right needs the left camera's pictures too: signum calibrate LEFT --right RIGHT")
    sources = [open_source(name) for name in (source, right) if name is not None]
    for one in sources:
        if one.live:
            raise SignumError(f"{one.label}: a live camera has no end; record a video or pictures of the board first")
    with closing(Outputs(output, "calibrate", "" if source is None else identity(source))) as outputs:
        if source is None:
            path = outputs.file("target.png")
            write_picture(path, target.draw(SQUARE_PX), 9)
            out.print(f"{path}: {target}; print it without scaling to fit, fix it to a flat plate, measure a square")
            return
        page = outputs.file(PAGE)
        found, target = _look(target, sources)
        label = " and ".join(one.label for one in sources)
        refused = _calibrate(outputs, label, target, found, model, most)
        from signum.report.about import About  # loads plots
        from signum.report.folder import write_report

        moment = datetime.now().astimezone().isoformat(" ", "minutes")
        write_report(output, About("calibrate", VERSION, label, GIVEN.get(), moment, len(found.views),
                                   time.monotonic() - began, "", 0, False, refused,
                                   f"calibration.yaml, which --calibration takes: {model}, of a {target}"))
    out.print(f"{output / 'calibration.yaml'}: {model}, of a {target}; {page}")


def _look(target: SquareBoard, sources: list[Source]) -> tuple[_Found, SquareBoard]:
    """All views of the board; of one that is laid out otherwise than asked for, which is said."""
    found = _search(target, sources)
    if any(seen is not None for view in found.views for seen in view.seen):
        return found, target
    other = target.other(found.empty)
    if other is None:
        raise SignumError(f"no board in any of {len(found.views)} frames of {sources[0].label}: looked for {target}; "
                          "count its squares (--across, --down), and see that it is sharp and not cut off")
    notes.print(f"no {target} in any frame, but {other}: taken instead")
    return _search(other, sources), other


def _search(target: SquareBoard, sources: list[Source]) -> _Found:
    found = _Found()
    with progress("looking for the board", frames_looked_at(sources[0])) as tell:
        for view, frames in look(target, sources):
            found.views.append(view)
            if all(seen is not None for seen in view.seen):
                found.pictures = tuple(frame.grey for frame in frames)
            elif view.seen[0] is None:
                _keep(found.empty, frames[0], len(found.views))
            tell(f"in {sum(v.seen[0] is not None for v in found.views)} of {len(found.views)} frames")
    return found


def _keep(kept: list[Image], frame: Frame, number: int) -> None:
    """Keep the first frame, then later ones in its place ever more rarely, so that those kept lie far apart."""
    if len(kept) < EMPTY:
        kept.append(frame.grey)
    elif number & (number - 1) == 0:
        kept[number.bit_length() % EMPTY] = frame.grey


def _calibrate(outputs: Outputs, source: str, target: SquareBoard, found: _Found, model: LensModel, most: int
               ) -> dict[str, int]:
    """Each camera, then the pair; all but the report is written. What was left out, counted, is returned."""
    size = found.views[0].size
    cameras = len(found.views[0].seen)
    fits: list[LensFit] = []
    pictures = found.pictures or tuple(np.zeros(size[::-1], np.uint8) for _ in range(cameras))
    tables = [Table(outputs.file(name), columns) for name, columns in (("views.csv", VIEWS), ("corners.csv", CORNERS))]
    with closing(tables[0]), closing(tables[1]):
        for k in range(cameras):
            side = CAMERAS[k] if cameras == 2 else ""
            names, views = _chosen(found.views, k, most)
            notes.print(f"{side} camera".strip() + f": the board in {sum(v.seen[k] is not None for v in found.views)} "
                        f"of {len(found.views)} frames; computing from {len(views)} views".replace("  ", " "))
            fit = fit_lens(views, size, model)
            fits.append(fit)
            for table, rows in zip(tables, (view_rows, corner_rows), strict=True):
                for line in rows(names, side or CAMERAS[0], fit):
                    table.write(line)
            _draw(outputs, f"_{side}" * bool(side), pictures[k], fit)
            _tell(side, fit, [names[i] for i in range(len(names)) if i not in fit.used])
    pair = _pair(found.views, fits, most) if cameras == 2 else None
    figures: dict[str, float | str] = {
        "source": source, "board": str(target), "made_by": f"signum {VERSION}",
        "rms_px": fits[0].rms_px, "views_used": float(len(fits[0].used))}
    if pair is not None:
        figures |= {"right_rms_px": fits[1].rms_px, "pair_rms_px": pair.rms_px, "pair_rows_px": pair.rows_px,
                    "pair_views_used": float(len(pair.used))}
        swapped = float((pair.rig.turn.T @ pair.rig.move)[0]) > 0
        one, two = pictures[::-1] if swapped else pictures
        write_picture(outputs.file("rectified.png"), draw_rows(one, two, pair.rig.rectifier()))
    write_text(outputs.file("calibration.yaml"), calibration_text(fits[0].lens, None if pair is None else pair.rig,
                                                                   figures))
    return {"the board is not in the frame, or too little of it": sum(v.seen[0] is None for v in found.views),
            "a view does not fit the others": sum(len(fit.views) - len(fit.used) for fit in fits)}


def _chosen(views: Iterable[BoardView], camera: int, most: int) -> tuple[list[str], list[Sighting]]:
    """Names and corners of a camera's views that differ most from each other."""
    seen = [(view, sighting) for view in views if (sighting := view.seen[camera]) is not None]
    if not seen:
        raise SignumError(f"the {CAMERAS[camera]} camera does not see the board in any frame")
    picked = choose([s.outline for _, s in seen], seen[0][0].size[0], most)
    return [seen[k][0].frame for k in picked], [seen[k][1] for k in picked]


def _draw(outputs: Outputs, suffix: str, picture: Image, fit: LensFit) -> None:
    corners = np.concatenate([fit.views[k].corners for k in fit.used])
    residuals = np.concatenate([fit.residuals[k] for k in fit.used])
    write_picture(outputs.file(f"coverage{suffix}.png"), draw_coverage(picture, corners))
    write_picture(outputs.file(f"residuals{suffix}.png"), draw_residuals(picture, corners, residuals))
    write_picture(outputs.file(f"straight{suffix}.png"), draw_straight(picture, fit.lens))


def _tell(side: str, fit: LensFit, dropped: list[str]) -> None:
    """The camera in a line, what was left out, and what is missing."""
    k = fit.lens.matrix
    error = f" +-{fit.focal_error_px:.2f}" if np.isfinite(fit.focal_error_px) else ""
    out.print(f"{side} camera".strip() + f": focal length {k[0, 0]:.2f}{error}, {k[1, 1]:.2f} px, centre "
              f"{k[0, 2]:.2f}, {k[1, 2]:.2f} px, corners within {fit.rms_px:.3f} px RMS, {len(fit.used)} views")
    if dropped:
        notes.print(f"left out as they do not fit: {', '.join(dropped)}")
    corners = np.concatenate([fit.views[i].corners for i in fit.used])
    for hint in hints(corners, fit.lens.size, fit.tilts_deg()[fit.used], fit.rms_px):
        notes.print(f"{side} camera: {hint}".removeprefix(" "))


def _pair(views: list[BoardView], fits: list[LensFit], most: int) -> RigFit:
    """The pair, from the views that both cameras share and that differ most; said in a line."""
    shared = [pair for view in views if (pair := view.shared) is not None]
    if len(shared) < LEAST_VIEWS:
        raise SignumError(f"both cameras see the board at once in {len(shared)} frames; {LEAST_VIEWS} are needed, 15 "
                          "are good: are the frames of the same moments?")
    picked = choose([one.outline for one, _ in shared], views[0].size[0], most)
    fit = fit_rig([shared[k] for k in picked], fits[0].lens, fits[1].lens)
    if float((-fit.rig.turn.T @ fit.rig.move)[0]) <= 0:
        notes.print("the second camera sits to the left of the first: give the left camera's pictures first, the right "
                    "one's with --right")
    out.print(f"pair: baseline {np.linalg.norm(fit.rig.move):.4f} m, corners within {fit.rms_px:.3f} px RMS, rows of "
              f"the rectified pair within {fit.rows_px:.3f} px, {len(fit.used)} views")
    return fit
