"""The report of `signum navigate`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.columns import picture, read
from signum.report.page import Section, plot, row, table
from signum.tables.schemas import GOTO, NAVIGATE


def sections(folder: Path) -> list[Section]:
    """The way on the mosaic, how sure it was, and how it closed in on the target."""
    found = read(folder / "navigate.csv", NAVIGATE)
    confidence, turn, scale = (found.numbers(n) for n in ("confidence", "rot_deg", "scale"))
    known = confidence > 0
    lines = [("frames", str(found.rows)), ("found", f"{int(known.sum())}")]
    if known.any():
        lines += [("confidence: median, least", f"{np.median(confidence[known]):.0f}, {confidence[known].min():.0f}"),
                  ("turned against the mosaic, degrees: least, most", f"{np.nanmin(turn):.1f}, {np.nanmax(turn):.1f}"),
                  ("zoom against the mosaic: least, most", f"{np.nanmin(scale):.3f}, {np.nanmax(scale):.3f}")]
    captions = {"path.png": "the way (yellow) on the mosaic, the last view (green), the target (red)",
                "view.png": "the last view"}
    shown = [picture(folder / name, text) for name, text in captions.items() if (folder / name).exists()]
    out = [Section("Where the frames are in the mosaic", row([p for p in shown if p]) + table(("", ""), lines))]
    fig, ax = plt.subplots(figsize=(9, 2.6))
    ax.plot(confidence, color="tab:green")
    ax.set(xlabel="frame", ylabel="confidence", ylim=(0, 105))
    plots = [plot(fig, "0: not found; nothing is guessed")]
    if (folder / "goto.csv").exists():
        way = read(folder / "goto.csv", GOTO)
        fig, ax = plt.subplots(figsize=(9, 2.6))
        ax.semilogy(np.maximum(np.hypot(way.numbers("right_px"), way.numbers("down_px")), 0.05))
        ax.set(xlabel="frame", ylabel="px")
        plots.append(plot(fig, "from the middle of the view to the target, as measured"))
    return [*out, Section("Frame by frame", "".join(row([p]) for p in plots))]
