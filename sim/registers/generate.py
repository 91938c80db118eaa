# SPDX-License-Identifier: Apache-2.0
"""Generates everything that contains register addresses from `rtl/control/slog_csr.rdl`.

`python -m sim.registers` writes the RTL (`rtl/gen`), the C header and the PyRAL access layer (`sim/registers/gen`),
and the HTML page (`out/regs`, not committed); `--check` writes nothing and fails when a committed file is stale.
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

SOURCE = RTL / "control" / "slog_csr.rdl"
GENERATED = Path(__file__).with_name("gen")
PAGE = ROOT / "out" / "regs"
COMMITTED = {
    "slog_csr.sv": RTL / "gen",
    "slog_csr_pkg.sv": RTL / "gen",
    "slog_csr.h": GENERATED,
    "slog_csr.py": GENERATED,
    "slog_csr_stubs.pyi": GENERATED,
    "slog_csr.db": GENERATED,
}
"""Committed outputs and their folders."""


def _peakrdl(*args: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "peakrdl", *map(str, args)], check=True)


def generate(folder: Path) -> None:
    """Write every committed output into `folder`."""
    export(SOURCE, folder)
    _peakrdl("c-header", SOURCE, "-o", folder / "slog_csr.h")
    _peakrdl("pyral", SOURCE, "-o", folder)


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
    shutil.rmtree(PAGE, ignore_errors=True)
    _peakrdl("html", SOURCE, "-o", PAGE)
    return 0
