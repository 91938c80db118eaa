# SPDX-License-Identifier: Apache-2.0
"""What the commands that measure have in common: source, board, folder, progress, tables, report."""

from __future__ import annotations

import os
import re
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from datetime import datetime
from functools import cached_property
from itertools import chain
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self, TypeVar

from golden.params import FULL, Config
from signum.boards import open_board
from signum.boards.board import Board
from signum.commands.options import GIVEN, BoardName, BoardOptions
from signum.commands.outputs import PAGE, Outputs, identity, lock
from signum.common.console import notes, out, progress
from signum.common.errors import SignumError
from signum.common.version import VERSION
from signum.frames.clock import timed
from signum.frames.fit import Fit
from signum.frames.frame import Frame, Source
from signum.measure.measurer import Measurer
from signum.sources.open import open_source
from signum.tables.table import Table

if TYPE_CHECKING:
    from signum.report.about import About

CLOCK_HZ = 150e6
"""Clock of a real board for which times are given."""
T = TypeVar("T")


class Session:
    """A command's run; use it in a `with`.

    On leaving, also after an error or an interrupt, it closes what was opened and writes the report, if there is one.
    Unless an error ended the run, it then prints what the board did and what was written, and fails if that is nothing.

    Args:
        command: its name, under which the files it makes are recorded.
        chosen: the board, its filter and window.
        folder: for the files that are written.
        source: what the user named as the source of frames, None for none.
        calibration: of the source's camera, whose distortion is taken out.
        rate: frames per second of a source whose frames have no times.
        config: the board's build.

    Attributes:
        board: the open board.
        name: of the source, whatever the spelling it was given in; empty for none.
        done: frames finished so far.
        report: writes the report; None as long as there is nothing to report.
        summary: the line on what was written; None for none.
        refused: what was refused, counted by the reason.
        measured: how many frames, or pairs of them, gave a measurement beyond the first, if that is known.
        result: the size of what was made, in words, for the report.

    Raises:
        SignumError: if the source cannot be used, or the window does not suit the board; on leaving, if nothing was
            measured.
    """

    board: Board

    def __init__(self, command: str, chosen: BoardOptions, folder: Path, source: str | None = None,
                 calibration: Path | None = None, rate: float | None = None, config: Config = FULL) -> None:
        self._config = config
        self.command, self.chosen, self.folder = command, chosen, folder
        self.name = "" if source is None else identity(source)
        self._source = None if source is None else open_source(source, calibration)
        self._rate = rate
        self.done = 0
        self.report: Callable[[], object] | None = None
        self.summary: Callable[[], str] | None = None
        self.refused: Counter[str] = Counter()
        self.measured: Callable[[], int] | None = None
        self.result: Callable[[], str] = str
        self._began, self._took = time.monotonic(), 0.0
        self._tell: Callable[[str], None] = lambda state: None
        self._bar, self._opened, self._powered = ExitStack(), ExitStack(), ExitStack()

    def __enter__(self) -> Self:
        self.board = self._powered.enter_context(board_of(self.chosen.board, self.chosen.window, self._config))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        whole = self.done > 0 and (kind is None or issubclass(kind, KeyboardInterrupt))
        with self._powered:
            with self._opened:
                self._bar.close()
            if whole and self.live:
                lost = f"; {self.source.lost:,} packets were lost" if self.source.lost else ""
                notes.print(f"{self.source.label}: {self.source.skipped:,} frames skipped, as newer ones came; those "
                            f"taken were at most {1e3 * self.source.oldest_s:.0f} ms old{lost}")
            if self.report is not None:
                self.report()
            if whole and self.board.clocks:  # in a batch other boards measure
                notes.print(clocks_line(self.board, self.done))
        if whole and self.summary is not None:
            out.print(self.summary())
        if whole and kind is None and self.measured is not None and not self.measured():
            raise SignumError(f"{self.name or 'simulated world'}: nothing could be measured in {self.done} frames: "
                              f"expected frames that overlap and show texture; what was written is in {self.folder}")

    @property
    def source(self) -> Source:
        """The source of frames."""
        assert self._source is not None
        return self._source

    @property
    def live(self) -> bool:
        """Whether the source's frames cannot be had again."""
        return self._source is not None and self._source.live

    @cached_property
    def outputs(self) -> Outputs:
        """The folder for what is written, made and locked on first use."""
        first: Frame | None = self.__dict__.get("first")  # once it has been read
        made = Outputs(self.folder, self.command, self.name, self.live, began_s=first.time_s if first else None)
        self._powered.callback(made.close)
        return made

    def file(self, name: str) -> Path:
        """The path of a file in the folder that the command is going to write; see `Outputs.file`."""
        return self.outputs.file(name)

    def page(self) -> Path:
        """The path of the report, which the command is going to write; call it before anything else is written."""
        return self.file(PAGE)

    def lock(self) -> None:
        """Lock the folder until the session's end, without a record of the files in it; made if missing."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._powered.callback(os.close, lock(self.folder))

    @cached_property
    def first(self) -> Frame:
        """The source's first frame; `frames` gives it again."""
        return next(self._frames)

    @cached_property
    def _frames(self) -> Iterator[Frame]:
        return self.frames_again()

    @cached_property
    def fit(self) -> Fit:
        """How the source's frames are scaled for the board."""
        return self.fit_to(self.first.size, f"{self.source.label}: frame {self.first.name}")

    def fit_to(self, size: tuple[int, int], label: str) -> Fit:
        """How pictures of a size (width, height) are scaled for the board; prints a note where they are.

        Raises:
            SourceError: if they are too small; the message begins with `label`.
        """
        fit = Fit.to(size, self.board.config, self.chosen.window, label)
        if fit.scaled:
            notes.print(fit.note())
        return fit

    def measurer(self, size: tuple[int, int], sigma: float | None = None) -> Measurer:
        """A measurer for pictures of a size, by default with the chosen sigma."""
        return Measurer(self.board, size, self.chosen.sigma if sigma is None else sigma)

    def frames(self) -> Iterator[Frame]:
        """The source's frames from the first, without a progress line."""
        return chain([self.first], self._frames)

    def frames_again(self) -> Iterator[Frame]:
        """The source's frames once more, if it is not live."""
        return timed(self.source, self.source.label, self._rate)

    def steps(self, what: str, items: Iterable[T], total: int | None) -> Iterator[T]:
        """The items, with a progress line until the last; `tell` advances it."""
        self._tell = self._bar.enter_context(progress(what, total))
        self._began, self._took = time.monotonic(), 0.0
        yield from items
        self._took = time.monotonic() - self._began
        self._bar.close()

    def tell(self, state: str) -> None:
        """Count a finished frame; the progress line shows `state`."""
        self.done += 1
        if self.done == 1 and self.report == self.report_folder:
            import signum.report.folder  # noqa: F401  # now, as a command that is stopped has little time
        self._tell(state)

    def table(self, name: str, columns: Sequence[str]) -> Table:
        """A table in the folder, closed on leaving."""
        table = Table(self.file(name), columns)
        self.at_end(table.close)
        return table

    def open(self, context: AbstractContextManager[T]) -> T:
        """Enter a context that is left with the session."""
        return self._opened.enter_context(context)

    def at_end(self, call: Callable[[], object]) -> None:
        """Call something on leaving, before the report is written; the last added is called first."""
        self._opened.callback(call)

    def report_folder(self) -> None:
        """Write `report.html` from the tables and pictures in the folder."""
        from signum.report.folder import write_report  # plots take seconds to load

        write_report(self.folder, self.about())

    def about(self) -> About:
        """What the run is so far, for the head of its report."""
        from signum.report.about import About  # loads plots

        date = datetime.now().astimezone().isoformat(" ", "minutes")
        return About(self.command, VERSION, self.name, GIVEN.get(), date, self.done,
                     self._took or time.monotonic() - self._began, self.board.name, self.board.clocks,
                     self.board.name != "verilated", dict(self.refused.most_common()), self.result())


def kind_of(reason: str) -> str:
    """A reason without its figures, to count it by."""
    return re.sub(r"[\d.]*\d", "n", reason)


@contextmanager
def board_of(name: BoardName, window: int = 8, config: Config = FULL) -> Iterator[Board]:
    """The board of a build, opened and closed again.

    Raises:
        SignumError: if it takes no windows of this size.
    """
    if name == "verilated":
        notes.print("board: Verilated RTL (built once, on first use)")
    with open_board(name, config) as board:
        if not config.array and window not in config.dense_windows:
            sides = ", ".join(map(str, sorted(config.dense_windows)))
            raise SignumError(f"--window {window}: with --dense choose one of {sides}")
        if not board.config.min_window <= window <= board.config.max_window:
            raise SignumError(f"--window {window}: choose {board.config.min_window} to {board.config.max_window}")
        yield board


def clocks_line(board: Board, frames: int) -> str:
    """What the board did, in a line; `frames` is 1 or more."""
    kind = "" if board.name == "verilated" else " (estimated)"
    per = board.clocks / frames
    return f"board: {board.clocks:,} clocks{kind}, {1e3 * per / CLOCK_HZ:.2f} ms a frame at {CLOCK_HZ / 1e6:.0f} MHz"
