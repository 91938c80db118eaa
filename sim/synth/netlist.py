# SPDX-License-Identifier: Apache-2.0
"""Netlists as Yosys writes them: the flat module, and the comparison of two.

`python -m sim.synth.netlist A.json B.json` compares two netlists apart from attributes that hold file
names and line numbers: equal netlists need no new place and route.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

SOURCE_ATTRIBUTES = "src", "module_src", "cell_src"
"""Attributes that hold file names and line numbers."""


def flat(design: Mapping[str, Any]) -> Any:
    """The flat module of a netlist: the one marked as top, else the one with the most cells."""
    return max(design["modules"].values(), key=lambda module: (
        "top" in module.get("attributes", {}), len(module["cells"])))


def _plain(value: Any) -> Any:
    """`value` without source attributes."""
    if isinstance(value, dict):
        return {name: _plain(member) for name, member in value.items() if name not in SOURCE_ATTRIBUTES}
    return [_plain(member) for member in value] if isinstance(value, list) else value


def differences(first: Mapping[str, Any], second: Mapping[str, Any]) -> Iterator[str]:
    """Places in which two netlists differ, source attributes and the tool's version apart.

    A place is a module, or a cell or net in it. Names, connections, parameters, attributes and the order of cells and
    nets are compared: nextpnr's result depends on all of them.
    """
    for name in dict.fromkeys([*first["modules"], *second["modules"]]):
        ours, theirs = (design["modules"].get(name) for design in (first, second))
        if ours is None or theirs is None:
            yield f"{name}: only in the {'second' if ours is None else 'first'}"
            continue
        inside: list[str] = []
        for group in ("cells", "netnames"):
            a, b = ours.get(group, {}), theirs.get(group, {})
            inside += [f"{name}: {group} {member}" for member in dict.fromkeys([*a, *b])
                       if a.get(member) != b.get(member) and _plain(a.get(member)) != _plain(b.get(member))]
            if not inside and list(a) != list(b):
                inside.append(f"{name}: the order of its {group}")
        rest = [{key: member for key, member in module.items() if key not in ("cells", "netnames")}
                for module in (ours, theirs)]
        if _plain(rest[0]) != _plain(rest[1]):
            inside.append(f"{name}: attributes or ports")
        yield from inside
    if list(first["modules"]) != list(second["modules"]):
        yield "the order of modules"


def main(argv: Sequence[str] | None = None) -> int:
    """Print the first differences of two netlists; returns the exit status: 1 if they differ."""
    parser = argparse.ArgumentParser(description="Compare two netlists apart from file names and line numbers")
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    args = parser.parse_args(argv)
    found = list(differences(*(json.loads(path.read_text()) for path in (args.first, args.second))))
    print("\n".join(found[:20]) if found else "equal")
    if len(found) > 20:
        print(f"and {len(found) - 20} differences more")
    return int(bool(found))


if __name__ == "__main__":
    raise SystemExit(main())
