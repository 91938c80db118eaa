# SPDX-License-Identifier: Apache-2.0
"""The report of `signum navigate`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.page import Section, plot, row, table
from signum.report.pictures import picture
from signum.report.read_table import read_table
from signum.tables.schemas import GOTO, NAVIGATE


def sections(folder: Path) -> list[Section]:
    """The path on the mosaic, the confidence of every frame, and the distance to the target."""
    found = read_table(folder / "navigate.csv", NAVIGATE)
    confidence, turn, scale = (found.numbers(n) for n in ("confidence", "rot_deg", "scale"))
    known = confidence > 0
    lines = [("frames", str(found.rows)), ("found", f"{int(known.sum())}")]
    if known.any():
        lines += [("confidence: median, lowest", f"{np.median(confidence[known]):.0f}, {confidence[known].min():.0f}"),
                  ("rotation against the mosaic, degrees: smallest, largest",
                   f"{np.nanmin(turn):.1f}, {np.nanmax(turn):.1f}"),
                  ("scale against the mosaic: smallest, largest", f"{np.nanmin(scale):.3f}, {np.nanmax(scale):.3f}")]
    captions = {"path.png": "the path (yellow) on the mosaic, the last view (green), the target (red)",
                "view.png": "the last view"}
    shown = [picture(folder / name, text) for name, text in captions.items() if (folder / name).exists()]
    out = [Section("Where the frames are in the mosaic", row([p for p in shown if p]) + table(("", ""), lines))]
    fig, ax = plt.subplots(figsize=(9, 2.6))
    ax.plot(confidence, color="tab:green")
    ax.set(xlabel="frame", ylabel="confidence", ylim=(0, 105))
    plots = [plot(fig, "confidence of every frame; 0 where it was not found")]
    if (folder / "goto.csv").exists():
        way = read_table(folder / "goto.csv", GOTO)
        fig, ax = plt.subplots(figsize=(9, 2.6))
        ax.semilogy(np.maximum(np.hypot(way.numbers("right_px"), way.numbers("down_px")), 0.05))
        ax.set(xlabel="frame", ylabel="px")
        plots.append(plot(fig, "measured distance from the middle of the view to the target"))
    return [*out, Section("Frame by frame", "".join(row([p]) for p in plots))]
