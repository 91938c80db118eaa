"""`signum report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from signum.commands.common import app, guarded, write_report
from signum.common.console import out


@app.command()
@guarded
def report(
    folder: Annotated[Path, typer.Argument(help="The --out folder of an earlier command.", show_default=False)],
) -> None:
    """Make `report.html` anew from the tables and pictures a command left, finished or not.

    Example: `signum report out/track`
    """
    write_report(folder)
    out.print(f"{folder / 'report.html'}: open it in a browser")
