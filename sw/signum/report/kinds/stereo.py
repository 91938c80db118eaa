# SPDX-License-Identifier: Apache-2.0
"""The report of `signum stereo`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.page import Section, paragraph, plot, row, table
from signum.report.pictures import pictures
from signum.report.read_table import read_table
from signum.tables.schemas import DISPARITY

MOST_LINES = 40
"""Frames in the table."""


def sections(folder: Path) -> list[Section]:
    """Maps, and the distribution of the measured ranges or disparities."""
    found = read_table(folder / "disparity.csv", DISPARITY)
    valid = found.numbers("valid") > 0
    disparity, metres = found.numbers("disparity_px"), found.numbers("range_m")
    known = bool(np.isfinite(metres).any())
    values, unit = (metres, "range, m") if known else (disparity, "disparity, px")
    lines = []
    for name, rows in list(found.groups("frame").items())[:MOST_LINES]:
        seen = values[rows][np.isfinite(values[rows])]
        figures = [f"{v:.3f}" for v in np.percentile(seen, (5, 50, 95))] if seen.size else [""] * 3
        lines.append([name, f"{valid[rows].mean():.0%}", *figures])
    fig, ax = plt.subplots(figsize=(6, 3))
    ax.hist(values[np.isfinite(values)], bins=60)
    ax.set(xlabel=unit, ylabel="windows")
    about = ("Colour is " + ("range in metres" if known else "disparity in pixels of the board's picture")
             + "; where the grey picture shows, no measurement passed its checks: texture, margin over the second "
             "best, the search from right to left, and agreement with a window twice as large. A run "
             "with --dense measures every pixel; the table and the figures below have every eighth one across and "
             "down.")
    heads = "frame", "windows valid", f"{unit}: 5th percentile", "median", "95th percentile"
    return [Section("Range maps", paragraph(about) + row(pictures(folder, "range*.png"))),
            Section("Measurements", row([plot(fig, "all valid windows")]) + table(heads, lines))]
