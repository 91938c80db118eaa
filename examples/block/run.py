# SPDX-License-Identifier: Apache-2.0
"""Lints and simulates `my_design` with Verilator and cocotb: `python examples/block/run.py [BUILD_FOLDER]`.

cocotb's own runner needs Python as a shared library (`apt install libpython3-dev`); where there is none, this project's
does without.
"""

import os
import subprocess
import sys
from pathlib import Path

from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner
from find_libpython import find_libpython

from sim.testbench.runner import EMBEDDED_ARGS, EmbeddedVerilator
from sim.toolchain import ROOT, verilator_env

HERE = Path(__file__).resolve().parent
LIST = ["-Wall", "-F", str(HERE / "files.f")]


def main(folder: str = "build/my_design", plain: bool = bool(find_libpython())) -> int:
    """Build in `folder` and run the test; returns the number of tests that failed."""
    os.environ |= verilator_env()  # with a Verilator of your own, MAKEFLAGS and VERILATOR_ROOT are not needed
    subprocess.run(["verilator", "--lint-only", *LIST, "--top-module", "my_design"], check=True)
    build = Path(folder).absolute()
    runner = get_runner("verilator") if plain else EmbeddedVerilator()
    # The runner wants a source to decide what to rebuild by; the list holds them all.
    runner.build(sources=[HERE / "my_design.sv"], hdl_toplevel="my_design", build_dir=build, timescale=("1ns", "1ps"),
                 build_args=["-Wall", "-Wno-fatal", "-F", str(HERE / "files.f"),
                             *([] if plain else EMBEDDED_ARGS)])
    sys.path[:0] = [str(HERE), str(ROOT)]  # the runner hands its own path on to the test
    results = runner.test(test_module="test_my_design", hdl_toplevel="my_design", build_dir=build, test_dir=build)
    return get_results(results)[1]


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
