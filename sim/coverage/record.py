# SPDX-License-Identifier: Apache-2.0
"""What a run records for `make coverage`: Verilator's points, what the tests met, and how many outputs were compared.

Nothing is recorded unless the environment variable `SIGNUM_COVERAGE` names a folder. Each test file has a folder of its
own in it, so that one can be run again by itself.
"""

from __future__ import annotations

import json
import os
import uuid
from collections.abc import Mapping
from pathlib import Path

VARIABLE = "SIGNUM_COVERAGE"
WITHOUT_TEST = "other"
"""Folder of the records of what is no test."""
COUNTERS = Path(__file__).with_name("toggle.hpp")
"""Included in every generated file of a build: counts the toggles of wide signals."""
COVERAGE_ARGS = ("--coverage-line", "--coverage-toggle", "--coverage-max-width", "4096",
                 "--compiler-include", str(COUNTERS))
"""Verilator's arguments. Branches come with the lines; wider signals than this have no toggle points."""


def coverage_folder() -> Path | None:
    """The folder for records of the running test file, made if it is missing; None if coverage is not recorded."""
    named = os.environ.get(VARIABLE)
    if not named:
        return None
    folder = Path(named) / Path(os.environ.get("PYTEST_CURRENT_TEST", WITHOUT_TEST).partition("::")[0]).stem
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def coverage_args() -> tuple[str, ...]:
    """`COVERAGE_ARGS` if coverage is recorded, else nothing."""
    return COVERAGE_ARGS if coverage_folder() else ()


def points_file(name: str) -> Path | None:
    """A new file for the points of a run of the module `name`; None if coverage is not recorded."""
    folder = coverage_folder()
    return folder and folder / f"{name}-{uuid.uuid4().hex[:12]}.dat"


def met(group: str, counts: Mapping[str, int]) -> None:
    """Record how often a test met what the plan `functional.toml` lists under `group`."""
    _write("met", group, {what: int(count) for what, count in counts.items()})


def compared(module: str, clocks: int, undefined: Mapping[str, int]) -> None:
    """Record for how many clocks the outputs of `module` were compared with its model, and in how many of these the
    model left each output undefined."""
    _write("compared", module, {"clocks": clocks, "undefined": dict(undefined)})


def _write(kind: str, name: str, value: object) -> None:
    folder = coverage_folder()
    if folder:
        (folder / f"{name.replace('/', '-')}-{uuid.uuid4().hex[:12]}.json").write_text(
            json.dumps({"kind": kind, "name": name, "value": value}))
