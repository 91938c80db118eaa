# SPDX-License-Identifier: Apache-2.0
"""Mutants of the frame-level golden model, `golden/*.py`, against `golden/tests`.

`python -m sim.mutate.golden [NAME ...]` runs the sampled mutants, or those named.

mutmut and cosmic-ray do not fit here. mutmut 3 works on a copy of the project, where the tests that compare files in
`rtl/` have nothing to compare, and leaves constants and the bodies of data classes alone, most of `params.py`.
cosmic-ray edits the sources in place, which disturbs whatever else runs in the clone, and starts pytest anew for each
mutant, which takes longer than the tests. Here a process that has loaded everything but `golden` is forked for each
mutant, as for the RTL, and the mutant lives in memory only.
"""

from __future__ import annotations

import ast
import copy
import hashlib
import importlib.abc
import importlib.machinery
import importlib.util
import json
import os
import re
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from sim.building import digest
from sim.mutate import reasons
from sim.toolchain import BUILD, ROOT

COUNT = 200
SEED = 1
TESTS = ("golden/tests/test_params.py", "golden/tests/test_structs.py", "golden/tests/test_coefs.py",
         "golden/tests/test_correlate.py", "golden/tests/test_log.py")
JOURNAL = BUILD / "mutate" / "golden.jsonl"
REPORT = ROOT / "out" / "mutate" / "golden.json"
SECONDS = 120
"""Processor time after which a mutant is killed; the tests take a tenth of it."""
SWAPS: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,),
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Add,), ast.Div: (ast.Mult,), ast.FloorDiv: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,), ast.LShift: (ast.RShift,), ast.RShift: (ast.LShift,), ast.Pow: (ast.Mult,),
    ast.And: (ast.Or,), ast.Or: (ast.And,),
}


@dataclass(frozen=True)
class Change:
    """A mutant: its name, file, line, what was done, and the text of the changed statement or expression."""

    name: str
    path: Path
    line: int
    what: str
    tree: ast.Module

    def __str__(self) -> str:
        return f"{self.name} {self.path.name} line {self.line}: {self.what}"


def _alternatives(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """What may stand in place of a node."""
    if isinstance(node, ast.Compare):
        for n, operator in enumerate(node.ops):
            for other in SWAPS.get(type(operator), ()):
                new = copy.deepcopy(node)
                new.ops[n] = other()  # type: ignore[call-overload]
                yield "comparison", new
    elif isinstance(node, ast.BinOp | ast.BoolOp):
        for other in SWAPS.get(type(node.op), ()):
            changed = copy.deepcopy(node)
            changed.op = other()  # type: ignore[assignment]
            yield "operator", changed
        if isinstance(node, ast.BoolOp):
            yield from (("operand dropped", value) for value in node.values)
    elif isinstance(node, ast.UnaryOp):
        yield "operator dropped", node.operand
    elif isinstance(node, ast.IfExp):
        yield "condition swapped", ast.IfExp(node.test, node.orelse, node.body)
    elif isinstance(node, ast.If):
        changed_if = copy.deepcopy(node)
        changed_if.test = ast.UnaryOp(ast.Not(), node.test)
        yield "condition negated", changed_if
    elif isinstance(node, ast.Constant) and type(node.value) is int:
        yield from (("constant", ast.Constant(node.value + step)) for step in (1, -1))
    elif isinstance(node, ast.Constant) and type(node.value) is float:
        yield "constant", ast.Constant(node.value * 1.25)
    elif isinstance(node, ast.Return) and node.value:
        yield "nothing returned", ast.Return(ast.Constant(None))
    elif isinstance(node, ast.Raise):
        yield "error dropped", ast.Pass()
    elif isinstance(node, ast.Assign | ast.AugAssign) and isinstance(node, ast.AugAssign):
        yield "assignment dropped", ast.Pass()


def changes(path: Path) -> list[Change]:
    """Every mutant of a file; annotations, imports and texts are left alone."""
    tree = ast.parse(path.read_text())
    found, seen = [], set()
    for parent, key, index, node in list(_places(tree)):
        for what, new in _alternatives(node):
            text = f"{ast.unparse(node)} -> {ast.unparse(new)}".replace("\n", " ")
            old = getattr(parent, key)
            setattr(parent, key, new if index is None else [*old[:index], new, *old[index + 1:]])
            changed = copy.deepcopy(tree)
            setattr(parent, key, old)
            whole = ast.unparse(changed)
            if whole in seen:
                continue
            seen.add(whole)
            name = f"golden/{path.stem}-{hashlib.sha256(f'{whole}'.encode()).hexdigest()[:8]}"
            found.append(Change(name, path, getattr(node, "lineno", 0), f"{what}: {text[:150]}",
                                ast.fix_missing_locations(changed)))
    return found


def _places(node: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Parent, field, index in the field, and node of everything that may be changed."""
    for key, value in ast.iter_fields(node):
        if key in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr) or _main_guard(child):
                continue
            yield node, key, index, child
            yield from _places(child)


def _main_guard(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "__main__" in ast.unparse(node.test)


def chosen() -> list[Change]:
    """The sampled mutants, by rank of a digest of seed and name."""
    every = [change for path in sorted((ROOT / "golden").glob("*.py")) for change in changes(path)]
    return sorted(every, key=lambda c: hashlib.sha256(f"{SEED} {c.name}".encode()).hexdigest())[:COUNT]


class _Mutated(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Loads one module from a changed tree."""

    def __init__(self, change: Change) -> None:
        self.change = change
        self.module = f"golden.{change.path.stem}"

    def find_spec(self, fullname: str, path: object, target: object = None) -> importlib.machinery.ModuleSpec | None:
        if fullname != self.module:
            return None
        return importlib.util.spec_from_file_location(fullname, self.change.path, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        exec(compile(self.change.tree, str(self.change.path), "exec"), module.__dict__)


def _run_one(change: Change | None, log: Path) -> tuple[int, float]:
    """Exit status of the tests and processor time, in a fork; `change` None is the model as it is."""
    child = os.fork()
    if child == 0:
        out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        os.dup2(out, 1)
        os.dup2(out, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        if change:
            sys.meta_path.insert(0, _Mutated(change))
        import pytest

        status = pytest.main(["-x", "-q", "-ra", "-p", "no:cacheprovider", "--no-header", "--tb=line",
                              "--assert=plain", *_ordered(change)], plugins=[_NoShrinking()])
        sys.stdout.flush()
        os._exit(int(status))
    _, status, usage = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime


class _NoShrinking:
    """Hypothesis need not look for the smallest example of a failure."""

    def pytest_sessionstart(self) -> None:
        from hypothesis import Phase, settings

        settings.register_profile("mutants", settings.get_profile("signum"), phases=(Phase.explicit, Phase.generate))
        settings.load_profile("mutants")


def _ordered(change: Change | None) -> list[str]:
    """The test files, that of the changed module first: most mutants die there."""
    return sorted(TESTS, key=lambda name: change is None or not name.endswith(f"_{change.path.stem}.py"))


def _preload() -> None:
    """Load what the tests need, but nothing of `golden`."""
    for name in ("pytest", "numpy", "cv2", "scipy.ndimage", "skimage.data", "hypothesis.extra.numpy"):
        importlib.import_module(name)
    loaded = [name for name in sys.modules if name.split(".")[0] == "golden"]
    if loaded:
        raise RuntimeError(f"{', '.join(loaded)} would not be mutated")


def _key(by: str) -> str:
    """Digest of what an outcome depends on: the model, and the test file that killed the mutant, or all of them."""
    tests = [ROOT / name for name in ([by] if by else TESTS)]
    return digest([], [*sorted((ROOT / "golden").glob("*.py")), *tests])[:16]


def run(mutants: Sequence[Change]) -> dict[str, bool]:
    """Whether each mutant was killed. Outcomes are kept under a digest of model and tests.

    Raises:
        RuntimeError: if the tests fail without a mutant.
    """
    known = {}
    if JOURNAL.exists():
        for line in map(json.loads, JOURNAL.read_text().splitlines()):
            if line["key"] == _key(line["by"]):
                known[line["mutant"]] = bool(line["by"])
    todo = [mutant for mutant in mutants if mutant.name not in known]
    if not todo:
        return known
    JOURNAL.parent.mkdir(parents=True, exist_ok=True)
    log = JOURNAL.with_suffix(f".{os.getpid()}.log")
    _preload()
    status, cpu = _run_one(None, log)
    if status:
        raise RuntimeError(f"the golden model's tests fail without a mutant\n{log.read_text()}")
    print(f"{len(todo)} of {len(mutants)} mutants of the golden model to run; its tests take {cpu:.1f} s", flush=True)
    for n, mutant in enumerate(todo, 1):
        status, cpu = _run_one(mutant, log)
        known[mutant.name] = status != 0
        found = re.findall(r"^(?:FAILED|ERROR) (golden/tests/\w+\.py)", log.read_text(), re.MULTILINE)
        by = found[0] if found and status else TESTS[0] if status else ""
        with JOURNAL.open("a") as lines:
            lines.write(json.dumps({"key": _key(by), "mutant": mutant.name, "by": by, "status": status,
                                    "cpu": round(cpu, 2)}) + "\n")
        if status == 0 or n % 20 == 0:
            print(f"{n:4} {'survives: ' + str(mutant) if status == 0 else 'run'}", flush=True)
    log.unlink(missing_ok=True)
    return known


def main(names: Sequence[str]) -> int:
    """Run the mutants; returns the exit status."""
    begun = time.monotonic()
    listed = chosen()
    wanted = [mutant for mutant in listed if not names or mutant.name in names]
    why = reasons.load(reasons.GOLDEN)
    killed = run(wanted)
    alive = [mutant for mutant in wanted if not killed[mutant.name]]
    faults = [f"survives without a reason: {mutant}" for mutant in alive if mutant.name not in why]
    faults += [f"was killed, so its reason is wrong: {mutant}" for mutant in wanted
               if killed[mutant.name] and mutant.name in why]
    faults += [f"a reason for a mutant that is not in the list: {name}"
               for name in reasons.unknown(why, [mutant.name for mutant in listed])]
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text(json.dumps([{"name": m.name, "line": m.line, "what": m.what, "killed": killed[m.name],
                                   "reason": why[m.name].why if m.name in why else None} for m in wanted], indent=1))
    explained = sum(mutant.name in why for mutant in alive)
    print(f"golden model: {len(wanted) - len(alive)} of {len(wanted)} mutants killed, {explained} explained, "
          f"{len(faults)} faults, {time.monotonic() - begun:.0f} s")
    for fault in faults:
        print(fault, file=sys.stderr)
    return bool(faults)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
