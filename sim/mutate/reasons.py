# SPDX-License-Identifier: Apache-2.0
"""The reviewed file of survivors: for each, a proof or an argument why no test can kill it."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

FILE = Path(__file__).with_name("reasons.toml")
GOLDEN = Path(__file__).with_name("golden_reasons.toml")
KINDS = ("proof", "argument")
SHORTEST = 30
"""Characters of the shortest reason: a name alone explains nothing."""


@dataclass(frozen=True)
class Explanation:
    """Why a mutant lives: `proof` or `argument`, and the reason in a sentence."""

    mutant: str
    kind: str
    why: str


def load(path: Path = FILE) -> dict[str, Explanation]:
    """The reasons by mutant.

    Raises:
        SystemExit: naming the file and the entry, if one is not a reason.
    """
    found = {}
    for name, entry in tomllib.loads(path.read_text()).items():
        reason = Explanation(name, str(entry.get("kind", "")), str(entry.get("why", "")).strip())
        if reason.kind not in KINDS or len(reason.why) < SHORTEST or "not observed" in reason.why:
            raise SystemExit(f"{path}: {name} needs a kind ({' or '.join(KINDS)}) and a reason in a sentence")
        found[name] = reason
    return found


def unknown(reasons: Iterable[str], names: Iterable[str]) -> list[str]:
    """Reasons for mutants that do not exist: the RTL has changed, and they must be reviewed."""
    return sorted(set(reasons) - set(names))
