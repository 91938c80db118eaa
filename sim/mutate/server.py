# SPDX-License-Identifier: Apache-2.0
"""Runs inside a simulator, before cocotb starts: forks a copy of the process for each mutant.

Starting Python, cocotb and the golden model takes longer than most mutants live. So one process loads everything, and
each mutant is a copy of it, with a number of its own as plusarg, a limit of processor time, and a log of its own.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import time
from pathlib import Path

ENTRIES = ("sim.mutate.server:serve", "cocotb_tools._coverage:start_cocotb_library_coverage",
           "cocotb.logging:_configure", "cocotb._init:init_package_from_simulation",
           "cocotb.regression:_run_regression")
"""What is called in the simulator, in this order; all but the first are cocotb's own."""
VARIABLE = "SIGNUM_MUTANTS"
"""Environment variable that names the file of orders."""
FIRST_SECONDS = 900.0
"""Processor time of the first mutant at most."""
LOG_BYTES = 20_000_000


def orders(numbers: list[int], folder: Path, slower: float, least: float) -> str:
    """The text of a file of orders.

    Args:
        numbers: of the mutants; the first is the measure of the others' time.
        folder: of logs and results, which exists.
        slower: a mutant may take this many times the processor time of the first.
        least: seconds that every mutant may take.
    """
    return json.dumps({"numbers": numbers, "folder": str(folder), "slower": slower, "least": least})


def serve() -> None:
    """Fork and wait for one mutant after another. Returns in the copies only; the process itself ends here."""
    order = json.loads(Path(os.environ[VARIABLE]).read_text())
    folder = Path(order["folder"])
    for module in ("cocotb.regression", "cocotb._init", "numpy", os.environ["COCOTB_TEST_MODULES"]):
        importlib.import_module(module)
    seconds = FIRST_SECONDS
    with (folder / "ends.jsonl").open("w") as ends:
        for number in order["numbers"]:
            begun = time.monotonic()
            child = os.fork()
            if child == 0:
                _become(number, seconds, folder)
                return
            _, status, usage = os.wait4(child, 0)
            if seconds == FIRST_SECONDS:
                seconds = max(order["least"], order["slower"] * (usage.ru_utime + usage.ru_stime))
            ends.write(json.dumps({"number": number, "status": os.waitstatus_to_exitcode(status),
                                   "cpu": usage.ru_utime + usage.ru_stime,
                                   "wall": time.monotonic() - begun}) + "\n")
            ends.flush()
    sys.stdout.flush()
    os._exit(0)


def _become(number: int, seconds: float, folder: Path) -> None:
    """Turn this copy of the process into the simulation of one mutant."""
    log = os.open(folder / f"{number}.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.environ["COCOTB_RESULTS_FILE"] = str(folder / f"{number}.xml")
    limit = int(seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 2))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LOG_BYTES, LOG_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.alarm(60 + 30 * limit)  # a simulation that waits for something is ended too
    ctypes.CDLL(None).slog_add_plusarg(f"+mutant={number}".encode())
