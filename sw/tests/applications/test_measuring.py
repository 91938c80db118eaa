# SPDX-License-Identifier: Apache-2.0
"""Modules that an application measures with run on real frames: only its simulation imports the simulated world."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from signum import applications

ROOM = Path(next(iter(applications.__path__)))
FILES = [f for name in ("hold", "follow", "navigate") for f in sorted((ROOM / name).rglob("*.py"))
         if "simulate" not in f.relative_to(ROOM).as_posix()]


@pytest.mark.parametrize("file", FILES, ids=lambda f: f"{f.parent.name}/{f.stem}")
def test_no_import_of_the_simulated_world(file: Path) -> None:
    imported = [node.module or "" for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ImportFrom)]
    assert imported or file.stem == "__init__"
    assert not [m for m in imported if m.startswith("signum.world") or ".simulate" in m]
