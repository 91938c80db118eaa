# SPDX-License-Identifier: Apache-2.0
"""Compiles the kernel at first use, into the user's cache.

The library's name holds a digest of its sources and of the command, so that several versions lie side by side and one
that is there is complete: it is compiled under another name first. `$XDG_CACHE_HOME/signum/kernel`, by default
`~/.cache/signum/kernel`, holds it.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import platform
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
COMMAND = ("g++", "-std=c++17", "-O3", "-fPIC", "-shared", "-Wall", "-Wextra")
"""Without -march: the library holds code for several processors, and the one at hand is asked when it is loaded."""
PATIENCE_S = 300
"""Longest time that the compiler may take, seconds."""


class KernelError(RuntimeError):
    """The kernel cannot be compiled or loaded; the message is one line."""


def cache() -> Path:
    """Folder of the compiled kernels."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "signum" / "kernel"


def library() -> Path:
    """Path of the compiled kernel, compiled if it is not there; any number of processes may ask at once.

    Raises:
        KernelError: if there is no compiler, it fails, or the cache cannot be written.
    """
    try:
        digest = hashlib.sha256("\0".join((*COMMAND, platform.machine(), platform.libc_ver()[1])).encode())
        for path in sorted(HERE.glob("*.[ch]pp")):
            digest.update(path.name.encode() + path.read_bytes())
        target = cache() / f"kernel-{digest.hexdigest()[:20]}.so"
        if not target.exists():
            _compile(target)
    except (OSError, RuntimeError, subprocess.SubprocessError) as error:
        if isinstance(error, KernelError):
            raise
        raise KernelError(" ".join(str(error).split())) from error
    return target


def _compile(target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    with (target.parent / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if target.exists():  # another process was first
            return
        with tempfile.TemporaryDirectory(dir=target.parent) as folder:
            fresh = Path(folder) / "kernel.so"
            done = subprocess.run([*COMMAND, HERE / "kernel.cpp", "-o", fresh], stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, errors="replace", timeout=PATIENCE_S)
            if done.returncode:
                words = done.stderr.split()
                raise KernelError(f"{COMMAND[0]} fails with status {done.returncode}: {' '.join(words)[:200]}")
            fresh.rename(target)
