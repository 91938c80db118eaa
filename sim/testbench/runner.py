# SPDX-License-Identifier: Apache-2.0
"""Builds a module under cocotb once per (sources, parameters) and runs its tests: the only place that does."""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from cocotb_tools.check_results import get_results
from cocotb_tools.config import pygpi_entry_point
from cocotb_tools.runner import Verilator

from sim.building import UNROLL, VERILATOR_ARGS, digest, locked, tail, trace_args
from sim.coverage.record import COUNTERS, coverage_args, points_file
from sim.seeds import session_seed
from sim.testbench.power_up import ENTRY_POINTS
from sim.toolchain import BUILD, ROOT, headers, sources_of, verilator_env

START = Path(__file__).with_name("start.cpp")
AXI_PORTS = "*_i", "*_o", "s_axil_*"
"""Port names of a module with an AXI4-Lite interface."""
BENCH_CXX_FLAGS = "-O1 -fPIC -Dmain=slog_simulator_main"
LIBRARY = BUILD / "cocotb" / f"library-{digest([BENCH_CXX_FLAGS], [])[:8]}"
"""The simulator's own object files, which are the same for every module."""
EMBEDDED_ARGS = "-CFLAGS", BENCH_CXX_FLAGS, "-LDFLAGS", "-shared", str(START)
"""Verilator's arguments for a simulator that is a library, which an `EmbeddedVerilator` runs."""
BUILD_ARGS = [*VERILATOR_ARGS, *UNROLL, "--assert", "--timing", "--x-assign", "unique", "--x-initial", "unique",
              *EMBEDDED_ARGS]
LOG_LINES = 80
"""The end of a log that an error shows."""


class EmbeddedVerilator(Verilator):
    """The cocotb runner, but the simulator is a library that runs inside the Python executable, so no libpython is
    needed (see start.cpp). Build with EMBEDDED_ARGS."""

    def _set_env_common(self) -> None:
        self.env["GPI_USERS"] = pygpi_entry_point()
        super()._set_env_common()

    def _test_command(self) -> list[list[str]]:
        [[simulator, *arguments]] = super()._test_command()
        self.env["LD_PRELOAD"] = str(simulator)
        return [[sys.executable, *map(str, arguments)]]


class LeanVerilator(EmbeddedVerilator):
    """Leaves out `--public-flat-rw`, which makes every signal public and costs 2-8x in speed: only the ports of the top
    module are made visible (by a generated control file), and a test bench reads ports only."""

    def _build_command(self) -> list[list[str]]:
        return [[arg for arg in map(str, command) if arg != "--public-flat-rw"]
                for command in super()._build_command()]


def simulate(
    top: str,
    test_module: str,
    parameters: Mapping[str, int] | None = None,
    env: Mapping[str, str] | None = None,
    testcase: str | None = None,
    defines: Mapping[str, str] | None = None,
    ports: Sequence[str] = ("*_i", "*_o"),
    config: str = "tiny",
    ecp5: bool = False,
    replaced: Mapping[str, Path] | None = None,
) -> Path:
    """Build `top` from `rtl/files.f` and run every cocotb test of `test_module` on it.

    Args:
        top: module to simulate; its ports are the only signals a test can see.
        test_module: dotted Python module with `@cocotb.test` coroutines.
        parameters: module parameters; the coroutines get them from `cocotb_tests.env.params`.
        env: further environment for the test process.
        testcase: regular expression of the tests to run; all when None.
        defines: preprocessor macros for the RTL.
        ports: name patterns of the top module's ports.
        config: configuration whose package the sources take.
        ecp5: build the twins for the ECP5, on models of its primitives.
        replaced: files to build instead of modules, by module name.

    Returns:
        The folder of the run (waves are left there with `WAVES=1`).

    Raises:
        AssertionError: if the module does not build, a test fails, or none ran.
    """
    params, macros = dict(parameters or {}), dict(defines or {})
    os.environ.update(verilator_env())
    runner = LeanVerilator()
    if os.environ.get("SIGNUM_GATES"):  # the netlist instead of the RTL: see sim.gates
        from sim.gates.netlist import files as gates  # loads the synthesis flow, whose tools not everybody has

        folder = build(runner, top, gates(top, config, params, macros), {}, {}, ports)
    else:
        files = [(replaced or {}).get(path.stem, path) for path in sources_of(top, config, ecp5)]
        folder = build(runner, top, files, params, macros, ports)
    return _run(runner, top, folder, test_module, params, dict(env or {}), testcase)


def _waves() -> bool:
    return os.environ.get("WAVES") == "1"


def build(runner: Verilator, top: str, files: Sequence[Path], params: Mapping[str, int], macros: Mapping[str, str],
           ports: Sequence[str], more_args: Sequence[str] = ()) -> Path:
    """Build the simulator of `top`, if it is not current; returns its folder.

    Args:
        runner: cocotb's runner.
        top: module to simulate.
        files: sources, packages first.
        params: parameters of `top`.
        macros: for the preprocessor.
        ports: name patterns of `top`'s ports.
        more_args: further arguments of Verilator.
    """
    build_args = [*BUILD_ARGS, *more_args, *(trace_args() if _waves() else [])]
    counters = [COUNTERS] if coverage_args() else []
    if counters:  # compiled quickly: the test bench takes longer than the counting
        build_args += [*coverage_args(), "-CFLAGS", "-O0"]
        # START includes the precompiled header too, but has make's option last, not this one: the two must be equal.
        os.environ["MAKEFLAGS"] = f"{verilator_env()['MAKEFLAGS']} OPT_FAST=-O0"
    made_from = digest([json.dumps([dict(params), dict(macros)], sort_keys=True), *build_args, *ports],
                       [*files, *headers(), START, *counters])
    folder = BUILD / "cocotb" / f"{top}-{made_from[:16]}"
    with locked(folder):
        visible, stamp, log = folder / "ports.vlt", folder / ".built", folder / "build.log"
        visible.write_text("`verilator_config\n" + "".join(
            f'public_flat_rw -module "{top}" -var "{pattern}"\n' for pattern in ports))
        _reuse_library(folder, stamp)
        try:
            runner.build(sources=[visible, *files], hdl_toplevel=top, parameters=params, defines=macros,
                         build_args=build_args, build_dir=folder, waves=False, always=not stamp.exists(),
                         timescale=("1ns", "1ps"), log_file=log)
        except (SystemExit, RuntimeError) as error:
            raise AssertionError(f"{top} does not build\n{tail(log, LOG_LINES)}") from error
        _keep_library(folder)
        stamp.touch()
    return folder


def _run(runner: Verilator, top: str, folder: Path, test_module: str, params: Mapping[str, int],
         env: Mapping[str, str], testcase: str | None) -> Path:
    """Run the tests of `test_module` on the simulator in `folder`; returns the folder of the run."""
    waves, seed, points = _waves(), session_seed(), points_file(top)
    run_dir = folder / f"run-{test_module.rsplit('.', 1)[-1]}-{seed}-{os.getpid()}"
    run_dir.mkdir(exist_ok=True)
    log = run_dir / "run.log"
    print(f"SIGNUM_SEED={seed}; log {log}" + (f"; waves {run_dir}" if waves else ""))
    try:
        results = runner.test(
            test_module=test_module, hdl_toplevel=top, build_dir=folder, test_dir=run_dir, seed=seed,
            parameters=params, test_filter=testcase, results_xml=str(run_dir / "results.xml"),
            test_args=["--trace-file", str(run_dir / "waves.fst")] if waves else [],
            # With random power-up values, bits that are constant would be counted as toggling once, in some runs.
            plusargs=[f"+verilator+rand+reset+{0 if points else 2}", f"+verilator+seed+{seed}",
                      *([f"+verilator+coverage+file+{points}"] if points else [])],
            extra_env={"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "default", "SLOG_PARAMS": json.dumps(params),
                       "PYGPI_USERS": ",".join(ENTRY_POINTS), **env},
            log_file=log)
    except (SystemExit, RuntimeError) as error:
        raise AssertionError(f"{test_module} failed (SIGNUM_SEED={seed})\n{tail(log, LOG_LINES)}") from error
    count, failed = get_results(results)
    assert count, f"{test_module}: no test ran\n{tail(log, LOG_LINES)}"
    assert not failed, f"{test_module}: {failed} of {count} tests failed (SIGNUM_SEED={seed})\n{tail(log, LOG_LINES)}"
    return run_dir


def _reuse_library(folder: Path, stamp: Path) -> None:
    """Copy the simulator's own object files into a new build's folder."""
    if not stamp.exists():
        for kept in LIBRARY.glob("verilated*"):
            copy = folder / kept.name
            shutil.copy(kept, copy)
            # Newer than the makefile that the build writes, on which the object files nominally depend.
            os.utime(copy, (time.time() + 3600,) * 2)


def _keep_library(folder: Path) -> None:
    """Keep the simulator's own object files of a finished build."""
    LIBRARY.mkdir(exist_ok=True)
    for made in [*folder.glob("verilated*.o"), *folder.glob("verilated*.d")]:
        if not (LIBRARY / made.name).exists():
            part = LIBRARY / f".{made.name}.{os.getpid()}"
            shutil.copy(made, part)
            part.rename(LIBRARY / made.name)
