"""Reads tables back; `rows.py` has the rows that are written."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats
from signum.common.errors import SignumError


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
        """A column as numbers, (rows,); NaN where the text is empty or not a number."""
        return np.array([_number(v) for v in self.text[name]], np.float64)

    def groups(self, name: str) -> dict[str, NDArray[np.int64]]:
        """Row numbers by the value of a column, in the order in which the values first appear."""
        out: dict[str, list[int]] = {}
        for i, value in enumerate(self.text[name]):
            out.setdefault(value, []).append(i)
        return {value: np.array(rows, np.int64) for value, rows in out.items()}


def read_table(path: Path, needed: tuple[str, ...] = ()) -> Columns:
    """Read a CSV file; rows without all columns, such as a last row cut short, are left out.

    Raises:
        SignumError: if a needed column is missing.
    """
    with path.open(newline="", encoding="utf-8", errors="replace") as file:
        lines = [line for line in csv.reader(file) if line]
    names = tuple(lines[0]) if lines else ()
    missing = [name for name in needed if name not in names]
    if missing:
        raise SignumError(f"{path}: has no column {', '.join(missing)}; run the command again that writes this table")
    body = [line for line in lines[1:] if len(line) == len(names)]
    return Columns(names, {name: [line[i] for line in body] for i, name in enumerate(names)})


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
