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
FEW, MANY = 2, 8
"""Least clocks of a short and of a long stall."""
STALLS = ("taken at once", "stalled for a clock", f"stalled for {FEW} to {MANY - 1} clocks",
          f"stalled for {MANY} clocks or more", "taken in consecutive clocks", "ready without valid")
"""What a handshake can do."""


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

    Each group of the file is a table: `must` lists what must be met, `numbered` does so for phrases with a number in
    them, as `phrase = count`, and `interfaces` lists the valids of handshakes, which must meet all STALLS. `cannot`
    gives the reason for what cannot be met.
    """
    wanted: dict[tuple[str, str], str] = {}
    for group, entry in tomllib.loads(file.read_text()).items():
        listed = list(entry.get("must", []))
        listed += [phrase.format(n) for phrase, count in entry.get("numbered", {}).items() for n in range(count)]
        listed += [f"{valid}: {stall}" for valid in entry.get("interfaces", []) for stall in STALLS]
        wanted |= {(group, what): "" for what in listed}
        wanted |= {(group, what): reason for what, reason in entry.get("cannot", {}).items()}
    return wanted
