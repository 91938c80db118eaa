"""`signum filter`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import cv2
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
    guarded,
)
from signum.common.console import notes, out
from signum.frames.fit import Fit
from signum.frames.frame import read_picture
from signum.measure.measurer import Measurer
from signum.report.draw import stage_panel


@app.command("filter")
@guarded
def filter_(
    image: Annotated[Path, typer.Argument(help="An 8-bit picture, grey or colour.", show_default=False)],
    output: OutOption = Path("out/filter"),
    sigma: SigmaOption = 2.5,
    board: BoardOption = BoardName.golden,
    window: WindowOption = 8,
) -> None:
    """Sign of the Laplacian of Gaussian of a picture: `sign.png` (0/255) and `stages.png`, a panel of the stages.

    Example: `signum filter seabed.png --sigma 2 --out out/filter`
    """
    picture = read_picture(image)
    with board_of(board, window) as b:
        fit = Fit.to((picture.shape[1], picture.shape[0]), b.config, window, str(image))
        if fit.scaled:
            notes.print(fit.note())
        measurer = Measurer(b, fit.board, sigma)
        shown = fit.show(picture)
        signs = measurer.signs(measurer.view(shown))
        output.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(output / "sign.png"), signs * 255)
        cv2.imwrite(str(output / "stages.png"), stage_panel(shown, signs, sigma))
        notes.print(clocks_line(b, 1))
    out.print(f"{output / 'sign.png'}: {signs.shape[1]}x{signs.shape[0]}, {100 * signs.mean():.1f} % white")
