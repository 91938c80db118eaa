# SPDX-License-Identifier: Apache-2.0
"""`make coverage`: the regression with coverage recorded, held to its bars; out/coverage/index.html."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from sim.building import digest
from sim.coverage import exclusions, functional
from sim.coverage.page import page
from sim.coverage.points import merged
from sim.coverage.record import VARIABLE
from sim.coverage.verdict import BARS, Verdict, judge
from sim.toolchain import ROOT, RTL

OUT = ROOT / "out" / "coverage"
RECORDS = OUT / "records"
TESTS = ("cocotb_tests",)
"""Regressions that are recorded: every test bench."""
WITHOUT = "cocotb_tests/test_bench_detects.py"
"""Runs broken RTL."""
LARGE = "cocotb_tests/frontend/test_fir.py::test_fir[large]", "cocotb_tests/frontend/test_log.py::test_log[64-16]"
"""Filters of radius 16, not recorded: their machine words would be 8 % of the points, a third of which never change."""
SOAK = "--config", "tiny", "--cases", "64", "--seed", "1"
"""Cases of the soak that are counted for the functional plan; the Verilated board has no counters of points."""


def record(jobs: int, only: list[str] | None = None) -> int:
    """Run the regressions, each with its record; returns how many of them failed.

    Args:
        jobs: processes.
        only: test files instead of all regressions; the records of the others stay if they are of the same RTL.
    """
    made_from = digest([], [source for source in sorted(RTL.rglob("*.sv*")) if source.is_file()])
    stamp = RECORDS / "rtl"
    if not only or not stamp.exists() or stamp.read_text() != made_from:
        shutil.rmtree(RECORDS, ignore_errors=True)
        RECORDS.mkdir(parents=True)
        stamp.write_text(made_from)
    for test in only or ():
        shutil.rmtree(RECORDS / Path(test).stem, ignore_errors=True)
    environment = {**os.environ, VARIABLE: str(RECORDS), "PYTHONPATH": os.pathsep.join([str(ROOT / "sw"), str(ROOT)])}
    commands = [[sys.executable, "-m", "pytest", "-q", "-n", str(jobs), "-p", "no:cacheprovider", f"--ignore={WITHOUT}",
                 *(f"--deselect={test}" for test in LARGE), *(only or TESTS)]]
    if not only:
        commands += [[sys.executable, "-m", "tests.soak", "--jobs", str(jobs), *SOAK]]
    return sum(bool(subprocess.run(command, cwd=ROOT, env=environment).returncode) for command in commands)


def report(records: Path = RECORDS, out: Path = OUT) -> Verdict:
    """Merge the records, write the page and its figures into `out`.

    Raises:
        ExclusionError: if the exclusions are not in order.
    """
    hits = merged(sorted(records.rglob("*.dat")), RTL)
    reasons = exclusions.apply(exclusions.load(), hits)
    met, plan = functional.collected(sorted(records.rglob("*.json"))), functional.plan()
    verdict = judge(hits, reasons, met, plan)
    out.mkdir(parents=True, exist_ok=True)
    (out / "index.html").write_text(page(hits, reasons, met, plan, verdict))
    (out / "summary.json").write_text(json.dumps({
        kind: {"hit": verdict.hit[kind], "points": verdict.total[kind], "percent": round(verdict.share(kind), 3),
               "excluded": verdict.excluded[kind]} for kind in BARS}, indent=1) + "\n")
    return verdict


def main(arguments: list[str] | None = None) -> int:
    """Record and report; 1 if a bar is not reached or a test failed."""
    parser = argparse.ArgumentParser(prog="make coverage", description=__doc__)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--report", action="store_true", help="of the last records, without running anything")
    parser.add_argument("--only", nargs="+", help="these test files again; the others' records are kept")
    given = parser.parse_args(arguments)
    failed = 0 if given.report else record(given.jobs, given.only)
    try:
        verdict = report()
    except exclusions.ExclusionError as error:
        print(f"coverage: {error}", file=sys.stderr)
        return 1
    for kind, bar in BARS.items():
        print(f"{kind:10} {verdict.share(kind):6.2f} % of {verdict.total[kind]}, {verdict.excluded[kind]} excluded "
              f"(at least {bar:g} %)")
    for point in verdict.missing[:40]:
        print(f"not hit: {point.file.name}:{point.line}: {point.kind} {point.name}")
    for group, what in verdict.unmet[:40]:
        print(f"not met: {group}: {what}")
    print(*verdict.faults, OUT / "index.html", sep="\n")
    if failed:
        print("tests failed: see above", file=sys.stderr)
    return 1 if failed or verdict.faults else 0


if __name__ == "__main__":
    sys.exit(main())
