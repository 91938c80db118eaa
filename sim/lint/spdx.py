# SPDX-License-Identifier: Apache-2.0
"""The licence's line in every source file: `python -m sim.lint.spdx` names files without it, `--write` adds it.

It is the first line, or the second where the first must be something else (`#!`, `CAPI=2:`). Generated files get it as
well, after they are made; the comparison of generated files with fresh ones leaves it out (`without`).
"""

from __future__ import annotations

import sys
from pathlib import Path

from sim.lint.tree import project_files
from sim.toolchain import ROOT

LINE = "SPDX-License-Identifier: Apache-2.0"
COMMENTS = {
    **dict.fromkeys((".py", ".pyi", ".sh", ".toml", ".yml", ".yaml", ".core", ".cff", ".rules", ".waive", ".sucl"),
                    "# "),
    **dict.fromkeys((".sv", ".svh", ".vlt", ".rdl", ".cpp", ".hpp", ".h", ".f", ".js"), "// "),
}
"""How a comment begins, by ending of the file."""
NAMED = {"Makefile": "# ", ".ci/run": "# ", "LICENSE": ""}
"""The same, of files without an ending."""
LATE = "#!", "CAPI=2:", "%YAML"
"""What must be a file's first line."""


def _mark(path: Path) -> str | None:
    """The line of a file, None for one that has none."""
    name = str(path.relative_to(ROOT))
    comment = NAMED.get(name, COMMENTS.get(path.suffix))
    return None if comment is None else comment + LINE


def sources() -> list[Path]:
    """The files of the project that have the line."""
    return [path for path in project_files() if _mark(path)]


def missing() -> list[Path]:
    """Those without it."""
    return [path for path in sources() if _mark(path) not in path.read_text().splitlines()[:2]]


def without(text: str) -> str:
    """A file's text without the line, as its generator writes it."""
    lines = text.splitlines(keepends=True)
    return "".join(line for number, line in enumerate(lines) if number > 1 or not line.rstrip().endswith(LINE))


def add(path: Path) -> None:
    """Add the line to a file."""
    text = path.read_text()
    first, rest = "", text
    if text.startswith(LATE):
        first, _, rest = text.partition("\n")
        first += "\n"
    path.write_text(f"{first}{_mark(path)}\n{rest}")


def main(argv: list[str]) -> int:
    """Add the lines with `--write`, otherwise name the files without; returns the exit status."""
    bare = missing()
    if "--write" in argv:
        for path in bare:
            add(path)
        return 0
    for path in bare:
        print(f"{path.relative_to(ROOT)}: no SPDX line; run `python -m sim.lint.spdx --write`", file=sys.stderr)
    return bool(bare)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
