# SPDX-License-Identifier: Apache-2.0
"""A CSV file on disk."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from signum.tables.cells import neutral_row


def csv_line(row: Sequence[object]) -> str:
    """A row as a line of a CSV file, which ends with a line feed alone."""
    line = io.StringIO()
    # With a line feed as its end, csv would leave a carriage return in a cell without quotes.
    csv.writer(line).writerow(neutral_row(row))
    return f"{line.getvalue()[:-2]}\n"


class Table:
    """A CSV file of whole rows: after each `write` it is complete on disk, so a run that is stopped keeps its rows."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._path = path
        self._file = path.open("w", newline="", encoding="utf-8")
        self.write(columns)

    def write(self, row: Sequence[object]) -> None:
        """Append a row and flush the file.

        Raises:
            OSError: if it cannot be written, with the table's path as its file name.
        """
        self._append(f"{csv_line(row)[:-1]}\r\n")

    def write_numbers(self, begin: Sequence[object], numbers: Iterable[str]) -> None:
        """Append rows that belong together, such as those of a frame, and flush the file once; errors as `write`.

        Args:
            begin: the first cells, the same in all rows.
            numbers: the other cells of each row, joined by commas: numbers or nothing, which need no quotes.
        """
        first = csv_line(begin)[:-1]
        self._append("".join([f"{first},{rest}\r\n" for rest in numbers]))

    def _append(self, text: str) -> None:
        try:
            self._file.write(text)
            self._file.flush()
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error

    def close(self) -> None:
        """Close the file; rows that could not be written have been told of by `write`."""
        with suppress(OSError):
            self._file.close()
