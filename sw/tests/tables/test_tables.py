# SPDX-License-Identifier: Apache-2.0
"""The table writer, and the columns of every table."""

import csv
import io
from pathlib import Path

from signum.tables import schemas
from signum.tables.table import Table, csv_line


def test_a_table_is_complete_after_every_row(tmp_path: Path) -> None:
    table = Table(tmp_path / "t.csv", ("frame", "x_px"))
    for row, text in (((1, 2.5), "frame,x_px\n1,2.5\n"), (("a,b", ""), 'frame,x_px\n1,2.5\n"a,b",\n')):
        table.write(row)
        assert (tmp_path / "t.csv").read_text() == text, "before it is closed"
    table.close()


def test_no_table_has_a_column_twice() -> None:
    tables = {name: columns for name, columns in vars(schemas).items() if name.isupper()}
    assert len(tables) >= 15
    for name, columns in tables.items():
        assert len(set(columns)) == len(columns) >= 3, name
    for measured, truth in ((schemas.HOLD, schemas.HOLD_TRUTH), (schemas.FOLLOW, schemas.FOLLOW_TRUTH)):
        assert not set(measured) & set(truth)


def test_a_line_reads_back_the_same() -> None:
    row = ["a\rb", "c\nd", "e\r\nf", 'g"h', "i,j", ""]
    line = csv_line(row)
    assert line.endswith("\n") and not line.endswith("\r\n")
    assert list(csv.reader(io.StringIO(line + line, newline=""))) == [row, row]
