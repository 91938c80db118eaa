# SPDX-License-Identifier: Apache-2.0
"""Runs the targets of `signum.core` with FuseSoC: `python -m sim.lint.core [target ...]`, by default all of them."""

from __future__ import annotations

import subprocess
import sys

from sim.toolchain import BUILD, ROOT, verilator_env

NAME = "signum:vision:board"
TARGETS = "lint", "lint_tiny", "lint_dense", "lint_tiny_dense", "sim"


def run(target: str) -> subprocess.CompletedProcess[str]:
    """Run one target in `build/fusesoc/<target>`; the output holds what FuseSoC, Verilator and the simulation print."""
    folder = BUILD / "fusesoc" / target
    folder.parent.mkdir(parents=True, exist_ok=True)
    return subprocess.run([sys.executable, "-m", "fusesoc.main", "--cores-root", ROOT, "run", "--work-root", folder,
                           "--target", target, NAME], env=verilator_env(), cwd=folder.parent, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)


def main(argv: list[str]) -> int:
    """Run targets; returns the exit status."""
    for target in argv or TARGETS:
        done = run(target)
        if done.returncode:
            print(done.stdout)
            return 1
        print(f"signum.core: {target} passes")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
