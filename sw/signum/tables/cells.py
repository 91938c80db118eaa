# SPDX-License-Identifier: Apache-2.0
"""Cells of CSV tables: text that a spreadsheet would run as a formula is neutralised on writing and restored on
reading.

A text that begins with one of `=`, `+`, `-`, `@`, tab or carriage return, after any number of apostrophes, gets one
more apostrophe in front, which is how a spreadsheet marks text; reading takes it away. Numbers, negative ones too, stay
as they are.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:inf|nan)")
RUN = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet would run, or that was neutralised."""


FIRST = frozenset("'=+-@\t\r")
"""How RUN begins: almost every cell is passed by this alone."""


def neutral(cell: object) -> object:
    """A cell as it is written: a text that would be run gets an apostrophe in front, all else stays."""
    if isinstance(cell, str) and RUN.match(cell) and not NUMBER.fullmatch(cell):
        return f"'{cell}"
    return cell


def neutral_row(row: Sequence[object]) -> list[object]:
    """A row as it is written; see `neutral`."""
    return [neutral(cell) if isinstance(cell, str) and cell[:1] in FIRST else cell for cell in row]


def restored(cell: str) -> str:
    """A cell as it was before `neutral`."""
    return cell[1:] if cell[:1] == "'" and RUN.match(cell) else cell
