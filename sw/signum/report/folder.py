# SPDX-License-Identifier: Apache-2.0
"""`report.html` made from the tables and pictures in a command's folder, at its end or any time later.

Each module of `kinds` reports one kind of table, with a function `sections(folder)`; `KINDS` gives the table. A folder
with none of these tables is shown as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from signum.common.errors import SignumError
from signum.report.about import About, head
from signum.report.kinds import anything, calibrate, flow, mosaic, navigate, stereo, track
from signum.report.page import Section, write_page

KINDS: dict[str, tuple[str, Callable[[Path], list[Section]]]] = {
    "track.csv": ("Tracks", track.sections),
    "flow.csv": ("Optical flow", flow.sections),
    "disparity.csv": ("Stereo range", stereo.sections),
    "edges.csv": ("Mosaic", mosaic.sections),
    "navigate.csv": ("Mosaic navigation", navigate.sections),
    "views.csv": ("Calibration", calibrate.sections),
}
"""Table -> title of the page, and what makes its sections from the folder."""


class ReportError(SignumError):
    """There is no such folder, or nothing in it to report."""


def write_report(folder: Path, *runs: About) -> Path:
    """Write `report.html` into a folder from the tables and pictures in it; returns its path.

    It begins with the runs given, or those that the page there begins with.

    Raises:
        ReportError: if it is no folder, or there is nothing in it to report.
    """
    if not folder.is_dir():
        raise ReportError(f"{folder}: no such folder; give the --out folder of an earlier command")
    found = [kind for name, kind in KINDS.items() if (folder / name).exists()]
    title = ", ".join(title for title, _ in found) or folder.resolve().name
    sections = [section for _, make in found for section in make(folder)]
    if not found:
        sections = anything.sections(folder)
    if not sections:
        raise ReportError(f"{folder}: no table or picture in it; give the --out folder of an earlier command")
    return write_page(folder / "report.html", f"Signum: {title}", sections, head(folder / "report.html", *runs))
