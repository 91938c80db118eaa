"""`signum demo`."""

from __future__ import annotations

from pathlib import Path

from signum.commands.common import BoardName, BoardOption, OutOption, SigmaOption, WindowOption, app, board_of, guarded
from signum.common.console import out, progress


@app.command()
@guarded
def demo(
    output: OutOption = Path("out/demo"),
    board: BoardOption = BoardName.verilated,
    sigma: SigmaOption = 2.0,
    window: WindowOption = 48,
) -> None:
    """A simulated flight over gravel: tracks, builds a mosaic, holds station; `mosaic.png`, `track.csv`, `report.html`.

    Example: `signum demo --board golden --out out/demo`
    """
    from signum.demo.fly import run_demo  # plots: not needed by the other commands

    with board_of(board, window) as b:
        report = run_demo(b, output, sigma, window, progress)
    out.print(f"{report}: open it in a browser")
