# SPDX-License-Identifier: Apache-2.0
"""Runs the tools of the flow, which come from Python wheels and run in a sandbox."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from sim.building import tail
from sim.toolchain import ROOT


def seen(path: Path) -> str:
    """`path` for a tool: the tools run in the project's root, in a sandbox that has its own /tmp."""
    return str(path.relative_to(ROOT))


def run_tool(name: str, log: Path, *args: str | Path, rounds: int | None = None) -> bool:
    """Run a tool, its output in `log`; False if it was stopped because it reported more than `rounds` of routing."""
    tool = Path(sys.executable).parent / name
    words = [seen(a) if isinstance(a, Path) else a for a in args]
    with log.open("w") as out, subprocess.Popen([str(tool), *words], cwd=ROOT, stdout=out,
                                                stderr=subprocess.STDOUT) as process:
        while rounds is not None and process.poll() is None:
            time.sleep(1)
            if log.read_text().count(" iter=") > rounds:
                process.kill()
                return False
    if process.returncode:
        raise SystemExit(f"{name} failed with status {process.returncode}; {log} ends:\n{tail(log, 15)}")
    return True
