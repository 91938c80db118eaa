# SPDX-License-Identifier: Apache-2.0
"""Runs a command in a forked child with limits of time and memory."""

from __future__ import annotations

import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

WALL_S, PROCESSOR_S = 240, 30
"""Longest time of a case, seconds, by the clock and of the processor: beyond them it hangs."""
MEMORY = 4 << 30
"""Address space that a case may take beside what the parent has, bytes."""
TRACEBACK = 99
"""Exit status of a child whose command raised an error, which includes each use of the catch-all."""


def sketch() -> None:
    """Let plots be drawn small, without layout and without axes, whose labels are most of a command's time; their data
    are drawn all the same."""
    from matplotlib.figure import Figure

    drawn: Any = Figure.savefig

    def small(figure: Figure, target: Any, **options: Any) -> None:
        for axes in figure.axes:
            axes.set_axis_off()
        drawn(figure, target, **options | {"dpi": 20})

    Figure.savefig = small  # type: ignore[method-assign,assignment]
    Figure.tight_layout = lambda *_, **__: None  # type: ignore[method-assign]


@dataclass
class Child:
    """A running command.

    Attributes:
        pid: of its process.
        said: file with its standard output and error.
        started: on the monotonic clock, seconds.
    """

    pid: int
    said: Path
    started: float

    def finished(self, wait: bool = False) -> int | None:
        """The exit status, negative for a signal; None while it runs. A child that runs too long is killed."""
        if time.monotonic() - self.started > WALL_S:
            os.kill(self.pid, signal.SIGKILL)
            wait = True
        pid, status = os.waitpid(self.pid, 0 if wait else os.WNOHANG)
        return os.waitstatus_to_exitcode(status) if pid else None


def start(application: Any, arguments: Sequence[str], folder: Path) -> Child:
    """Fork a child that runs the command in a folder; everything it imports is loaded already."""
    said = folder / "said.txt"
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid:
        return Child(pid, said, time.monotonic())
    status = TRACEBACK
    try:
        with said.open("wb") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115
        os.environ["SIGNUM_RAISE"] = "1"
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_S, PROCESSOR_S + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        try:
            application(list(arguments))
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        sys.stdout.flush()
    except BaseException:
        traceback.print_exc()
        status = TRACEBACK
    finally:
        sys.stderr.flush()
        os._exit(status)
