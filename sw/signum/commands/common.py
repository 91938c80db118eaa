"""What all commands share: the application, the common options, errors in one line, progress."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated, ParamSpec

import typer

from golden.params import MAX_SIGMA, MIN_SIGMA
from signum.boards import open_board
from signum.boards.board import Board, BoardError
from signum.common.console import notes
from signum.common.errors import SignumError
from signum.frames.fit import Fit
from signum.frames.frame import Frame, Source

app = typer.Typer(
    name="signum", no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    help="Sign-of-LoG vision for underwater robots: filters, tracks and builds mosaics on a simulated board.")


@app.callback()
def _signum() -> None:
    """A command's name is always asked for, even where only one is loaded."""


LONGEST = 500
"""Characters of an error line: a tool's whole output is not for here."""
P = ParamSpec("P")


class BoardName(StrEnum):
    """`boards.BOARDS`, as a choice."""

    golden = "golden"
    verilated = "verilated"


BoardOption = Annotated[BoardName, typer.Option("--board", help="Golden model, or RTL under Verilator; same bits.")]
SigmaOption = Annotated[float, typer.Option("--sigma", min=MIN_SIGMA, max=MAX_SIGMA,
                                            help="Width of the LoG's Gaussian, pixels of the board's picture.")]
WindowOption = Annotated[int, typer.Option("--window", min=8, max=128,
                                           help="Side of the correlation windows, pixels of the board's picture.")]
CalibrationOption = Annotated[Path | None, typer.Option(
    "--calibration", help="OpenCV YAML of the camera (camera_matrix, distortion_coefficients, image_width, "
    "image_height): distortion is taken out of every frame.")]
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
            _fail(f"{error.filename or 'file'}: {error.strerror or error}; mend that, or choose another --out")
        except KeyboardInterrupt:
            notes.print("signum: stopped; what was finished is kept")
            raise typer.Exit(130) from None
    return run


def _fail(message: str) -> None:
    line = " ".join(message.split())
    notes.print(f"signum: {line if len(line) <= LONGEST else line[:LONGEST] + ' ...'}", markup=False)
    raise typer.Exit(1)


@contextmanager
def board_of(name: BoardName, window: int = 8) -> Iterator[Board]:
    """The board, opened and closed again."""
    if name == "verilated":
        notes.print("board: Verilated RTL (built once, on first use)")
    with open_board(name) as board:
        if not board.config.min_window <= window <= board.config.max_window:
            raise SignumError(f"--window {window}: choose {board.config.min_window} to {board.config.max_window}")
        yield board


def fit_to(frame: Frame, board: Board, window: int, source: Source) -> Fit:
    fit = Fit.to(frame.size, board.config, window, f"{source.label}: frame {frame.name}")
    if fit.scaled:
        notes.print(fit.note())
    return fit


def write_report(folder: Path) -> None:
    """`report.html` of a folder."""
    from signum.report.folder import write_report as write  # plots take seconds to load

    write(folder)


def clocks_line(board: Board, frames: int) -> str:
    """What the board did, in a line."""
    kind = "" if board.name == "verilated" else " (estimated)"
    per = board.clocks / max(frames, 1)
    return f"board: {board.clocks:,} clocks{kind}, {1e3 * per / 150e6:.2f} ms a frame at 150 MHz"
