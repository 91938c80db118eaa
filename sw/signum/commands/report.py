# SPDX-License-Identifier: Apache-2.0
"""`signum report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from signum.commands.app import command
from signum.commands.outputs import locked
from signum.common.console import out


@command()
def report(
    folder: Annotated[Path, typer.Argument(help="The --out folder of an earlier command.", show_default=False)],
) -> None:
    """Make `report.html` anew from the tables and pictures a command left, finished or not.

    Example: `signum report out/track`
    """
    from signum.report.folder import write_report  # plots take seconds to load

    with locked(folder):
        write_report(folder)
    out.print(f"{folder / 'report.html'}: open it in a browser")
