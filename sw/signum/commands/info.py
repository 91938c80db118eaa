"""`signum info`."""

from __future__ import annotations

from dataclasses import asdict

from rich.table import Table as Grid

from signum.commands.common import BoardName, BoardOption, SigmaOption, WindowOption, app, board_of, guarded
from signum.common.console import out


@app.command()
@guarded
def info(
    board: BoardOption = BoardName.golden,
    sigma: SigmaOption = 2.5,
    window: WindowOption = 64,
) -> None:
    """The board's identification, configuration and counters.

    Example: `signum info --board verilated`
    """
    with board_of(board, window) as b:
        grid = Grid(show_header=False, box=None)
        build = {name: value for name, value in asdict(b.config).items() if name != "name"}
        about = asdict(b.identification) | build | {"lanes": b.config.lanes}
        for name, value in (about | b.counters()).items():
            grid.add_row(name, str(value))
        out.print(grid)
