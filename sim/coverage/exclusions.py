# SPDX-License-Identifier: Apache-2.0
"""Points that cannot be hit, each with its reason: `exclusions.toml`.

An entry names a module (the stem of its file), a kind of point, a regular expression that the whole name of each point
matches (`sim.coverage.points.Point.name`), and the reason. An entry that matches no point is an error: the RTL has
changed.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from sim.coverage.points import KINDS, Point

FILE = Path(__file__).with_name("exclusions.toml")
_KEYS = {"module", "kind", "points", "reason"}
_SHORTEST = 20
"""Characters of a reason."""


class ExclusionError(ValueError):
    """The file of exclusions is not in order."""


@dataclass(frozen=True)
class Exclusion:
    """One entry of the file."""

    module: str
    kind: str
    points: str
    reason: str

    def matches(self, point: Point) -> bool:
        """Whether it names the point."""
        return (point.file.stem == self.module and point.kind == self.kind
                and re.fullmatch(self.points, point.name) is not None)


def load(file: Path = FILE) -> list[Exclusion]:
    """The entries of a file.

    Raises:
        ExclusionError: if an entry lacks something, has a kind that does not exist, or gives no reason.
    """
    found = []
    for number, entry in enumerate(tomllib.loads(file.read_text()).get("exclude", []), 1):
        where = f"{file.name}, entry {number}"
        if set(entry) != _KEYS:
            raise ExclusionError(f"{where}: give {', '.join(sorted(_KEYS))}, and nothing else")
        exclusion = Exclusion(**entry)
        if exclusion.kind not in KINDS:
            raise ExclusionError(f"{where}: kind {exclusion.kind!r}: one of {', '.join(KINDS)}")
        if len(exclusion.reason) < _SHORTEST:
            raise ExclusionError(f"{where}: the reason is missing")
        try:
            re.compile(exclusion.points)
        except re.error as error:
            raise ExclusionError(f"{where}: points {exclusion.points!r}: {error}") from error
        found.append(exclusion)
    return found


def apply(exclusions: Iterable[Exclusion], points: Iterable[Point]) -> dict[Point, str]:
    """The reason of each excluded point.

    Raises:
        ExclusionError: if an entry matches no point.
    """
    by_module: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        by_module.setdefault((point.file.stem, point.kind), []).append(point)
    reasons: dict[Point, str] = {}
    for exclusion in exclusions:
        matching = [p for p in by_module.get((exclusion.module, exclusion.kind), []) if exclusion.matches(p)]
        if not matching:
            raise ExclusionError(f"{exclusion.module}: no {exclusion.kind} point is called {exclusion.points!r}: "
                                 "take the entry out, or name what it is called now")
        reasons.update(dict.fromkeys(matching, exclusion.reason))
    return reasons
