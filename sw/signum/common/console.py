# SPDX-License-Identifier: Apache-2.0
"""The terminal: output, notes to the user, and progress.

Nothing that is printed is read as rich markup or emoji: a path may contain `[/red]` or `:smile:`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from signum.common.checks import printable


class Terminal(Console):
    """A console that prints texts as they are, with control characters and broken UTF-8 as escapes."""

    def __init__(self, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, highlight=False, soft_wrap=True, markup=False, emoji=False)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print; see `rich.console.Console.print`."""
        super().print(*(printable(o) if isinstance(o, str) else o for o in objects), **options)


out = Terminal()
"""Standard output, for what the user asked for."""
notes = Terminal(stderr=True)
"""Standard error, for progress, remarks and errors."""


@contextmanager
def progress(what: str, total: int | None) -> Iterator[Callable[[str], None]]:
    """A progress line; the function it yields is called after each frame with a word on its result.

    `total` is the number of frames; None if it is not known.
    """
    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(),
               TimeElapsedColumn(), TextColumn("{task.fields[state]}", markup=False))
    with Progress(*columns, console=notes) as bar:
        task = bar.add_task(what, total=total, state="")
        yield lambda state: bar.update(task, advance=1, state=printable(state))
