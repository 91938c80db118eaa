# SPDX-License-Identifier: Apache-2.0
"""Builds the Verilated board as a shared library: `python -m sim.board [--config NAME] [--trace] [--checked]`.

The library lies under `build/verilated/<config>[-trace][-checked]/` with digests of everything that it and its model
were made from; a current build returns at once. A checked build has the RTL's assertions and random power-up states.
The driver alone, without a board, lies in `build/driver/`. For an installed package, `build` is a
folder of the user's cache: see `sim.toolchain`.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from golden.params import CONFIGS
from sim.building import UNROLL, VERILATOR_ARGS, digest, locked, tail, trace_args
from sim.toolchain import (
    BUILD,
    DENSE_TOP,
    ROOT,
    WAIVERS,
    headers,
    rtl_sources,
    top_of,
    verilator_env,
    verilator_root,
    wave_format,
)

HERE = Path(__file__).parent
REGISTERS = HERE.parent / "registers" / "gen" / "slog_csr.h"
VERILATOR_FLAGS = [*VERILATOR_ARGS, *UNROLL, "-O3", "--no-timing", "+define+SLOG_CLOCK_GATE"]
FAST_FLAGS = ["--x-assign", "fast", "--x-initial", "fast", "+define+SYNTHESIS", "-Wno-UNUSEDSIGNAL"]
"""Without assertions, which cost time; some signals then have no reader."""
CHECKED_FLAGS = ["--x-assign", "unique", "--x-initial", "unique", "--assert"]
"""With assertions live, and registers and unknown values from a random seed."""
NATIVE_CXX_FLAGS = ["-march=native", "-fPIC", "-std=gnu++20"]
FAST = {"full": "-O3", "dense": "-O3", "tiny": "-O1", "tiny_dense": "-O1"}
"""For the code that runs every clock, by configuration; runs of the tiny ones are short, so compiling is what takes
time. The rest is compiled quickly."""
MODEL = "Vslog_board"
"""Class and files of the model, whichever the top module."""

TOOLS = "g++", "make", "perl"
"""Programs of the system that a build needs, by the names of their Debian packages, too."""


class BuildError(RuntimeError):
    """A library could not be built; the message holds the end of the log, or one line that names what is missing."""


def _processor() -> str:
    """What `-march=native` depends on."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    return next((line for line in lines if line.startswith("flags")), platform.machine())


def _digest(files: Sequence[Path], flags: Sequence[str]) -> str:
    return digest([*flags, *map(" ".join, FAST.items()), *NATIVE_CXX_FLAGS, _processor()], files)


def _current(product: Path, made_from: str) -> bool:
    stamp = product.with_suffix(".digest")
    return product.exists() and stamp.exists() and stamp.read_text() == made_from


def _stamp(product: Path, made_from: str) -> None:
    product.with_suffix(".digest").write_text(made_from)


def _check_tools() -> None:
    """Say what is missing before a build, whose own messages would not."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        raise BuildError(f"{', '.join(missing)} not found, which the first use needs to build it: "
                         f"sudo apt-get install {' '.join(missing)} (the golden board needs no build)")


def _run(command: Sequence[str | Path], folder: Path) -> None:
    log = folder / "build.log"
    with log.open("a") as out:
        done = subprocess.run(list(map(str, command)), cwd=folder, stdout=out, stderr=subprocess.STDOUT,
                              env=verilator_env())
    if done.returncode:
        raise BuildError(f"{command[0]} failed; see {log}\n{tail(log)}")


def _verilate(config: str, folder: Path, flags: Sequence[str]) -> str:
    """Build the model of the RTL in `folder`, if it is not current; returns the digest of what it is made from."""
    sources, model = rtl_sources(config), folder / f"lib{MODEL}.a"
    made_from = _digest([*sources, *headers(), WAIVERS], flags)
    if _current(model, made_from):
        return made_from
    _check_tools()
    for old in {*folder.glob("V*"), *folder.glob("*.o"), *folder.glob("*.a")}:
        old.unlink()
    _run([verilator_root() / "bin" / "verilator", "--cc", *flags, "--top-module", top_of(config), "--prefix",
          MODEL, "--Mdir", folder, "-CFLAGS", " ".join(NATIVE_CXX_FLAGS), *sources], folder)
    _run(["make", f"-j{os.cpu_count() or 1}", "-f", f"{MODEL}.mk", f"lib{MODEL}", f"OPT_FAST={FAST[config]}",
          "OPT_SLOW=-O0", f"OPT_GLOBAL={FAST[config]}"], folder)
    _stamp(model, made_from)
    return made_from


def _link(library: Path, sources: Sequence[Path], flags: Sequence[str | Path], made_from: str) -> None:
    """Compile `sources` into a shared library."""
    _check_tools()
    fresh = library.with_suffix(".new")
    _run(["g++", "-O3", *NATIVE_CXX_FLAGS, "-shared", f"-I{REGISTERS.parent}", *sources, *flags, "-o", fresh],
         library.parent)
    fresh.rename(library)
    _stamp(library, made_from)


def build(config: str = "full", trace: bool = False, checked: bool = False) -> Path:
    """Path of the shared library of the board, built if it is not current.

    Args:
        config: a name of `golden.params.CONFIGS`.
        trace: with wave dump: slower; FST, or VCD where FST's libraries are missing.
        checked: with the RTL's assertions live and random power-up states: slower.

    Raises:
        BuildError: if a tool is missing or fails.
        KeyError: for an unknown configuration.
    """
    CONFIGS[config]
    fst = trace and wave_format() == "fst"
    folder = BUILD / "verilated" / (config + "-trace" * trace + "-checked" * checked)
    flags = [*VERILATOR_FLAGS, *(CHECKED_FLAGS if checked else FAST_FLAGS), *(trace_args() if trace else [])]
    library = folder / "libslog_board.so"
    with locked(folder):
        (folder / "build.log").unlink(missing_ok=True)
        model = _verilate(config, folder, flags)
        made_from = _digest([*sorted(HERE.glob("*.[ch]pp")), REGISTERS], [model])
        if not _current(library, made_from):
            include = verilator_root() / "include"
            _link(library, [HERE / "api.cpp", HERE / "driver_api.cpp"],
                  [f"-DVM_TRACE={int(trace)}", f"-DVM_TRACE_FST={int(fst)}", f"-DSLOG_CHECKED={int(checked)}",
                   f"-DSLOG_DENSE={int(top_of(config) == DENSE_TOP)}",
                   f"-I{folder}", f"-I{include}",
                   f"-I{include / 'vltstd'}", f"lib{MODEL}.a", "libverilated.a", "-pthread",
                   *(["-lz", "-llz4"] if fst else [])], made_from)
    return library


def build_driver() -> Path:
    """Path of the shared library of the register driver on callbacks, built if it is not current.

    Raises:
        BuildError: if the compiler fails.
    """
    library = BUILD / "driver" / "libslog_driver.so"
    made_from = _digest([*sorted(HERE.glob("*.[ch]pp")), REGISTERS], [])
    with locked(library.parent):
        if not _current(library, made_from):
            (library.parent / "build.log").unlink(missing_ok=True)
            _link(library, [HERE / "callbacks.cpp", HERE / "driver_api.cpp"], ["-Wall", "-Wextra", "-Werror"],
                  made_from)
    return library


def main() -> int:
    """Command line; returns the exit status."""
    parser = argparse.ArgumentParser(description="Build the Verilated board.")
    parser.add_argument("--config", choices=sorted(CONFIGS), default="full")
    parser.add_argument("--trace", action="store_true", help="with wave dump; slower")
    parser.add_argument("--checked", action="store_true", help="with assertions and random power-up states; slower")
    args = parser.parse_args()
    try:
        product = build(args.config, args.trace, args.checked)
        print(product.relative_to(ROOT) if product.is_relative_to(ROOT) else product)
    except BuildError as error:
        print(error, file=sys.stderr)
        return 1
    return 0
