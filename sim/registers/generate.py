# SPDX-License-Identifier: Apache-2.0
"""Generates everything that contains register addresses from the maps `rtl/control/slog_*csr.rdl`.

`python -m sim.registers` writes the RTL (`rtl/gen`), the C headers and the PyRAL access layers (`sim/registers/gen`),
and the HTML pages (`out/regs`, not committed); `--check` writes nothing and fails when a committed file is stale.
"""

from __future__ import annotations

import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

from sim.lint.spdx import without
from sim.registers.exporter import export
from sim.toolchain import ROOT, RTL

MAPS = "slog_csr", "slog_dense_csr"
"""The board's registers, and those that boards with a dense engine have besides; no address is in both."""
SOURCES = {name: RTL / "control" / f"{name}.rdl" for name in MAPS}
GENERATED = Path(__file__).with_name("gen")
PAGES = ROOT / "out" / "regs"
COMMITTED = {f"{name}{ending}": folder for name in MAPS for ending, folder in (
    (".sv", RTL / "gen"), ("_pkg.sv", RTL / "gen"), (".h", GENERATED), (".py", GENERATED), ("_stubs.pyi", GENERATED),
    (".db", GENERATED))}
"""Committed outputs and their folders."""


def _peakrdl(*args: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "peakrdl", *map(str, args)], check=True)


def generate(folder: Path) -> None:
    """Write every committed output into `folder`."""
    for name, source in SOURCES.items():
        export(source, folder)
        _peakrdl("c-header", source, "-o", folder / f"{name}.h")
        _peakrdl("pyral", source, "-o", folder)


def pages(folder: Path) -> None:
    """Write an HTML page of each map, by its name, into `folder`."""
    for name, source in SOURCES.items():
        _peakrdl("html", source, "-o", folder / name, "--title", "Signum registers")


def _content(path: Path) -> object:
    """The content in which two generated files must agree; a database's bytes depend on the library that wrote it."""
    if not path.exists():
        return None
    if path.suffix == ".db":
        base = sqlite3.connect(path)
        try:
            return list(base.iterdump())
        finally:
            base.close()
    return without(path.read_text())


def main(argv: list[str]) -> int:
    """Write the outputs, or with `--check` compare them; returns the exit status."""
    with tempfile.TemporaryDirectory() as name:
        made = Path(name)
        generate(made)
        stale = [target / file for file, target in COMMITTED.items()
                 if _content(made / file) != _content(target / file)]
        if "--check" in argv:
            if stale:
                print(f"stale: {', '.join(str(p.relative_to(ROOT)) for p in stale)}; run `make regs`", file=sys.stderr)
            return bool(stale)
        for path in stale:
            path.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(made / path.name, path)
    shutil.rmtree(PAGES, ignore_errors=True)
    pages(PAGES)
    return 0
