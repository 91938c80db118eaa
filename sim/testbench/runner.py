"""Builds a module under cocotb once per (sources, parameters) and runs its tests: the only place that does."""

from __future__ import annotations

import fcntl
import hashlib
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

from sim.toolchain import BUILD, ROOT, RTL, WAIVERS, headers, sources_of, verilator_env, wave_format

START = Path(__file__).with_name("start.cpp")
AXI_PORTS = "*_i", "*_o", "s_axil_*"
"""Port names of a module with an AXI4-Lite interface."""
CXX_FLAGS = "-O1 -fPIC -Dmain=slog_simulator_main"
LIBRARY = BUILD / "cocotb" / f"library-{hashlib.sha256(CXX_FLAGS.encode()).hexdigest()[:8]}"
"""The simulator's own object files, which are the same for every module."""


class LeanVerilator(Verilator):
    """The cocotb runner with two changes.

    It leaves out `--public-flat-rw`, which makes every signal public and costs 2-8x in speed: only the ports of the
    top module are made visible (by a generated control file), and a test bench reads ports only. And the simulator is
    a library that runs inside the Python executable, so no libpython is needed (see start.cpp).
    """

    def _set_env_common(self) -> None:
        self.env["GPI_USERS"] = pygpi_entry_point()
        super()._set_env_common()

    def _build_command(self) -> list[list[str]]:
        return [[arg for arg in map(str, command) if arg != "--public-flat-rw"]
                for command in super()._build_command()]

    def _test_command(self) -> list[list[str]]:
        [[simulator, *arguments]] = super()._test_command()
        self.env["LD_PRELOAD"] = str(simulator)
        return [[sys.executable, *map(str, arguments)]]


def _digest(sources: Sequence[Path], parameters: Mapping[str, int], flags: Sequence[str]) -> str:
    h = hashlib.sha256(json.dumps([dict(parameters), list(flags)], sort_keys=True).encode())
    for path in [*sources, *headers(), START]:
        h.update(path.name.encode() + path.read_bytes())
    return h.hexdigest()[:16]


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
        replaced: files that stand in for modules, by module name.

    Returns:
        The build folder (waves are left there with `WAVES=1`).

    Raises:
        AssertionError: if a test fails, or none ran.
    """
    waves = os.environ.get("WAVES") == "1"
    seed = int(os.environ.get("SEED", "1"))
    files = [(replaced or {}).get(path.stem, path) for path in sources_of(top, config, ecp5)]
    params = dict(parameters or {})
    build_args = ["-Wall", "--assert", "--timing", "--x-assign", "unique", "--x-initial", "unique",
                  "--unroll-count", "2048", "-CFLAGS", CXX_FLAGS, "-LDFLAGS", "-shared",
                  f"-I{RTL}", str(START)]
    if waves:
        build_args += [f"--trace-{wave_format()}", "--trace-structs"]
    macros = dict(defines or {})
    build_dir = BUILD / "cocotb" / f"{top}-{_digest(files, params, [*build_args, *ports, json.dumps(macros)])}"
    build_dir.mkdir(parents=True, exist_ok=True)
    visible = build_dir / "ports.vlt"
    visible.write_text("`verilator_config\n" + "".join(
        f'public_flat_rw -module "{top}" -var "{pattern}"\n' for pattern in ports))
    os.environ.update(verilator_env())
    runner = LeanVerilator()
    with (build_dir / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        stamp = build_dir / ".built"
        _reuse_library(build_dir, stamp)
        try:
            runner.build(sources=[WAIVERS, visible, *files], hdl_toplevel=top, parameters=params, defines=macros,
                         build_args=build_args, build_dir=build_dir, waves=False, always=not stamp.exists(),
                         timescale=("1ns", "1ps"), log_file=build_dir / "build.log")
        except (SystemExit, RuntimeError) as error:
            raise AssertionError(f"{top} does not build\n{_tail(build_dir / 'build.log')}") from error
        _keep_library(build_dir)
        stamp.touch()
    run_dir = build_dir / f"run-{test_module.rsplit('.', 1)[-1]}-{seed}-{os.getpid()}"
    run_dir.mkdir(exist_ok=True)
    log = run_dir / "run.log"
    print(f"seed {seed}; log {log}" + (f"; waves {run_dir}" if waves else ""))
    try:
        results = runner.test(
            test_module=test_module, hdl_toplevel=top, build_dir=build_dir, test_dir=run_dir, seed=seed,
            parameters=params, test_filter=testcase, results_xml=str(run_dir / "results.xml"),
            test_args=["--trace-file", str(run_dir / "waves.fst")] if waves else [],
            plusargs=["+verilator+rand+reset+2", f"+verilator+seed+{seed}"],
            extra_env={"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "default", "SLOG_PARAMS": json.dumps(params),
                       **(env or {})},
            log_file=log)
    except (SystemExit, RuntimeError) as error:
        raise AssertionError(f"{test_module} failed (SEED={seed})\n{_tail(log)}") from error
    count, failed = get_results(results)
    assert count, f"{test_module}: no test ran\n{_tail(log)}"
    assert not failed, f"{test_module}: {failed} of {count} tests failed (SEED={seed})\n{_tail(log)}"
    return run_dir


def _tail(log: Path, lines: int = 80) -> str:
    return "\n".join(log.read_text().splitlines()[-lines:]) if log.exists() else "(no log)"


def _reuse_library(build_dir: Path, stamp: Path) -> None:
    """Bring in the simulator's own object files, which are the same for every module."""
    if not stamp.exists():
        for kept in LIBRARY.glob("verilated*"):
            copy = build_dir / kept.name
            shutil.copy(kept, copy)
            # Newer than the makefile to come, on which the object files nominally depend.
            os.utime(copy, (time.time() + 3600,) * 2)


def _keep_library(build_dir: Path) -> None:
    LIBRARY.mkdir(exist_ok=True)
    for made in [*build_dir.glob("verilated*.o"), *build_dir.glob("verilated*.d")]:
        if not (LIBRARY / made.name).exists():
            part = LIBRARY / f".{made.name}.{os.getpid()}"
            shutil.copy(made, part)
            part.rename(LIBRARY / made.name)
