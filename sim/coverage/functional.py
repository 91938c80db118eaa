# SPDX-License-Identifier: Apache-2.0
"""Functional coverage: `functional.toml` lists what the regression must meet, and the tests count it
(`sim.coverage.record.met`). Stalls are counted for every handshake of every module by the test benches' checker."""

from __future__ import annotations

import json
import tomllib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

FILE = Path(__file__).with_name("functional.toml")


@dataclass
class Functional:
    """What was met, and what was compared.

    Attributes:
        counts: how often, by (group, what).
        clocks: in which a module's outputs were compared, by module.
        undefined: clocks in which an output was undefined, by (module, output); 0 where it always had a value.
    """

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    clocks: Counter[str] = field(default_factory=Counter)
    undefined: Counter[tuple[str, str]] = field(default_factory=Counter)


def collected(records: Iterable[Path]) -> Functional:
    """Sum of the records of `sim.coverage.record`."""
    total = Functional()
    for record in records:
        entry = json.loads(record.read_text())
        name, value = entry["name"], entry["value"]
        if entry["kind"] == "met":
            total.counts.update({(name, what): count for what, count in value.items()})
        else:
            total.clocks[name] += value["clocks"]
            total.undefined.update({(name, output): count for output, count in value["undefined"].items()})
    return total


def plan(file: Path = FILE) -> dict[tuple[str, str], str]:
    """What must be met, by (group, what), and why it may be missing: empty for what must be there.

    Each group of the file is a table with `must`, a list, and perhaps `cannot`, a table of reasons.
    """
    wanted: dict[tuple[str, str], str] = {}
    for group, entry in tomllib.loads(file.read_text()).items():
        wanted |= {(group, what): "" for what in entry["must"]}
        wanted |= {(group, what): reason for what, reason in entry.get("cannot", {}).items()}
    return wanted
