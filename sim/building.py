# SPDX-License-Identifier: Apache-2.0
"""What builds share: Verilator's arguments, digests of what a build is made from, locks, and the ends of logs."""

from __future__ import annotations

import fcntl
import hashlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from sim.toolchain import RTL, WAIVERS, wave_format

VERILATOR_ARGS = ("-Wall", f"-I{RTL}", f"-I{RTL / 'gen'}", str(WAIVERS))
"""For lint, cocotb and the Verilated board alike: every warning that is not waived is an error."""
UNROLL = ("--unroll-count", "2048")
"""The longest loops of the RTL are unrolled."""


def trace_args() -> list[str]:
    """Verilator's arguments for wave dumps."""
    return [f"--trace-{wave_format()}", "--trace-structs"]


def digest(words: Sequence[str], files: Iterable[Path]) -> str:
    """Hexadecimal digest of words and of files, by name and content."""
    h = hashlib.sha256("\0".join(words).encode())
    for path in files:
        h.update(path.name.encode() + path.read_bytes())
    return h.hexdigest()


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Create `folder` and keep other processes from building in it."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def tail(log: Path, lines: int = 40) -> str:
    """The last lines of a log."""
    return "\n".join(log.read_text().splitlines()[-lines:]) if log.exists() else "(no log)"
