# SPDX-License-Identifier: Apache-2.0
"""Reads Verilator's coverage records and merges them: a point of a module is hit if any instance, in any run and with
any parameters, hit it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

KINDS = "line", "branch", "toggle"
MEMORIES = {"slog_ram": "mem_q["}
"""Signals, by module, that are the words of a memory: data at rest, without toggle points. Their ports have some."""
_FIELDS = re.compile(r"\x01([^\x02]+)\x02([^\x01]*)")


@dataclass(frozen=True, order=True)
class Point:
    """One point of the RTL.

    Attributes:
        file: of the source, an absolute path.
        line, column: in it.
        kind: one of KINDS.
        what: `name[bit]:0->1` of a toggle; which way of a branch, such as `else`.
    """

    file: Path
    line: int
    column: int
    kind: str
    what: str

    @property
    def name(self) -> str:
        """How exclusions and the page call it: a toggle by its signal, other points by their line of the source."""
        if self.kind == "toggle":
            return self.what
        return f"{_source(self.file)[self.line - 1].strip()} [{self.what}]"

    @property
    def generated(self) -> bool:
        """Whether the source is generated."""
        return "gen" in self.file.parts


@cache
def _source(file: Path) -> list[str]:
    return file.read_text().splitlines()


def read(record: Path, rtl: Path) -> Counter[Point]:
    """Hits of the points of a record, of sources within `rtl` only; a point without a hit is there with 0.

    Raises:
        ValueError: if the file is not a record of Verilator.
    """
    lines = record.read_text().splitlines()
    if not lines or not lines[0].startswith("# SystemC::Coverage"):
        raise ValueError(f"{record} is no coverage record of Verilator")
    hits: Counter[Point] = Counter()
    for line in lines[1:]:
        if not line.startswith("C '"):
            continue
        described, _, count = line[3:].rpartition("' ")
        fields = dict(_FIELDS.findall(described))
        kind = fields["page"].removeprefix("v_").partition("/")[0]
        file = Path(fields["f"])
        memory = kind == "toggle" and fields["o"].startswith(MEMORIES.get(file.stem, "no memory"))
        if kind in KINDS and file.is_relative_to(rtl) and not memory:
            point = Point(file, int(fields["l"]), int(fields["n"]), kind, fields["o"])
            hits[point] += int(count)
    return hits


def merged(records: Iterable[Path], rtl: Path) -> Counter[Point]:
    """Sum of all records."""
    total: Counter[Point] = Counter()
    for record in records:
        total.update(read(record, rtl))
    return total
