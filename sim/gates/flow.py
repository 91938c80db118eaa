# SPDX-License-Identifier: Apache-2.0
"""Runs the modules' own tests on netlists, then the board's: `python -m sim.gates [--jobs N] [NAME ...]`.

It prints a line when an item begins and ends, then a table, and writes `out/gates/report.json`. An item's whole output
is in `out/gates/NAME.log`. The exit status is 1 if an item fails.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

from sim.building import tail
from sim.gates.items import ITEMS, GateItem
from sim.toolchain import ROOT

OUT = ROOT / "out" / "gates"
LOG_LINES = 30
"""The end of an item's output that its failure shows."""


@dataclass(frozen=True)
class GateOutcome:
    """Result of an item.

    Attributes:
        name: of the item.
        passed: whether every test passed, and one ran.
        netlists: number of netlists that were simulated.
        cells: of the largest of them.
        tests: cocotb tests that ran, over all netlists.
        seconds: of synthesis, build and simulation; short where the netlist was kept from an earlier run.
        reason: why it did not pass.
    """

    name: str
    passed: bool
    netlists: int
    cells: int
    tests: int
    seconds: float
    reason: str = ""


def command(item: GateItem) -> list[str]:
    """The call of pytest, or of the bench in Icarus, that an item is."""
    if item.netlist != "synthesised":
        return [sys.executable, "-m", "sim.gates.icarus", *(["--routed"] if item.netlist == "routed" else [])]
    path = f"cocotb_tests/{item.file}"
    return [sys.executable, "-m", "pytest", "-s", "-q", "-p", "no:cacheprovider",
            *([f"{path}::{test}" for test in item.tests] or [path])]


def outcome(name: str, log: str, status: int, seconds: float) -> GateOutcome:
    """What an item's output says.

    Args:
        name: of the item.
        log: its output.
        status: its exit status.
        seconds: that it took.
    """
    cells = [int(count) for count in re.findall(r"^\.?gates: (\d+) cells", log, re.MULTILINE)]
    runs = [Path(path) for path in re.findall(r"log (\S+)/run\.log", log)]
    tests = log.count("\nPASS: ") + sum(len(ET.parse(run / "results.xml").findall(".//testcase")) for run in runs
                if (run / "results.xml").exists())
    skipped = re.search(r"\d+ skipped", log)
    reason = (f"pytest ended with status {status}" if status else "a test was skipped" if skipped
              else "" if cells and tests else "no netlist was simulated")
    return GateOutcome(name, not reason, len(cells), max(cells, default=0), tests, round(seconds, 1), reason)


def run(item: GateItem) -> GateOutcome:
    """Run the tests of one item on netlists."""
    print(f"begun   {item.name}", flush=True)
    begun = time.monotonic()
    log = OUT / f"{item.name}.log"
    with log.open("w") as out:
        done = subprocess.run(command(item), cwd=ROOT, env={**os.environ, "SIGNUM_GATES": item.netlist}, stdout=out,
                              stderr=subprocess.STDOUT, check=False)
    result = outcome(item.name, log.read_text(), done.returncode, time.monotonic() - begun)
    print(line(result), flush=True)
    if not result.passed:
        print(f"{log} ends:\n{tail(log, LOG_LINES)}", flush=True)
    return result


def line(result: GateOutcome) -> str:
    """One line for the terminal."""
    verdict = "passed" if result.passed else "FAILED"
    return (f"{verdict}  {result.name:14} {result.netlists:2} netlists of up to {result.cells:6} cells, "
            f"{result.tests:3} tests {result.seconds:7.1f} s" + (f"  {result.reason}" if result.reason else ""))


def chosen(names: Iterable[str]) -> list[GateItem]:
    """The items named, or all.

    Raises:
        SystemExit: if a name is unknown.
    """
    by_name = {item.name: item for item in ITEMS}
    wanted = list(names)
    unknown = [name for name in wanted if name not in by_name]
    if unknown:
        raise SystemExit(f"no such item: {', '.join(unknown)}; there are {', '.join(by_name)}")
    return [by_name[name] for name in wanted] or list(ITEMS)


def run_all(items: Sequence[GateItem], jobs: int) -> list[GateOutcome]:
    """Run items, `jobs` at a time; the outcomes are in the items' order."""
    OUT.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(jobs) as workers:
        return list(workers.map(run, items))


def report(outcomes: Sequence[GateOutcome], path: Path) -> None:
    """Print the table and write it to `path`."""
    print("\n" + "\n".join(map(line, outcomes)))
    failed = [each.name for each in outcomes if not each.passed]
    tests = sum(each.tests for each in outcomes)
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} items passed, {tests} tests; {os.path.relpath(path, ROOT)}"
          + (f"; failed: {', '.join(failed)}" if failed else ""))
    path.write_text(json.dumps([asdict(each) for each in outcomes], indent=2) + "\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m sim.gates", description="Tests on netlists of ECP5 cells.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="items to run (default: all)")
    parser.add_argument("--jobs", type=int, default=1, help="items at a time")
    options = parser.parse_args(argv)
    if options.jobs < 1:
        parser.error("--jobs: 1 or more")
    outcomes = run_all(chosen(options.names), options.jobs)
    report(outcomes, OUT / "report.json")
    return int(not all(each.passed for each in outcomes))
