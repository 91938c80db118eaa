# SPDX-License-Identifier: Apache-2.0
"""`signum info`."""

from __future__ import annotations

from dataclasses import asdict

from rich.table import Table as Grid

from signum.boards.golden import GoldenBoard
from signum.commands.app import command
from signum.commands.options import BoardOptions
from signum.commands.session import board_of
from signum.common.console import out

BOARD_DEFAULTS = BoardOptions(sigma=2.5)


@command()
def info(board: BoardOptions = BOARD_DEFAULTS) -> None:
    """The board's identification, configuration and counters.

    Example: `signum info --board verilated`
    """
    with board_of(board.board, board.window) as opened:
        grid = Grid(show_header=False, box=None)
        build = {name: value for name, value in asdict(opened.config).items() if name != "name"}
        about = asdict(opened.identification) | build | {"lanes": opened.config.lanes}
        if isinstance(opened, GoldenBoard):
            about["arithmetic"] = opened.arithmetic
        for name, value in (about | opened.counters()).items():
            grid.add_row(name, str(value))
        out.print(grid)
