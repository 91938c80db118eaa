# SPDX-License-Identifier: Apache-2.0
"""Lints and simulates `my_design` with Verilator and cocotb: `python examples/block/run.py [BUILD_FOLDER]`.

cocotb needs Python as a shared library (`apt install libpython3-dev`); everything else `make setup` has installed.
"""

import os
import subprocess
import sys
from pathlib import Path

from cocotb_tools.check_results import get_results
from cocotb_tools.runner import Runner, get_runner

from sim.toolchain import ROOT, verilator_env

HERE = Path(__file__).resolve().parent
LIST = ["-Wall", "-F", str(HERE / "files.f")]


def main(folder: str = "build/my_design", runner: Runner | None = None, extra: tuple[str, ...] = ()) -> int:
    """Build in `folder` and run the test; returns the number of tests that failed."""
    os.environ |= verilator_env()  # with a Verilator of your own, MAKEFLAGS and VERILATOR_ROOT are not needed
    subprocess.run(["verilator", "--lint-only", *LIST, "--top-module", "my_design"], check=True)
    build = Path(folder).absolute()
    runner = runner or get_runner("verilator")
    # The runner wants a source to decide what to rebuild by; the list holds them all.
    runner.build(sources=[HERE / "my_design.sv"], hdl_toplevel="my_design", build_dir=build, timescale=("1ns", "1ps"),
                 build_args=["-Wall", "-Wno-fatal", "-F", str(HERE / "files.f"), *extra])
    sys.path[:0] = [str(HERE), str(ROOT)]  # the runner hands its own path on to the test
    results = runner.test(test_module="test_my_design", hdl_toplevel="my_design", build_dir=build, test_dir=build)
    return get_results(results)[1]


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
