# SPDX-License-Identifier: Apache-2.0
"""`python -m sim.mutate [--sample N] [MODULE ...]`: runs mutants, prints a table, writes `out/mutate/report.json`.

It fails if a mutant survives for which `reasons.toml` has no reason, if a reason names a mutant that does not exist,
or if a mutant with a reason is killed after all.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

from sim.mutate import plan, reasons
from sim.mutate.calls import Call, calls_of
from sim.mutate.run import Broken, Fate, run_module
from sim.mutate.sites import Mutant
from sim.seeds import session_rng, session_seed
from sim.toolchain import ROOT

OUT = ROOT / "out" / "mutate"


def _tell(line: str) -> None:
    print(line, flush=True)


def modules_of(words: Iterable[str]) -> list[str]:
    """Modules by their names with or without `slog_`.

    Raises:
        SystemExit: if there is no such module.
    """
    found = []
    for word in words:
        full = word if "slog_" in word else "/slog_".join(word.split("/")) if "/" in word else f"slog_{word}"
        if full not in plan.TESTS:
            raise SystemExit(f"no module {word}; there are {', '.join(plan.TESTS)}")
        found.append(full)
    return found


def run(chosen: Mapping[str, Sequence[Mutant]], jobs: int) -> tuple[dict[str, Fate], list[str]]:
    """Run mutants, several modules at once.

    Args:
        chosen: mutants to run, by module.
        jobs: modules at once.

    Returns:
        Outcomes by mutant, and what went wrong with the flow itself.
    """
    files = sorted({file for module in chosen for file in plan.TESTS[module]})
    by_file = calls_of(files)
    outcomes, broken = {}, []
    with ProcessPoolExecutor(jobs) as pool:
        waiting = {pool.submit(run_module, module, mutants, _calls(module, by_file), _tell): module
                   for module, mutants in chosen.items()}
        for done in as_completed(waiting):
            try:
                outcomes.update(done.result())
            except Broken as error:
                broken.append(str(error))
                _tell(f"{waiting[done]}: BROKEN: {str(error).splitlines()[0]}")
    return outcomes, broken


def _calls(module: str, by_file: Mapping[str, Sequence[Call]]) -> list[Call]:
    return sorted((call for file in plan.TESTS[module] for call in by_file[file]), key=lambda call: call.size)


def judge(chosen: Mapping[str, Sequence[Mutant]], outcomes: Mapping[str, Fate],
          why: Mapping[str, reasons.Explanation]) -> list[str]:
    """What must be mended: survivors without a reason, and reasons that are wrong."""
    faults = []
    for mutants in chosen.values():
        for mutant in mutants:
            outcome = outcomes.get(mutant.name)
            if outcome and not outcome.killed and mutant.name not in why:
                faults.append(f"survives without a reason: {mutant}")
            elif outcome and outcome.killed and mutant.name in why:
                faults.append(f"was killed, so its reason in {reasons.FILE.name} is wrong: {mutant}")
    return faults


def table(chosen: Mapping[str, Sequence[Mutant]], outcomes: Mapping[str, Fate],
          why: Mapping[str, reasons.Explanation]) -> str:
    """One line per module: mutants, how they were killed, survivors with a reason and without, processor seconds."""
    heads = ("mutants", "test", "assertion", "time", "crash", "proof", "argument", "alive")
    lines = [f"{'module':24}" + "".join(f"{head:>10}" for head in heads) + f"{'cpu s':>8}"]
    total: dict[str, float] = defaultdict(float)
    for module, mutants in chosen.items():
        row: dict[str, float] = defaultdict(float, mutants=len(mutants))
        for mutant in mutants:
            outcome = outcomes.get(mutant.name)
            if outcome:
                row["cpu"] += outcome.cpu
                row[outcome.how if outcome.killed else why[mutant.name].kind if mutant.name in why else "alive"] += 1
        for head, value in row.items():
            total[head] += value
        lines.append(_row(module, heads, row))
    return "\n".join([*lines, _row("all", heads, total)])


def _row(name: str, heads: Sequence[str], row: Mapping[str, float]) -> str:
    return f"{name:24}" + "".join(f"{row.get(head, 0):>10.0f}" for head in heads) + f"{row.get('cpu', 0):>8.0f}"


def write_report(path: Path, chosen: Mapping[str, Sequence[Mutant]], outcomes: Mapping[str, Fate],
                 why: Mapping[str, reasons.Explanation], text: str) -> None:
    """Write the report as JSON, and the table beside it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = [{**asdict(mutant), "outcome": asdict(outcomes[mutant.name]) if mutant.name in outcomes else None,
             "reason": asdict(why[mutant.name]) if mutant.name in why else None}
            for mutants in chosen.values() for mutant in mutants]
    path.write_text(json.dumps({"list_seed": plan.SEED, "mutants": rows}, indent=1) + "\n")
    path.with_suffix(".txt").write_text(text + "\n")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m sim.mutate", description="Run mutants of the RTL.")
    parser.add_argument("modules", nargs="*", metavar="MODULE", help="modules, as fifo or slog_fifo (default: all)")
    parser.add_argument("--sample", type=int, metavar="N", help="only N mutants, chosen by the run's seed")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="modules at once (default: one per core)")
    parser.add_argument("--list", action="store_true", help="print the list of mutants and run nothing")
    return parser.parse_args()


def main() -> int:
    """Run mutants; returns the exit status."""
    options = _arguments()
    begun = time.monotonic()
    wanted = modules_of(options.modules) or list(plan.TESTS)
    why = reasons.load()
    stale = reasons.unknown(why, [mutant.name for module in plan.TESTS for mutant in plan.possible(module)])
    if options.sample:
        chosen = plan.sample(wanted if options.modules else plan.QUICK, options.sample, session_rng("mutants"))
    else:
        chosen = {module: plan.listed(module) for module in wanted}
    count = sum(map(len, chosen.values()))
    _tell(f"{count} mutants of {len(chosen)} modules, of {sum(len(plan.possible(module)) for module in plan.TESTS)} "
          f"possible ones; seed of the list {plan.SEED}"
          + (f", of the sample SIGNUM_SEED={session_seed()}" if options.sample else ""))
    if options.list:
        print(*(mutant for mutants in chosen.values() for mutant in mutants), sep="\n")
        return 0
    outcomes, broken = run(chosen, options.jobs)
    text = table(chosen, outcomes, why)
    write_report(OUT / ("sample.json" if options.sample else "report.json"), chosen, outcomes, why, text)
    faults = [*broken, *(f"a reason for a mutant that does not exist: {name}" for name in stale),
              *judge(chosen, outcomes, why)]
    _tell(text)
    _tell(f"{sum(o.killed for o in outcomes.values())} of {count} killed, {len(faults)} faults, "
          f"{time.monotonic() - begun:.0f} s")
    for fault in faults:
        print(fault, file=sys.stderr)
    return bool(faults)
