# SPDX-License-Identifier: Apache-2.0
"""Runs a module's tests against its mutants and remembers the outcomes.

All listed mutants of a module go into one build for each simulation of its tests. An outcome is kept in
`build/mutate/` under a digest of everything that it depends on, so a second run repeats only what has changed.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from sim.building import digest, tail
from sim.mutate import plan, server
from sim.mutate.calls import Call, dictionary, python_files
from sim.mutate.sites import Mutant
from sim.mutate.source import PACKAGE, mutated
from sim.testbench.runner import LeanVerilator, build
from sim.toolchain import BUILD, ROOT, headers, sources_of, verilator_env

FOLDER = BUILD / "mutate"
PLUSARG = Path(__file__).with_name("plusarg.cpp")
SEED = 1
"""Of the tests. A mutant's outcome must not depend on the run, so it is not the run's seed."""
SLOWER = 6.0
"""A simulation that takes this many times as long as the unchanged module's is killed."""
LEAST_SECONDS = 4.0
OPTIMISE = "OPT_FAST=-O0 OPT_SLOW=-O0"
"""For make: a build serves a few seconds of simulation, most of them in Python, so compiling it fast is worth more."""
FLAGS = ("-Wno-fatal", "-Wno-lint", "-Wno-style", "-Wno-ENUMVALUE")
"""Mutants may be what lint forbids."""


@dataclass(frozen=True)
class Fate:
    """What one simulation said of one mutant.

    Attributes:
        mutant: its name.
        call: the simulation.
        killed: whether a test failed.
        how: `test`, `assertion`, `time` or `crash`; empty if it survived.
        why: the first message.
        cpu: processor time, seconds.
    """

    mutant: str
    call: str
    killed: bool
    how: str
    why: str
    cpu: float


class Broken(Exception):
    """The flow itself failed: a build, or the tests of the unchanged module."""


def key_of(call: Call) -> str:
    """Digest of a simulation: its arguments, the RTL, and all Python that it imports."""
    files = [*sources_of(call.top, call.config, call.ecp5), *headers(), *python_files(call.test_module)]
    return digest([json.dumps(dictionary(call), sort_keys=True), str(SEED)], files)[:16]


class KnownFates:
    """Outcomes of a module, one line each, by mutant and digest of the simulation.

    Args:
        module: whose outcomes these are.
    """

    def __init__(self, module: str) -> None:
        self.path = FOLDER / "outcomes" / f"{module.replace('/', '-')}.jsonl"
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.known: dict[tuple[str, str], Fate] = {}
        if self.path.exists():
            for text in self.path.read_text().splitlines():
                with suppress(ValueError, KeyError, TypeError):  # a line that was cut short
                    line = json.loads(text)
                    outcome = Fate(**line["outcome"])
                    self.known[outcome.mutant, line["key"]] = outcome

    def add(self, key: str, outcome: Fate) -> None:
        """Keep an outcome."""
        self.known[outcome.mutant, key] = outcome
        with self.path.open("a") as lines:
            lines.write(json.dumps({"key": key, "outcome": asdict(outcome)}) + "\n")


def run_module(module: str, wanted: Sequence[Mutant], calls: Sequence[Call],
               tell: Callable[[str], None]) -> dict[str, Fate]:
    """The last outcome of each wanted mutant: the one that killed it, or a survival of all simulations.

    Args:
        module: of `plan.TESTS`.
        wanted: mutants of its list.
        calls: simulations of the module's tests.
        tell: progress, a line.

    Raises:
        Broken: if a build fails, or the tests fail at mutant 0.
    """
    journal, listed = KnownFates(module), plan.listed(module)
    alive, last = list(wanted), {}
    for call in _fitting(module, calls):
        key = key_of(call)
        todo = [mutant for mutant in alive if (mutant.name, key) not in journal.known]
        before = _children()
        if todo:
            for outcome in _simulate(module, listed, todo, call):
                journal.add(key, outcome)
        for mutant in alive:
            last[mutant.name] = journal.known[mutant.name, key]
        alive = [mutant for mutant in alive if not last[mutant.name].killed]
        mutants = sum(journal.known[mutant.name, key].cpu for mutant in todo)
        tell(f"{module:24} {call.name:44} {len(todo):3} run, {len(alive):3} of {len(wanted):2} alive; "
             f"{mutants:4.0f} s, and {_children() - before - mutants:3.0f} s to build and start")
        if not alive:
            break
    return last


def _children() -> float:
    """Processor time of all processes that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _fitting(module: str, calls: Sequence[Call]) -> list[Call]:
    """The simulations that contain the module."""
    path = plan.path_of(module)
    fitting = [call for call in calls if path in sources_of(call.top, call.config, call.ecp5)]
    if not fitting:
        raise Broken(f"{module}: its tests do not contain it")
    return fitting


def _simulate(module: str, listed: Sequence[Mutant], todo: Sequence[Mutant], call: Call) -> list[Fate]:
    """Run mutants on one simulation, after mutant 0."""
    numbers = {mutant.name: n for n, mutant in enumerate(listed, 1)}
    runner = LeanVerilator()
    folder = build_mutants(runner, module, listed, call)
    work = folder / f"mutants-{os.getpid()}"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    ends = run_numbers(runner, folder, work, call, [0, *(numbers[mutant.name] for mutant in todo)])
    if 0 not in ends or ends[0].killed:
        raise Broken(f"{module}: {call.name} fails without a mutant\n{tail(work / '0.log')}{tail(work / 'run.log')}")
    missing = [mutant.name for mutant in todo if numbers[mutant.name] not in ends]
    if missing:
        raise Broken(f"{module}: {call.name} ended before {', '.join(missing)}\n{tail(work / 'run.log')}")
    outcomes = [Fate(mutant.name, call.name, end.killed, end.how, end.why, end.cpu)
                for mutant in todo for end in [ends[numbers[mutant.name]]]]
    shutil.rmtree(work)
    return outcomes


def build_mutants(runner: LeanVerilator, module: str, listed: Sequence[Mutant], call: Call) -> Path:
    """Build the simulator that holds all `listed` mutants of a module; returns its folder.

    Raises:
        Broken: if it does not build.
    """
    os.environ.update(verilator_env())
    os.environ["MAKEFLAGS"] += " " + OPTIMISE
    original = plan.path_of(module)
    copy = FOLDER / "rtl" / module.replace("/", "-") / original.name
    copy.parent.mkdir(parents=True, exist_ok=True)
    copy.write_text(mutated(original.read_bytes(), listed))
    files = [PACKAGE, *(copy if path == original else path for path in sources_of(call.top, call.config, call.ecp5))]
    version = digest([], [PLUSARG])[:8]
    try:
        return build(runner, call.top, files, call.parameters, call.defines, call.ports,
                     [*FLAGS, f"+define+SLOG_MUTATE_{version}", str(PLUSARG)])
    except AssertionError as error:
        raise Broken(f"{module}: {error}") from error


def run_numbers(runner: LeanVerilator, folder: Path, work: Path, call: Call, numbers: list[int]) -> dict[int, Fate]:
    """Run mutants by their numbers in one process that forks.

    Args:
        runner: that of the build.
        folder: of the build.
        work: folder of logs.
        call: the simulation.
        numbers: of the mutants; the time of the first sets the limit of the others.
    """
    order = work / "orders.json"
    order.write_text(server.orders(numbers, work, SLOWER, LEAST_SECONDS))
    with suppress(SystemExit, RuntimeError):
        runner.test(
            test_module=call.test_module, hdl_toplevel=call.top, build_dir=folder, test_dir=work, seed=SEED,
            parameters=dict(call.parameters), test_filter=call.testcase, results_xml=str(work / "none.xml"),
            plusargs=["+verilator+rand+reset+2", f"+verilator+seed+{SEED}"],
            extra_env={"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "default", "OPENBLAS_NUM_THREADS": "1",
                       "SLOG_PARAMS": json.dumps(dict(call.parameters)), "PYGPI_USERS": ",".join(server.ENTRIES),
                       "COCOTB_MAX_FAILURES": "1",
                       "COCOTB_REWRITE_ASSERTION_FILES": "", "SIGNUM_SEED": str(SEED),
                       server.VARIABLE: str(order), **call.env},
            log_file=work / "run.log")
    ends = {}
    for line in (work / "ends.jsonl").read_text().splitlines() if (work / "ends.jsonl").exists() else []:
        end = json.loads(line)
        ends[end["number"]] = _judge(work, end["number"], end["status"], end["cpu"], call)
    return ends


def _judge(work: Path, number: int, status: int, cpu: float, call: Call) -> Fate:
    """What the exit status, the results and the log of a mutant mean."""
    log = work / f"{number}.log"
    text = log.read_text(errors="replace") if log.exists() else ""
    results = work / f"{number}.xml"
    tests = list(ET.parse(results).iter("testcase")) if results.exists() else []
    bad = [test for test in tests if test.find("failure") is not None or test.find("error") is not None]
    asserted = re.search(r"%Error: (.*)", text)
    how, why = "", ""
    if status in (-24, -14, -9):  # SIGXCPU, SIGALRM, SIGKILL
        how, why = "time", f"stopped after {cpu:.0f} s"
    elif asserted:
        how, why = "assertion", asserted[1].split("/")[-1]
    elif bad:
        first = re.findall(r"^ *((?:\w+\.)*\w*(?:Error|Exception)\b.*)", text, re.MULTILINE)
        how, why = "test", f"{bad[0].get('name')}: {first[0].strip() if first else 'failed'}"
    elif status or not tests:
        how, why = "crash", f"status {status}: {' '.join(text.splitlines()[-1:])}"
    return Fate("", call.name, bool(how), how, why[:300], cpu)
