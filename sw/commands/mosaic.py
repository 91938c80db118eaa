"""`signum mosaic`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sw.commands.common import (
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
    notes,
    out,
    progress,
)
from sw.measure import Measurer
from sw.mosaic import Column
from sw.register import Registrar
from sw.sources import open_source


@app.command()
@guarded
def mosaic(
    source: Annotated[str, typer.Argument(help="Folder of overlapping pictures, video, .npy array or camera number.",
                                          show_default=False)],
    output: OutOption = Path("out/mosaic"),
    sigma: SigmaOption = 2.5,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
) -> None:
    """Single-column mosaic of recorded frames: `mosaic.png`, `poses.csv`, `edges.csv`.

    Example: `signum mosaic survey/ --out out/mosaic`
    """
    frames = open_source(source)
    column: Column | None = None
    done = 0
    with board_of(board, window) as b:
        def measurer(size: tuple[int, int], wide: float) -> Measurer:
            return Measurer(b, size, wide)

        try:
            with progress("mosaic", frames.count) as tell:
                for frame in frames:
                    if column is None:
                        fit = fit_to(frame, b, window, frames)
                        column = Column(Registrar.on(measurer, fit, window, sigma), output, not frames.snapshots)
                    edge = column.add(frame)
                    done += 1
                    tell("" if edge is None else f"{edge.frame_a} to {edge.frame_b}: "
                         f"{f'{edge.dx_px:.1f}, {edge.dy_px:.1f} px' if edge.accepted else edge.reason}")
        finally:
            if column is not None:
                column.close()
        notes.print(clocks_line(b, done))
    assert column is not None
    for edge in column.edges:
        if not edge.accepted:
            out.print(f"refused: {edge.frame_a} to {edge.frame_b} ({edge.reason})")
    if len(column.pieces) > 1:
        out.print(f"the chain broke: {len(column.pieces)} pieces, of which mosaic.png and poses.csv are the first")
    accepted = sum(e.accepted for e in column.edges)
    out.print(f"{output / 'mosaic.png'}: {done} frames, {accepted} of {len(column.edges)} edges accepted")
