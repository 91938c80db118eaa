# SPDX-License-Identifier: Apache-2.0
"""Which files are the project's: those that git keeps or would keep; without git, those that `.gitignore` leaves."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

from sim.toolchain import ROOT


def project_files() -> list[Path]:
    """The project's files, sorted, as git lists them where it is installed and the tree is a clone."""
    try:
        listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                                check=True, capture_output=True, text=True).stdout.split("\0")
    except (FileNotFoundError, subprocess.CalledProcessError):
        return walked_files()
    return sorted(path for name in filter(None, listed) if (path := ROOT / name).is_file())


def walked_files() -> list[Path]:
    """The same without git: all files but those in folders that `.gitignore` names, which names nothing else."""
    ignored = [".git", *(line.rstrip("/") for line in (ROOT / ".gitignore").read_text().split())]
    return sorted(_walk(ROOT, ignored))


def _walk(top: Path, ignored: list[str]) -> Iterator[Path]:
    for folder, folders, names in os.walk(top):
        folders[:] = [name for name in folders if not any(fnmatch(name, pattern) for pattern in ignored)]
        yield from (Path(folder) / name for name in names)
