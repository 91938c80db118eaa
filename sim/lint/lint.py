# SPDX-License-Identifier: Apache-2.0
"""Lints the RTL: Verilator on the whole board in every configuration and on every module by itself, Verible on style.

The whole boards are read by their lists, `rtl/<config>.f`, from another folder. `python -m sim.lint` prints the
complaints of each tool, and the lists that are stale, and fails if there are any.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from golden.params import CONFIGS
from sim.building import UNROLL, VERILATOR_ARGS
from sim.lint.lists import SIGNS, stale
from sim.lint.spdx import missing
from sim.toolchain import (
    DENSE_TOP,
    ROOT,
    RTL,
    TESTBENCHES,
    TOP,
    ecp5_sources,
    rtl_sources,
    sources_of,
    top_of,
    verilator_env,
    wide_sources,
)

RULES = Path(__file__).with_name("verible.rules")
WAIVED = Path(__file__).with_name("verible.waive")


def _complaints(command: list[str], folder: Path = ROOT) -> str:
    """Output of a failing `command`, run in `folder`; empty when it passes."""
    done = subprocess.run(command, env=verilator_env(), cwd=folder, capture_output=True, text=True, check=False)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if not line.startswith("- ")]
    return "\n".join(lines) if done.returncode else ""


def verilator(top: str, sources: list[Path]) -> str:
    """Complaints of Verilator about `top` and what it instantiates."""
    return _complaints(["verilator", "--lint-only", *VERILATOR_ARGS, "--timing", "--top-module", top,
                        *map(str, sources)])


def listed(config: str) -> str:
    """Complaints of Verilator about the board as `rtl/<config>.f` lists it."""
    return _complaints(["verilator", "--lint-only", "-Wall", "--timing", *UNROLL, "--top-module", top_of(config), "-F",
                        str(RTL / f"{config}.f")], Path(tempfile.gettempdir()))


def verible(sources: list[Path]) -> str:
    """Complaints of Verible about the style of `sources`."""
    tool = Path(sys.executable).parent / "verible-verilog-lint"
    return _complaints([str(tool), f"--rules_config={RULES}", f"--waiver_files={WAIVED}", *map(str, sources)])


def main() -> int:
    """Run every linter; returns the exit status."""
    found = [f"stale: {path.relative_to(ROOT)}; run `make regs`" for path in stale()]
    found += [f"{path.relative_to(ROOT)}: no SPDX line; run `python -m sim.lint.spdx --write`" for path in missing()]
    found += [listed(config) for config in CONFIGS]
    found.append(verilator(SIGNS, sources_of(SIGNS)))
    for path in rtl_sources("full"):
        if not path.stem.endswith("_pkg") and path.stem not in (TOP, DENSE_TOP):
            found.append(verilator(path.stem, rtl_sources("full")))
    for path in wide_sources():
        if not path.stem.endswith("_pkg"):
            found.append(verilator(path.stem, sources_of(path.stem)))
    for top in ("slog_ram", "slog_mult"):
        found.append(verilator(top, ecp5_sources("full")))
    generated = RTL / "gen"
    written = [path for folder in (RTL, TESTBENCHES) for path in sorted(folder.rglob("*.sv"))
               if generated not in path.parents]
    found.append(verible(written))
    complaints = [text for text in found if text]
    print("\n".join(complaints) or f"RTL lint: {len(written)} files clean")
    return bool(complaints)
