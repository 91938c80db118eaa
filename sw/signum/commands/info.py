"""`signum info`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict

from rich.table import Table as Grid

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
        identify: Callable[[], dict[str, object]] | None = getattr(opened, "identification", None)
        about: dict[str, object] = identify() if identify else {"id": "none: a model in software",
                                                                "board": opened.name}
        config = opened.config
        about |= {"configuration": config.name, **{k: v for k, v in asdict(config).items() if k != "name"},
                  "max_window": config.max_window, "lanes": config.lanes}
        for name, value in (about | opened.counters()).items():
            grid.add_row(name, str(value))
        out.print(grid)
