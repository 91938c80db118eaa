# SPDX-License-Identifier: Apache-2.0
"""The report of `signum calibrate`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from signum.common.arrays import Floats
from signum.geometry.calibration import read_lens, read_rig
from signum.geometry.coverage import hints
from signum.geometry.document import read_entries
from signum.geometry.lens import Lens
from signum.report.page import Section, paragraph, plot, row, table
from signum.report.pictures import picture
from signum.report.read_table import Columns, read_table
from signum.tables.schemas import CORNERS, VIEWS

RINGS = 8
"""Rings round the middle in which residuals are averaged."""


def sections(folder: Path) -> list[Section]:
    """Each camera with its coverage and residuals, the pair, and the views."""
    path = folder / "calibration.yaml"
    views, corners = read_table(folder / "views.csv", VIEWS), read_table(folder / "corners.csv", CORNERS)
    cameras = list(views.groups("camera"))
    pair = read_rig(path) if len(cameras) == 2 else None
    entries = read_entries(path)
    out = []
    for camera in cameras:
        lens = pair.second if pair and camera == "right" else read_lens(path)
        out.append(_camera(folder, lens, views, corners, camera, f"_{camera}" * bool(pair)))
    if pair is not None:
        lines = [("baseline, m", f"{np.linalg.norm(pair.move):.4f}"),
                 ("corners from the computed ones, px RMS", f"{entries.tree.get('pair_rms_px', np.nan):.3f}"),
                 ("rows of a corner in the rectified pair, median difference, px",
                  f"{entries.tree.get('pair_rows_px', np.nan):.3f}"),
                 ("views", f"{entries.tree.get('pair_views_used', np.nan):.0f}")]
        about = ("Compare the baseline with a ruler: it tells whether the squares are as given. In the rectified pair "
                 "a point lies on the same line in both pictures.")
        out.append(Section("The pair", paragraph(about) + table(("", ""), lines)
                           + row([picture(folder / "rectified.png", "the rectified pair, with lines across")])))
    heads = "frame", "camera", "used", "corners", "residual, px RMS", "distance, m", "tilt, degrees"
    out.append(Section("Views", table(heads, list(zip(*(views.text[c] for c in VIEWS), strict=True)))))
    return out


def _camera(folder: Path, lens: Lens, views: Columns, corners: Columns, camera: str, suffix: str) -> Section:
    of_views = (views.numbers("used") > 0) & (np.array(views.text["camera"]) == camera)
    of_corners = (corners.numbers("used") > 0) & (np.array(corners.text["camera"]) == camera)
    at = np.stack([corners.numbers("x_px"), corners.numbers("y_px")], -1)[of_corners]
    off = np.stack([corners.numbers("dx_px"), corners.numbers("dy_px")], -1)[of_corners]
    rms = float(np.sqrt((off ** 2).sum(1).mean()))
    missing = hints(at, lens.size, views.numbers("tilt_deg")[of_views], rms)
    k = lens.matrix
    lines = [("pictures, px", f"{lens.size[0]} x {lens.size[1]}"),
             ("model", "fisheye" if lens.fisheye else f"pinhole, {len(lens.distortion)} coefficients"),
             ("focal length across and down, px", f"{k[0, 0]:.2f}, {k[1, 1]:.2f}"),
             ("principal point, px", f"{k[0, 2]:.2f}, {k[1, 2]:.2f}"),
             ("distortion coefficients", ", ".join(f"{c:.4g}" for c in lens.distortion)),
             ("field of view across and down, degrees", " x ".join(f"{a:.1f}" for a in field_of_view(lens))),
             ("corners from the computed ones, px RMS", f"{rms:.3f}"),
             ("views used, of those chosen", f"{of_views.sum()} of {(np.array(views.text['camera']) == camera).sum()}")]
    said = "".join(paragraph(hint) for hint in missing) or paragraph(
        "Coverage is good: views, corners, reach towards the picture's corners and tilt are as they should be.")
    shown = [picture(folder / f"coverage{suffix}.png", "green: corners of the used views; red: cells without any"),
             picture(folder / f"residuals{suffix}.png", "residuals, 50 times as long: without a pattern if the model "
                     "suits"),
             picture(folder / f"straight{suffix}.png", "a view, and the same without distortion: straight edges are "
                     "straight")]
    title = f"The {camera} camera" if suffix else "The camera"
    radial = plot(_radial(lens, at, off), "residuals away from the middle: a red curve that leaves 0 is what the model "
                  "cannot follow")
    return Section(title, said + table(("", ""), lines) + row(shown[:2]) + row([shown[2], radial]))


def field_of_view(lens: Lens) -> tuple[float, float]:
    """Angles between the outermost pixels' directions across and down through the principal point, degrees."""
    width, height = lens.size
    cx, cy = lens.matrix[0, 2], lens.matrix[1, 2]
    ends = lens.rays(np.array([[0, cy], [width - 1, cy], [cx, 0], [cx, height - 1]], np.float64))
    x, y = np.degrees(np.arctan(ends[:2, 0])), np.degrees(np.arctan(ends[2:, 1]))
    return float(np.ptp(x)), float(np.ptp(y))


def _radial(lens: Lens, at: Floats, off: Floats) -> Figure:
    """Residuals along the radius over the distance from the principal point, and their mean in rings."""
    from_middle = at - lens.matrix[:2, 2]
    radius = np.hypot(*from_middle.T)
    along = (off * from_middle).sum(1) / np.maximum(radius, 1e-9)
    fig, ax = plt.subplots(figsize=(6, 3))
    ax.plot(radius, along, ".", markersize=2, color="tab:gray")
    rings = np.array_split(np.argsort(radius), RINGS)
    ax.plot([radius[r].mean() for r in rings if r.size], [along[r].mean() for r in rings if r.size], "o-",
            color="tab:red", label="mean of a ring")
    ax.axhline(0, color="black", linewidth=0.6)
    ax.set(xlabel="distance from the principal point, px", ylabel="residual outwards, px")
    ax.legend(loc="upper left")
    return fig
