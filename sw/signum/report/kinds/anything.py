"""Tables and pictures of any kind, as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from signum.report.columns import evenly, picture, read
from signum.report.page import Section, row, table

MOST_PICTURES = 12


def sections(folder: Path) -> list[Section]:
    """The pictures of a folder, and the range of every column of its tables; empty if there are none."""
    out = []
    shown = [p for p in (picture(path) for path in evenly(sorted(folder.glob("*.png")), MOST_PICTURES)) if p]
    if shown:
        out.append(Section("Pictures", row(shown)))
    for path in sorted(folder.glob("*.csv")):
        columns = read(path)
        lines = []
        for name in columns.names:
            values = columns.numbers(name)
            values = values[np.isfinite(values)]
            figures = [f"{v:.6g}" for v in (values.min(), np.median(values), values.max())] if values.size else [""] * 3
            lines.append([name, str(len(set(columns.text[name]))), *figures])
        out.append(Section(f"{path.name}: {columns.rows} rows",
                           table(("column", "different", "least", "median", "most"), lines)))
    return out
