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


ROUND = re.compile(r" iter=\d+ .*\boveruse=(\d+) tmgfail=(\d+)")
"""A round of nextpnr's router in its output: wires that nets share, and late ends of paths."""


def stuck(text: str, patience: int) -> bool:
    """Whether routing no longer improves: no round of the last `patience` was the best so far.

    Args:
        text: nextpnr's output so far. A round is better with fewer shared wires; with as many, with fewer late ends.
        patience: rounds, 1 or more.
    """
    rounds = [(int(shared), int(late)) for shared, late in ROUND.findall(text)]
    return len(rounds) > patience and min(rounds[-patience:]) >= min(rounds[:-patience])


def run_tool(name: str, log: Path, *args: str | Path, patience: int | None = None) -> bool:
    """Run a tool, its output in `log`; False if it was stopped because it was `stuck` for `patience` rounds."""
    tool = installed_tool(name, "synth", "synth")
    words = [seen(a) if isinstance(a, Path) else a for a in args]
    with log.open("w") as out, subprocess.Popen([str(tool), *words], cwd=ROOT, stdout=out,
                                                stderr=subprocess.STDOUT) as process:
        while patience is not None and process.poll() is None:
            time.sleep(1)
            if stuck(log.read_text(), patience):
                process.kill()
                return False
    if process.returncode:
        raise SystemExit(f"{name} failed with status {process.returncode}; {log} ends:\n{tail(log, 15)}")
    return True
