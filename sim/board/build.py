"""Builds the Verilated board as a shared library: `python -m sim.board [--config full|tiny] [--trace]`.

The library lies under `build/verilated/<config>[-trace]/` with the digest of everything it was made from; a current
build returns at once.
"""

from __future__ import annotations

import argparse
import fcntl
import hashlib
import os
import platform
import subprocess
import sys
from pathlib import Path

from golden.params import CONFIGS
from sim.toolchain import (
    BUILD,
    ROOT,
    RTL,
    TOP,
    WAIVERS,
    headers,
    rtl_sources,
    verilator_env,
    verilator_root,
    wave_format,
)

HARNESS = Path(__file__).with_name("api.cpp")
HEADER = ROOT / "sim" / "registers" / "gen" / "slog_csr.h"
VERILATOR_FLAGS = ["-Wall", "-O3", "--unroll-count", "2048", "--no-timing",
                   "--x-assign", "fast", "--x-initial", "fast",
                   # Assertions are for the cocotb builds, here they would cost time; some signals feed nothing else.
                   "+define+SYNTHESIS", "-Wno-UNUSEDSIGNAL", "+define+SLOG_CLOCK_GATE"]
CXX_FLAGS = ["-march=native", "-fPIC", "-std=gnu++20"]
FAST = "-O3"
"""For the code that runs every clock; the rest is compiled quickly."""


class BuildError(RuntimeError):
    """The board could not be built; the message holds the end of the log."""


def _digest(sources: list[Path], flags: list[str]) -> str:
    h = hashlib.sha256(" ".join([*flags, FAST, *CXX_FLAGS, _processor()]).encode())
    for path in [*sources, *headers(), HARNESS, HEADER, WAIVERS]:
        h.update(path.name.encode() + path.read_bytes())
    return h.hexdigest()


def _processor() -> str:
    """What `-march=native` depends on."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    return next((line for line in lines if line.startswith("flags")), platform.machine())


def _run(command: list[str], folder: Path, log: Path) -> None:
    with log.open("a") as out:
        done = subprocess.run(command, cwd=folder, stdout=out, stderr=subprocess.STDOUT, env=verilator_env())
    if done.returncode:
        tail = "\n".join(log.read_text().splitlines()[-40:])
        raise BuildError(f"{command[0]} failed; see {log}\n{tail}")


def build(config: str = "full", trace: bool = False) -> Path:
    """Path of the shared library of the board, built if it is not current.

    Args:
        config: a name of `golden.params.CONFIGS`.
        trace: with wave dump: slower; FST, or VCD where FST's libraries are missing.

    Raises:
        BuildError: if a tool fails.
        KeyError: for an unknown configuration.
    """
    CONFIGS[config]
    sources = rtl_sources(config)
    flags = [*VERILATOR_FLAGS, *([f"--trace-{wave_format()}", "--trace-structs"] if trace else [])]
    folder = BUILD / "verilated" / (config + ("-trace" if trace else ""))
    library, stamp, log = folder / "libslog_board.so", folder / "digest", folder / "build.log"
    digest = _digest(sources, flags)
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if library.exists() and stamp.exists() and stamp.read_text() == digest:
            return library
        stamp.unlink(missing_ok=True)
        log.unlink(missing_ok=True)
        for old in [*folder.glob("V*"), *folder.glob("*.o")]:
            old.unlink(missing_ok=True)  # an object file matches both patterns
        tool = str(verilator_root() / "bin" / "verilator")
        _run([tool, "--cc", *flags, "--top-module", TOP, "--prefix", f"V{TOP}", "--Mdir", str(folder),
              "-CFLAGS", " ".join(CXX_FLAGS), f"-I{RTL}", str(WAIVERS), *map(str, sources)], folder, log)
        _run(["make", f"-j{os.cpu_count() or 1}", "-f", f"V{TOP}.mk", f"libV{TOP}", f"OPT_FAST={FAST}", "OPT_SLOW=-O0",
              f"OPT_GLOBAL={FAST}"], folder, log)
        include = verilator_root() / "include"
        defines = [f"-DVM_TRACE={int(trace)}", f"-DVM_TRACE_FST={int(trace and wave_format() == 'fst')}"]
        fresh = folder / "libslog_board.new"
        _run(["g++", FAST, *CXX_FLAGS, *defines, "-shared", f"-I{folder}", f"-I{include}", f"-I{include / 'vltstd'}",
              f"-I{HEADER.parent}", str(HARNESS), f"libV{TOP}.a", "libverilated.a", "-o", str(fresh), "-pthread",
              *(["-lz", "-llz4"] if trace and wave_format() == "fst" else [])], folder, log)
        fresh.rename(library)
        stamp.write_text(digest)
    return library


def main() -> int:
    """Command line; returns the exit status."""
    parser = argparse.ArgumentParser(description="Build the Verilated board.")
    parser.add_argument("--config", choices=sorted(CONFIGS), default="full")
    parser.add_argument("--trace", action="store_true", help="with wave dump; slower")
    args = parser.parse_args()
    try:
        print(build(args.config, args.trace).relative_to(ROOT))
    except BuildError as error:
        print(error, file=sys.stderr)
        return 1
    return 0
