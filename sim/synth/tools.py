# SPDX-License-Identifier: Apache-2.0
"""Runs the tools of the flow, which come from Python wheels and run in a sandbox."""

from __future__ import annotations

import re
import subprocess
import time
from pathlib import Path

from sim.building import tail
from sim.toolchain import ROOT, installed_tool


def seen(path: Path) -> str:
    """`path` for a tool: the tools run in the project's root, in a sandbox that has its own /tmp."""
    return str(path.relative_to(ROOT))


OPEN = re.compile(r"^Info: +\d+ \|.*\| +(\d+)\| +[\d.]+ +[\d.]+\|$", re.MULTILINE)
"""A report of nextpnr's first router in its output: wires that are still to be routed."""


def stuck(text: str, patience: int) -> bool:
    """Whether routing no longer goes on: none of the last `patience` reports has fewer open wires than those before.

    Args:
        text: nextpnr's output so far.
        patience: reports, 1 or more.
    """
    left = [int(wires) for wires in OPEN.findall(text)]
    return len(left) > patience and min(left[-patience:]) >= min(left[:-patience])


def run_tool(name: str, log: Path, *args: str | Path, patience: int | None = None) -> bool:
    """Run a tool, its output in `log`.

    Args:
        name: of the tool.
        log: file for what it prints.
        args: its arguments; a path within the project becomes what the tool sees.
        patience: reports without progress after which it is stopped as `stuck`, None: never.

    Returns:
        Whether it has done its work: False if it was stopped, or failed and has `patience`, for another one to try.

    Raises:
        SystemExit: if it failed and has no `patience`.
    """
    tool = installed_tool(name, "synth", "synth")
    words = [seen(a) if isinstance(a, Path) else a for a in args]
    with log.open("w") as out, subprocess.Popen([str(tool), *words], cwd=ROOT, stdout=out,
                                                stderr=subprocess.STDOUT) as process:
        try:
            while patience is not None and process.poll() is None:
                time.sleep(1)
                if stuck(log.read_text(errors="replace"), patience) and process.poll() is None:
                    process.kill()
        except BaseException:
            process.kill()
            raise
    if process.returncode and patience is None:
        raise SystemExit(f"{name} failed with status {process.returncode}; {log} ends:\n{tail(log, 15)}")
    return process.returncode == 0
