# SPDX-License-Identifier: Apache-2.0
"""`signum demo`."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

from signum.commands.app import command
from signum.commands.options import BoardName, BoardOptions, OutOption
from signum.commands.outputs import PAGE, Outputs
from signum.commands.session import board_of
from signum.common.console import out, progress

MADE = PAGE, "track.csv", "edges.csv", "poses.csv", "mosaic.png", "overview.png", "run.json", "frames/journal.txt"
"""Files of the demonstration, the report first."""
BOARD_DEFAULTS = BoardOptions(BoardName.verilated, window=48)


@command()
def demo(output: OutOption = Path("out/demo"), board: BoardOptions = BOARD_DEFAULTS) -> None:
    """A simulated flight over gravel: tracks, builds a mosaic, holds station; `mosaic.png`, `track.csv`, `report.html`.

    Example: `signum demo --board golden --out out/demo`
    """
    from signum.demo.fly import run_demo  # plots: not needed by the other commands

    with board_of(board.board, board.window) as opened, closing(Outputs(output, "demo", replace=False)) as outputs:
        for name in MADE:
            outputs.file(name)
        report = run_demo(opened, output, board.sigma, board.window, progress)
    out.print(f"{report}: open it in a browser")
