# SPDX-License-Identifier: Apache-2.0
"""The report of `signum track`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.report.page import Section, paragraph, plot, row, table
from signum.report.pictures import picture
from signum.report.read_table import Columns, read_table
from signum.tables.schemas import DRIFT, TRACK


def sections(folder: Path) -> list[Section]:
    """Tracks, and the estimate of their drift."""
    tracks = read_table(folder / "track.csv", TRACK)
    valid = tracks.numbers("valid") > 0
    frames, features = tracks.groups("frame"), tracks.groups("feature")
    lives = [int(valid[rows].sum()) for rows in features.values()]
    lines = [("frames", str(len(frames))), ("features", str(len(features))), ("measurements", str(tracks.rows)),
             ("valid", f"{valid.mean():.1%}" if tracks.rows else "none"),
             ("frames in which a feature is valid: median, largest",
              f"{np.median(lives):.0f}, {max(lives)}" if lives else "none")]
    shown = [_picture(folder), _counts(tracks)]
    out = [Section("Features tracked against the image they were chosen in", row([p for p in shown if p])
                   + table(("", ""), lines))]
    if (folder / "drift.csv").exists():
        out.append(Section("Drift", _drift(read_table(folder / "drift.csv", DRIFT))))
    return out


def _picture(folder: Path) -> str:
    path = folder / "track.png"
    return picture(path, "the last frame: green where valid, with its path") if path.exists() else ""


def _counts(tracks: Columns) -> str:
    valid, score = tracks.numbers("valid") > 0, tracks.numbers("score")
    rows = list(tracks.groups("frame").values())
    fig, axes = plt.subplots(2, 1, figsize=(6, 4), sharex=True)
    axes[0].plot([int(valid[r].sum()) for r in rows], color="tab:green")
    axes[0].set(ylabel="valid features", ylim=(0, None))
    axes[1].plot([float(np.median(score[r][valid[r]])) if valid[r].any() else np.nan for r in rows])
    axes[1].set(ylabel="median score", xlabel="frame", ylim=(0.5, 1))
    return plot(fig, "valid features and their matching fraction, frame by frame")


def _drift(drift: Columns) -> str:
    valid, direct = drift.numbers("valid"), drift.numbers("direct")
    error, links = drift.numbers("error_px"), drift.numbers("links")
    total = float(valid.sum())
    if not total:
        return paragraph("No position is valid, so none can drift.")
    share = float(direct.sum()) / total
    text = (f"{share:.1%} of the {total:.0f} valid positions rest on one measurement against the image the feature was "
            "chosen in: these cannot drift, however long the run. ")
    text += "" if share == 1 else (
        f"The others were measured against a later image, whose own position adds its error: chains of up to "
        f"{np.nanmax(links):.0f} measurements. ")
    text += (f"By the tracker's own estimate 98 % of the positions are within {np.nanmax(error):.2f} original pixels "
             f"of the truth in the worst frame, {np.nanmedian(error):.2f} in the median one; a position beyond that is "
             "flagged (valid 0), and a new feature takes its place.")
    fig, ax = plt.subplots(figsize=(6, 3))
    ax.plot(error, color="tab:red")
    ax.set(xlabel="frame", ylabel="px", ylim=(0, None))
    return paragraph(text) + row([plot(fig, "error that 98 % of the positions are within, as the tracker estimates")])
