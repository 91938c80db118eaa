# SPDX-License-Identifier: Apache-2.0
"""The report of `signum flow`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.page import Section, paragraph, plot, row, table
from signum.report.pictures import film, pictures
from signum.report.read_table import read_table
from signum.tables.schemas import FLOW, MOVING


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
    found = [Section("Flow fields", paragraph(about) + row([s for s in shown if s])),
             Section("Motion of the picture", row([plot(fig, "median of the valid windows, pair by pair")])
                     + table(("", ""), lines))]
    return [*found, *([_moving(folder, list(flow.groups("frame_b")))] if (folder / "moving.csv").exists() else [])]


def _moving(folder: Path, pairs: list[str]) -> Section:
    """What moves by itself, of pairs that are named by their second frames."""
    moving = read_table(folder / "moving.csv", MOVING)
    number = {name: n for n, name in enumerate(pairs)}
    at = [number.get(name, -1) for name in moving.text["frame_b"]]
    speed = np.hypot(moving.numbers("own_dx_px"), moving.numbers("own_dy_px"))
    area, sure = moving.numbers("area_px"), moving.numbers("confidence")
    lines = [("objects, over all pairs of frames", str(moving.rows)), ("pairs of frames with any", str(len(set(at))))]
    if moving.rows:
        lines += [("own motion, px per frame: median, largest", f"{np.median(speed):.1f}, {speed.max():.1f}"),
                  ("area, px: median, largest", f"{np.median(area):,.0f}, {area.max():,.0f}")]
    fig, axis = plt.subplots(figsize=(9, 2.8))
    shown = axis.scatter(at, speed, s=np.clip(np.sqrt(area), 8, 200), c=sure, vmin=0, vmax=100, cmap="viridis")
    fig.colorbar(shown, label="confidence")
    axis.set(ylabel="own motion, px per frame", xlabel="pair of frames", xlim=(-0.5, len(pairs) - 0.5))
    axis.set_ylim(0, 1.15 * max(speed.max(initial=0.0), 1.0))
    about = ("What moves otherwise than most of the picture; outlined in the pictures above, with its motion against "
             "the background, drawn twice as long, and masked below. Something at rest that is much nearer or farther "
             "than the rest shifts against it when the camera moves, and counts too.")
    return Section("What moves by itself", paragraph(about) + row(pictures(folder, "moving_*.png"))
                   + row([plot(fig, "every object, as large as its side")]) + table(("", ""), lines))
