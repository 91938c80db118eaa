# SPDX-License-Identifier: Apache-2.0
"""Reads CSV tables that others wrote: navigation logs, truths, named places."""

from __future__ import annotations

import csv
import io
from collections import Counter
from pathlib import Path

from signum.common.checks import TABLE_BYTES, read_text
from signum.common.errors import SignumError
from signum.tables.cells import restored

SEPARATORS = ",", ";", "\t"
"""What may stand between cells; the one that the head has most of is taken."""


def read_rows(path: Path, error: type[SignumError] = SignumError) -> list[dict[str, str]]:
    """The rows of a CSV file, one or more, by the heads of their columns in small letters.

    Cells are separated by commas, semicolons or tabs, whichever the head has most of.

    Raises:
        SignumError: of type `error`, if it is no such file, or a row has not as many cells as the head.
    """
    text = read_text(path, "CSV", error, TABLE_BYTES)
    titles = next((line for line in text.splitlines() if line.strip()), "")
    separator = max(SEPARATORS, key=titles.count)
    try:
        lines = [line for line in csv.reader(io.StringIO(text, newline=""), delimiter=separator) if line]
    except csv.Error as reason:
        raise error(f"{path}: not a CSV table; export it as comma-separated text") from reason
    if len(lines) < 2:
        raise error(f"{path}: no rows in it; expected a head and one row or more")
    head = [cell.strip().lower() for cell in lines[0]]
    twice = next((name for name, times in Counter(filter(None, head)).items() if times > 1), None)
    if twice is not None:
        raise error(f"{path}: two columns are called {twice}; name each once")
    for index, line in enumerate(lines[1:], 1):
        if len(line) != len(head):
            raise error(f"{path}: row {index} ({separator.join(line)[:40]}) has {len(line)} cells, the head has "
                        f"{len(head)}; expected as many (a number has a point, no comma)")
    return [dict(zip(head, (restored(cell).strip() for cell in line), strict=True)) for line in lines[1:]]
