# SPDX-License-Identifier: Apache-2.0
"""Which simulations a test file runs: its calls of `simulate`, recorded instead of made.

`python -m sim.mutate.calls FILE ...` prints them as JSON.
"""

from __future__ import annotations

import ast
import inspect
import json
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from math import prod
from pathlib import Path
from typing import Any

import pytest

from sim.testbench.runner import simulate
from sim.toolchain import ROOT

MARK = "calls of simulate: "


@dataclass(frozen=True)
class Call:
    """One simulation: the arguments of `simulate`."""

    top: str
    test_module: str
    parameters: Mapping[str, int] = field(default_factory=dict)
    env: Mapping[str, str] = field(default_factory=dict)
    testcase: str | None = None
    defines: Mapping[str, str] = field(default_factory=dict)
    ports: tuple[str, ...] = ("*_i", "*_o")
    config: str = "tiny"
    ecp5: bool = False

    @property
    def name(self) -> str:
        """For the terminal."""
        shape = " ".join(f"{key}={value}" for key, value in self.parameters.items())
        return f"{self.test_module.rsplit('.', 1)[-1]}{' ' if shape else ''}{shape}{' ecp5' if self.ecp5 else ''}"

    @property
    def size(self) -> int:
        """Grows with the time that a simulation takes; only the order matters."""
        return prod(max(abs(value), 1) for value in self.parameters.values())


class _Recorder:
    """Takes the place of `simulate` in every test module."""

    def __init__(self) -> None:
        self.calls: list[dict[str, Any]] = []

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        module: Any = item.getparent(pytest.Module)
        if hasattr(module.obj, "simulate"):
            module.obj.simulate = self.record

    def record(self, *args: Any, **kwargs: Any) -> Path:
        """Keep the arguments of a call."""
        bound = inspect.signature(simulate).bind(*args, **kwargs).arguments
        if not bound.pop("replaced", None):
            self.calls.append(bound)
        return Path()


def calls_of(test_modules: Iterable[str]) -> dict[str, list[Call]]:
    """The simulations of test modules, the smallest first.

    Args:
        test_modules: dotted names.

    Raises:
        RuntimeError: if a file cannot be collected, or runs no simulation.
    """
    names = list(test_modules)
    paths = [name.replace(".", "/") + ".py" for name in names]
    done = subprocess.run([sys.executable, "-m", "sim.mutate.calls", *paths], cwd=ROOT, capture_output=True,
                          text=True, check=False)
    found = [line for line in done.stdout.splitlines() if line.startswith(MARK)]
    if not found:
        raise RuntimeError(f"the tests cannot be collected\n{done.stdout}{done.stderr}")
    calls = [_call(one) for one in json.loads(found[-1].removeprefix(MARK))]
    by_module = {name: sorted((call for call in calls if call.test_module == name), key=lambda call: call.size)
                 for name in names}
    empty = [name for name, found_calls in by_module.items() if not found_calls]
    if empty:
        raise RuntimeError(f"no simulation in {', '.join(empty)}\n{done.stdout}{done.stderr}")
    return by_module


def _call(arguments: dict[str, Any]) -> Call:
    """A call from its recorded arguments."""
    given = {key: value for key, value in arguments.items() if value is not None}
    return Call(**{**given, "ports": tuple(given.get("ports", Call.ports))})


def python_files(module: str) -> list[Path]:
    """The project's Python files that a module imports, directly or not, and itself."""
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = _file_of(name)
        if name in found or path is None:
            continue
        found[name] = path
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                waiting += [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module:
                waiting += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return sorted(found.values())


def _file_of(name: str) -> Path | None:
    base = ROOT.joinpath(*name.split("."))
    return next((path for path in (base.with_suffix(".py"), base / "__init__.py") if path.exists()), None)


def dictionary(call: Call) -> dict[str, Any]:
    """A call as JSON stores it."""
    return asdict(call)


def _main() -> int:
    recorder = _Recorder()
    status = pytest.main(["-q", "-p", "no:cacheprovider", "-o", "addopts=", *sys.argv[1:]], plugins=[recorder])
    if status:
        return int(status)
    print("\n" + MARK + json.dumps(recorder.calls))
    return 0


if __name__ == "__main__":
    raise SystemExit(_main())
