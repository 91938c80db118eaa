# SPDX-License-Identifier: Apache-2.0
"""`signum filter`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from signum.commands.app import command
from signum.commands.options import BoardOptions, OutOption
from signum.commands.session import Session
from signum.common.files import write_picture
from signum.frames.frame import read_picture
from signum.report.draw import stage_panel

BOARD_DEFAULTS = BoardOptions(sigma=2.5, window=8)


@command("filter")
def filter_(
    image: Annotated[Path, typer.Argument(help="An 8-bit picture, grey or colour.", show_default=False)],
    output: OutOption = Path("out/filter"),
    board: BoardOptions = BOARD_DEFAULTS,
) -> None:
    """Sign of the Laplacian of Gaussian of a picture: `sign.png` (0/255) and `stages.png`, a panel of the stages.

    Example: `signum filter seabed.png --sigma 2 --out out/filter`
    """
    picture = read_picture(image)
    with Session("filter", board, output) as run:
        fit = run.fit_to((picture.shape[1], picture.shape[0]), str(image))
        measurer, shown = run.measurer(fit.board), fit.show(picture)
        signs = measurer.signs(measurer.view(shown))
        write_picture(run.file("sign.png"), signs * 255)
        write_picture(run.file("stages.png"), stage_panel(shown, signs, board.sigma))
        run.tell("")
        run.summary = lambda: (f"{output / 'sign.png'}: {signs.shape[1]}x{signs.shape[0]}, "
                               f"{100 * signs.mean():.1f} % white")
