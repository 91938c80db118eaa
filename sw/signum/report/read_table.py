# SPDX-License-Identifier: Apache-2.0
"""Reads tables back; `rows.py` has the rows that are written."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.common.checks import TABLE_BYTES, read_bytes
from signum.common.console import notes
from signum.common.errors import SignumError
from signum.tables.cells import restored

LARGEST = 1e12
"""Largest magnitude of a number in a table."""
TIMES = "time_s", "step_s"
"""Columns that tables of version 1.1 lack; no report needs them."""


@dataclass(frozen=True)
class Columns:
    """A table as columns of text, each with one entry per row."""

    names: tuple[str, ...]
    text: dict[str, list[str]]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.text[self.names[0]]) if self.names else 0

    def numbers(self, name: str) -> Floats:
        """A column as numbers, (rows,); NaN where the text is empty or no finite number up to LARGEST."""
        text = self.text[name]
        try:  # at once, as tables may have a million rows
            values = np.array([float(v or "nan") for v in text], np.float64)
        except ValueError:
            values = np.array([_number(v) for v in text], np.float64)
        values[~(np.abs(values) <= LARGEST)] = np.nan
        return values

    def groups(self, name: str) -> dict[str, NDArray[np.int64]]:
        """Row numbers by the value of a column, in the order in which the values first appear."""
        out: dict[str, list[int]] = {}
        for i, value in enumerate(self.text[name]):
            out.setdefault(value, []).append(i)
        return {value: np.array(rows, np.int64) for value, rows in out.items()}


def read_table(path: Path, needed: tuple[str, ...] = ()) -> Columns:
    """Read a CSV file; rows without all columns, such as a last row cut short, are left out, which a note
    says.

    Raises:
        SignumError: if it is no file with a table, or a needed column is missing.
    """
    text = read_bytes(path, "table", most=TABLE_BYTES).decode("utf-8", "replace")
    try:
        lines = [line for line in csv.reader(io.StringIO(text, newline="")) if line]
    except csv.Error as error:
        raise SignumError(f"{path}: not a CSV table ({error}); run the command again that writes it") from error
    if "'" in text:
        lines = [list(map(restored, line)) for line in lines]
    names = tuple(lines[0]) if lines else ()
    missing = [name for name in needed if name not in names and name not in TIMES]
    if missing:
        raise SignumError(f"{path}: has no column {', '.join(missing)}; run the command again that writes this table")
    body = [line for line in lines[1:] if len(line) == len(names)]
    if len(body) < len(lines) - 1:
        notes.print(f"{path}: {len(lines) - 1 - len(body)} of {len(lines) - 1} rows have not {len(names)} cells and "
                    "are left out")
    columns = [list(cells) for cells in zip(*body, strict=True)] or [[] for _ in names]
    wrong = {cell for cells in columns for cell in set(cells) if _endless(cell)}
    endless = sum(cell in wrong for cells in columns for cell in cells) if wrong else 0
    if endless:
        notes.print(f"{path}: {endless} cells are no finite numbers up to {LARGEST:g} and are left out")
    return Columns(names, dict(zip(names, columns, strict=True)))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _endless(text: str) -> bool:
    """Whether a text is a number that is infinite, not a number, or beyond LARGEST."""
    try:
        return not abs(float(text)) <= LARGEST
    except ValueError:
        return False
