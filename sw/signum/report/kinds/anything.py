# SPDX-License-Identifier: Apache-2.0
"""The report of a folder with none of the known tables: its tables and pictures as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from signum.report.page import Section, row, table
from signum.report.pictures import pictures
from signum.report.read_table import read_table

MOST_UNKNOWN = 12
"""Pictures on a page that shows nothing else of what they are."""


def sections(folder: Path) -> list[Section]:
    """The pictures of a folder, and the range of every column of its tables; empty if there are none."""
    out = []
    shown = pictures(folder, "*.png", MOST_UNKNOWN)
    if shown:
        out.append(Section("Pictures", row(shown)))
    for path in sorted(folder.glob("*.csv")):
        columns = read_table(path)
        lines = []
        for name in columns.names:
            values = columns.numbers(name)
            values = values[np.isfinite(values)]
            figures = [f"{v:.6g}" for v in (values.min(), np.median(values), values.max())] if values.size else [""] * 3
            lines.append([name, str(len(set(columns.text[name]))), *figures])
        out.append(Section(f"{path.name}: {columns.rows} rows",
                           table(("column", "distinct values", "smallest", "median", "largest"), lines)))
    return out
