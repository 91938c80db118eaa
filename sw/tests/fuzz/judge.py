# SPDX-License-Identifier: Apache-2.0
"""What came of a case: its outcome, by exit status, what was said, and the tables against those of the undamaged
input."""

from __future__ import annotations

import csv
import io
import math
import re
import signal
from enum import StrEnum
from pathlib import Path

from tests.fuzz.child import TRACEBACK

Rows = dict[str, dict[str, list[list[str]]]]
"""Table -> frame -> rows."""


class Outcome(StrEnum):
    """Of a case; the first four are failures."""

    traceback = "traceback"
    hang = "hang"
    signal = "signal"
    wrong = "silently wrong"
    refused = "refused"
    good = "ok"


FAILURES = Outcome.traceback, Outcome.hang, Outcome.signal, Outcome.wrong


def tables(folder: Path) -> Rows:
    """The rows of every table of a folder by their frame."""
    found: Rows = {}
    for path in sorted(folder.glob("*.csv")):
        text = path.read_text(encoding="utf-8", errors="surrogateescape")
        lines = list(csv.reader(io.StringIO(text, newline="")))
        rows = found.setdefault(path.name, {})
        key = int(bool(lines) and lines[0][1:2] == ["frame_b"])  # a pair is lost with its later frame
        for line in lines[1:]:
            if len(line) > key:
                rows.setdefault(line[key], []).append(line)
    return found


def judge(status: int, said: str, out: Path, good: Rows, checksum: bool) -> tuple[Outcome, str]:
    """The outcome and why.

    Args:
        status: exit status, negative for a signal.
        said: what was printed.
        out: folder with the tables.
        good: tables of the undamaged input.
        checksum: whether the input carries checksums: no row may then differ.
    """
    if status == TRACEBACK:
        return Outcome.traceback, said.strip().rsplit("\n", 1)[-1]
    if status in (-signal.SIGKILL, -signal.SIGXCPU):
        return Outcome.hang, "stopped by the limits of time"
    if status < 0:
        return Outcome.signal, signal.Signals(-status).name
    if status:
        lines = [line for line in said.splitlines() if line.startswith("signum: ")]
        told = len(lines) == 1 if status == 1 else status == 2
        return (Outcome.refused, lines[0] if lines else "usage") if told else (
            Outcome.traceback, f"status {status} with {len(lines)} lines of error")
    wrong = _wrong(said, tables(out), good, checksum)
    return (Outcome.wrong, wrong) if wrong else (Outcome.good, "")


def _wrong(said: str, found: Rows, good: Rows, checksum: bool) -> str:
    """What is silently wrong; empty for nothing."""
    named = _named(said)
    for table, frames in good.items():
        if table not in found:
            return f"{table} is missing"
        lost = [f for f in frames if f not in found[table] and f not in named]
        if lost:
            return f"{table}: frames {', '.join(lost)} are missing"
        for frame, rows in found[table].items():
            odd = [cell for row in rows for cell in row[1:] if _endless(cell)]
            if odd:
                return f"{table}: frame {frame} has {odd[0]}"
            if checksum and rows != frames.get(frame) and frame not in named:
                return f"{table}: frame {frame} differs"
    return ""


def _named(said: str) -> set[str]:
    """The frames that messages name, alone or as a range."""
    names = set(re.findall(r"frame (\S+?)[:,;]?\s", said))
    for first, last in re.findall(r"frames (\d+) to (\d+)", said):
        names |= {str(k) for k in range(int(first), min(int(last), 10_000) + 1)}
    return names


def _endless(cell: str) -> bool:
    try:
        return not math.isfinite(float(cell))
    except ValueError:
        return False
