"""The report of `signum navigate`."""

from __future__ import annotations

from pathlib import Path

from sw.page import Section
from sw.reports import anything


def sections(folder: Path) -> list[Section]:
    """What there is."""
    return anything.sections(folder)
