# SPDX-License-Identifier: Apache-2.0
"""The report of `signum flow`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.page import Section, paragraph, plot, row, table
from signum.report.pictures import film, pictures
from signum.report.read_table import read_table
from signum.tables.schemas import FLOW


def sections(folder: Path) -> list[Section]:
    """Fields, and the overall motion of the picture over time."""
    flow = read_table(folder / "flow.csv", FLOW)
    valid = flow.numbers("valid") > 0
    dx, dy = flow.numbers("dx_px"), flow.numbers("dy_px")
    fields = list(flow.groups("frame_b").values())
    median = np.array([[np.median(v[r][valid[r]]) if valid[r].any() else np.nan for v in (dx, dy)] for r in fields])
    median = median.reshape(-1, 2)
    shares = [float(valid[r].mean()) for r in fields]
    speed = np.hypot(dx[valid], dy[valid])
    lines = [("pairs of frames", str(len(fields))), ("windows", str(flow.rows)),
             ("valid", f"{valid.mean():.1%}" if flow.rows else "none")]
    if speed.size:
        lines.append(("motion, px per frame: median, largest", f"{np.median(speed):.2f}, {speed.max():.2f}"))
    fig, axes = plt.subplots(2, 1, figsize=(9, 4.4), sharex=True)
    for axis, name in enumerate(("right", "down")):
        axes[0].plot(median[:, axis], label=name)
    axes[0].set(ylabel="median flow, px per frame")
    axes[0].legend(loc="upper right")
    axes[1].plot(shares, color="tab:green")
    axes[1].set(ylabel="share valid", xlabel="pair of frames", ylim=(0, 1.02))
    about = ("Every arrow is the displacement of one window to the next frame, drawn twice as long; a cross is a "
             "measurement that was refused. Of a run with --dense the hue is the direction and its strength the "
             "length, as the wheel in the corner shows; where the picture is grey, no measurement had support enough "
             "around it.")
    shown = [*pictures(folder, "flow_*.png"), film(folder / "flow.mp4")]
    return [Section("Flow fields", paragraph(about) + row([s for s in shown if s])),
            Section("Motion of the picture", row([plot(fig, "median of the valid windows, pair by pair")])
                    + table(("", ""), lines))]
