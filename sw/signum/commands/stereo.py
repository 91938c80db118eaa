"""`signum stereo`."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import tifffile
import typer

from signum.commands.common import (
    BoardName,
    BoardOption,
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
from signum.common.arrays import Image
from signum.common.console import notes, out, progress
from signum.common.errors import SourceError
from signum.frames.fit import Fit
from signum.frames.frame import Frame, Source, grey
from signum.geometry.calibration import Rectifier, StereoGeometry, read_stereo
from signum.measure.measurer import Measurer
from signum.measure.stereo import RangeMap, draw_range, measure_range, write_ply
from signum.report.rows import disparity_rows
from signum.sources.open import open_source
from signum.tables.schemas import DISPARITY
from signum.tables.table import Table


@app.command()
@guarded
def stereo(
    left: Annotated[str, typer.Argument(help="Left picture, folder, video or bag.", show_default=False)],
    right: Annotated[str, typer.Argument(help="The right one's; as many frames.", show_default=False)],
    output: OutOption = Path("out/stereo"),
    sigma: SigmaOption = 1.0,
    window: WindowOption = 16,
    board: BoardOption = BoardName.golden,
    calibration: Annotated[Path | None, typer.Option(
        "--calibration", help="OpenCV YAML of the pair (K1 D1 K2 D2 R T image_width image_height, T in metres): "
        "rectifies, and gives ranges. Without it the pictures must be rectified, and only disparities are written.",
    )] = None,
    rectified: Annotated[bool, typer.Option("--rectified", help="They are rectified already: use the calibration for "
                                            "ranges only.")] = False,
    nearest: Annotated[int | None, typer.Option("--most", min=2, help="Largest disparity searched for, original "
                                                "pixels; a quarter of the width if not given.")] = None,
    farthest: Annotated[int, typer.Option("--least", help="Smallest disparity, original pixels.")] = 0,
    step: Annotated[int, typer.Option("--step", min=1, help="Grid of the map, pixels of the board's picture.")] = 8,
) -> None:
    """Range from a stereo pair: `range.png`, `range.tiff`, `points.ply`, `disparity.csv`, `report.html`.

    Of folders and videos every frame's files carry its name, `range_0001.png`.

    Example: `signum stereo left.png right.png --calibration rig.yaml --out out/stereo`
    """
    rig = read_stereo(calibration) if calibration is not None else None
    sources = open_source(left), open_source(right)
    one = sources[0].count == 1
    done, shares = 0, []
    with board_of(board, window) as b, progress("stereo", sources[0].count) as tell:
        output.mkdir(parents=True, exist_ok=True)
        for old in (*output.glob("range*.png"), *output.glob("range*.tiff"), *output.glob("points*.ply")):
            old.unlink()
        table = Table(output / "disparity.csv", DISPARITY)
        try:
            for name, pair in _pairs(sources, None if rectified else rig):
                fit = fit_to(Frame(name, pair[0]), b, window, sources[0])
                measurer = Measurer(b, fit.board, sigma)
                views = measurer.pair(fit.show(pair[0]), fit.show(pair[1]))
                found = measure_range(measurer, *views, _disparities(fit, farthest, nearest), (window, window), step)
                suffix = "" if one else f"_{name}"
                geometry = rig.geometry if rig else None
                _write(output, suffix, fit, found, geometry, fit.show(pair[0]))
                for line in disparity_rows(name, found.to_source(fit), geometry):
                    table.write(line)
                done += 1
                shares.append(float(found.valid.mean()))
                tell(f"{shares[-1]:.0%} valid")
        finally:
            table.close()
            if done:
                write_report(output)
        notes.print(clocks_line(b, done))
    out.print(f"{output / 'disparity.csv'}: {done} pairs, {np.mean(shares):.0%} of the windows valid")


def _pairs(sources: tuple[Source, Source], rig: Rectifier | None) -> Iterator[tuple[str, tuple[Image, Image]]]:
    """Grey pictures of both sources, rectified, by the left one's name."""
    for a, b in zip_longest(*sources):
        if a is None or b is None:
            short, other = sources if a is None else sources[::-1]
            raise SourceError(f"{short.label}: fewer frames than {other.label}: every left frame needs its right one")
        if a.size != b.size:
            raise SourceError(f"frame {a.name} is {a.size[0]}x{a.size[1]}, its right one {b.size[0]}x{b.size[1]}: "
                              "both cameras must give pictures of one size")
        pair = grey(a.picture), grey(b.picture)
        yield a.name, rig(*pair) if rig else pair


def _disparities(fit: Fit, least: int, most: int | None) -> tuple[int, int]:
    factor = fit.factor[0]
    low = int(np.floor(least / factor))
    high = fit.board[0] // 4 if most is None else int(np.ceil(most / factor))
    if high < low + 2:
        raise SourceError(f"--least {least} to --most {most}: search at least three disparities")
    return low, high


def _write(output: Path, suffix: str, fit: Fit, found: RangeMap, geometry: StereoGeometry | None, shown: Image
           ) -> None:
    whole = found.to_source(fit)
    values = whole.disparity if geometry is None else geometry.depth(whole.disparity)
    cv2.imwrite(str(output / f"range{suffix}.png"), draw_range(found, geometry and geometry.shrunk(fit.factor), shown))
    tifffile.imwrite(output / f"range{suffix}.tiff", values.astype(np.float32), metadata={
        "unit": "px of disparity" if geometry is None else "m", "first_x_px": float(whole.x[0]),
        "first_y_px": float(whole.y[0]), "step_x_px": float(np.diff(whole.x[:2]).sum()),
        "step_y_px": float(np.diff(whole.y[:2]).sum())})
    if geometry is not None:
        write_ply(output / f"points{suffix}.ply", whole.points(geometry))
