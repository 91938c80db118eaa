"""The `signum` command."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Annotated, ParamSpec

import cv2
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table as Grid

from sw.board import MAX_SIGMA, MIN_SIGMA, BoardBase, BoardError
from sw.boards import open_board
from sw.errors import SignumError
from sw.measure import Measurer
from sw.mosaic import Column
from sw.panel import draw_tracks, stage_panel
from sw.register import Registrar
from sw.sources import Fit, Frame, Source, open_source, read_picture
from sw.tables import TRACK, Table, track_row
from sw.track import PRECISE_PX, Tracker, TrackPoint, TrackSettings

app = typer.Typer(
    name="signum", no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="Sign-of-LoG vision for underwater robots: filters, tracks and builds mosaics on a simulated board.")
LONGEST = 500
"""Characters of an error line: a tool's whole output is not for here."""
P = ParamSpec("P")
notes = Console(stderr=True, highlight=False, soft_wrap=True)
out = Console(highlight=False, soft_wrap=True)


class BoardName(StrEnum):
    """`boards.BOARDS`, as a choice."""

    golden = "golden"
    verilated = "verilated"


BoardOption = Annotated[BoardName, typer.Option("--board", help="Golden model, or RTL under Verilator; same bits.")]
SigmaOption = Annotated[float, typer.Option("--sigma", min=MIN_SIGMA, max=MAX_SIGMA,
                                            help="Width of the LoG's Gaussian, pixels of the board's picture.")]
WindowOption = Annotated[int, typer.Option("--window", min=8, max=128,
                                           help="Side of the correlation windows, pixels of the board's picture.")]
OutOption = Annotated[Path, typer.Option("--out", help="Folder for what is written; made if missing.")]


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """A command whose errors are one line and a status: 1 for what the user can mend, 130 when stopped."""
    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except (SignumError, BoardError) as error:
            _fail(str(error))
        except (FileExistsError, NotADirectoryError) as error:
            _fail(f"{error.filename} is a file: choose another folder with --out")
        except OSError as error:
            _fail(f"{error.filename or 'file'}: {error.strerror or error}")
        except KeyboardInterrupt:
            notes.print("signum: stopped; what was finished is kept")
            raise typer.Exit(130) from None
    return run


def _fail(message: str) -> None:
    line = " ".join(message.split())
    notes.print(f"signum: {line if len(line) <= LONGEST else line[:LONGEST] + ' ...'}", markup=False)
    raise typer.Exit(1)


@contextmanager
def board_of(name: BoardName, window: int = 8) -> Iterator[BoardBase]:
    """The board, opened and closed again."""
    if name == "verilated":
        notes.print("board: Verilated RTL (built once, on first use)")
    with open_board(name) as board:
        if not board.config.min_window <= window <= board.config.max_window:
            raise SignumError(f"--window {window}: choose {board.config.min_window} to {board.config.max_window}")
        yield board


@contextmanager
def progress(what: str, total: int | None) -> Iterator[Callable[[str], None]]:
    """A progress line on the terminal; call what is yielded once a frame with a word on how it went."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
               TimeElapsedColumn(), TextColumn("{task.fields[state]}"))
    with Progress(*columns, console=notes) as bar:
        task = bar.add_task(what, total=total, state="")
        yield lambda state: bar.update(task, advance=1, state=state)


def _fit(frame: Frame, board: BoardBase, window: int, source: Source) -> Fit:
    fit = Fit.to(frame.size, board.config, window, f"{source.label}: frame {frame.name}")
    if fit.scaled:
        notes.print(fit.note())
    return fit


def _clocks(board: BoardBase, frames: int) -> str:
    """What the board did, in a line."""
    kind = "" if board.name == "verilated" else " (estimated)"
    per = board.clocks / max(frames, 1)
    return f"board: {board.clocks:,} clocks{kind}, {1e3 * per / 150e6:.2f} ms a frame at 150 MHz"


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
        notes.print(_clocks(b, 1))
    out.print(f"{output / 'sign.png'}: {signs.shape[1]}x{signs.shape[0]}, {100 * signs.mean():.1f} % white")


@app.command()
@guarded
def track(
    source: Annotated[str, typer.Argument(help="Video, folder of pictures, .npy array or camera number.",
                                          show_default=False)],
    output: OutOption = Path("out/track"),
    sigma: SigmaOption = 2.5,
    window: WindowOption = 64,
    board: BoardOption = BoardName.golden,
    features: Annotated[int, typer.Option("--features", min=1, max=200, help="Features to keep in view.")] = 30,
) -> None:
    """Track features against the image they were chosen in: `track.csv`, and `track.png`, the last frame with them.

    Example: `signum track dive.mp4 --window 64 --out out/track`
    """
    frames = open_source(source)
    points: list[TrackPoint] = []
    measured = valid = done = 0
    with board_of(board, window) as b, progress("tracking", frames.count) as tell:
        output.mkdir(parents=True, exist_ok=True)
        table = Table(output / "track.csv", TRACK)
        tracker: Tracker | None = None
        frame: Frame | None = None
        try:
            for frame in frames:
                if tracker is None:
                    fit = _fit(frame, b, window, frames)
                    settings = TrackSettings(window=window, features=features, precise_px=PRECISE_PX / max(fit.factor))
                    tracker = Tracker(Measurer(b, fit.board, sigma), settings)
                points = tracker.step(fit.show(frame.picture))
                for point in points:
                    table.write(track_row(frame.name, point, fit))
                measured, valid, done = measured + len(points), valid + sum(p.valid for p in points), done + 1
                tell(f"{sum(p.valid for p in points)} of {len(points)} valid")
        finally:
            table.close()
            if frame is not None and points:
                cv2.imwrite(str(output / "track.png"), draw_tracks(fit.show(frame.picture), points, window))
        notes.print(_clocks(b, done))
    out.print(f"{output / 'track.csv'}: {done} frames, {measured} measurements, {valid} valid")


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
                        fit = _fit(frame, b, window, frames)
                        column = Column(Registrar.on(measurer, fit, window, sigma), output, not frames.snapshots)
                    edge = column.add(frame)
                    done += 1
                    tell("" if edge is None else f"{edge.frame_a} to {edge.frame_b}: "
                         f"{f'{edge.dx_px:.1f}, {edge.dy_px:.1f} px' if edge.accepted else edge.reason}")
        finally:
            if column is not None:
                column.close()
        notes.print(_clocks(b, done))
    assert column is not None
    for edge in column.edges:
        if not edge.accepted:
            out.print(f"refused: {edge.frame_a} to {edge.frame_b} ({edge.reason})")
    if len(column.pieces) > 1:
        out.print(f"the chain broke: {len(column.pieces)} pieces, of which mosaic.png and poses.csv are the first")
    accepted = sum(e.accepted for e in column.edges)
    out.print(f"{output / 'mosaic.png'}: {done} frames, {accepted} of {len(column.edges)} edges accepted")


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
        identify: Callable[[], dict[str, object]] | None = getattr(b, "identification", None)
        about: dict[str, object] = identify() if identify else {"id": "none: a model in software", "board": b.name}
        about |= {"configuration": b.config.name, **{k: v for k, v in asdict(b.config).items() if k != "name"},
                  "max_window": b.config.max_window, "lanes": b.config.lanes}
        for name, value in (about | b.counters()).items():
            grid.add_row(name, str(value))
        out.print(grid)


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
    from sw.demo import run_demo  # plots: not needed by the other commands

    with board_of(board, window) as b:
        report = run_demo(b, output, sigma, window, progress)
    out.print(f"{report}: open it in a browser")


def main() -> None:
    """Entry point."""
    try:
        app()
    except BrokenPipeError:
        sys.exit(0)


if __name__ == "__main__":
    main()
