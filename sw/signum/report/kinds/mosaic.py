# SPDX-License-Identifier: Apache-2.0
"""The report of `signum mosaic`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D

from signum.report.page import Section, plot, row, table
from signum.report.pictures import picture
from signum.report.read_table import Columns, read_table
from signum.tables.schemas import EDGES, POSES

COLOURS = {"sequence": "tab:blue", "loop": "tab:green", "join": "tab:orange", "live": "tab:cyan"}
SMALLEST = 1e-6
"""Smallest scale of a frame that a mosaic can have, and one over the largest; a damaged table may have others."""


def sections(folder: Path) -> list[Section]:
    """The mosaic, its pose graph, how well the edges agree, and the errors where the truth is known."""
    edges = read_table(folder / "edges.csv", EDGES)
    files = sorted(folder.glob("poses*.csv"), key=lambda p: (len(p.stem), p.stem))
    pieces = [read_table(file, POSES) for file in files]
    accepted = edges.numbers("accepted") > 0
    kinds = edges.text.get("kind", ["sequence"] * edges.rows)
    lines = [("frames placed", str(sum(p.rows for p in pieces))), ("components", str(len(pieces)))]
    for kind in dict.fromkeys(kinds):
        of = np.array([k == kind for k in kinds])
        lines.append((f"edges, {kind}: accepted of measured", f"{int((accepted & of).sum())} of {int(of.sum())}"))
    residuals = np.concatenate([_residuals(edges, piece) for piece in pieces]) if pieces else np.empty(0)
    if len(residuals):
        lines.append(("residuals of accepted edges: median, 95th percentile, largest, px",
                      f"{np.median(residuals):.1f}, {np.percentile(residuals, 95):.1f}, {residuals.max():.1f}"))
    shown = [picture(folder / f"mosaic{file.stem.removeprefix('poses')}.png", f"mosaic of {piece.rows} frames")
             for file, piece in list(zip(files, pieces, strict=True))[:4]
             if (folder / f"mosaic{file.stem.removeprefix('poses')}.png").exists()]
    out = [Section("Mosaic", row(shown) + table(("", ""), lines))]
    if pieces and pieces[0].rows > 1:
        out.append(Section("Pose graph", row([_graph(edges, pieces[0], kinds), _hist(residuals)])))
    if (folder / "accuracy.csv").exists():
        errors = read_table(folder / "accuracy.csv")
        body = [[errors.text[name][i] for name in errors.names] for i in range(errors.rows)]
        out.append(Section("Against the truth", table(errors.names, body)))
    refused = [[edges.text[n][i] for n in ("frame_a", "frame_b")] + [kinds[i], edges.text["reason"][i]]
               for i in range(edges.rows) if not accepted[i]][:200] if "reason" in edges.text else []
    if refused:
        out.append(Section("Refused edges", table(("frame a", "frame b", "kind", "reason"), refused)))
    return out


def _centres(piece: Columns) -> dict[str, complex]:
    return dict(zip(piece.text["frame"], piece.numbers("x_px") + 1j * piece.numbers("y_px"), strict=True))


def _residuals(edges: Columns, piece: Columns) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Distance, pixels of b, from a's centre by an accepted edge to a's centre by the poses: (edges,)."""
    at = _centres(piece)
    turn = dict(zip(piece.text["frame"], piece.numbers("scale") * np.exp(1j * np.radians(piece.numbers("rot_deg"))),
                    strict=True))
    dx, dy, good = edges.numbers("dx_px"), edges.numbers("dy_px"), edges.numbers("accepted") > 0
    out = [abs((at[a] - at[b]) / turn[b] - complex(dx[i], dy[i]))
           for i, (a, b) in enumerate(zip(edges.text["frame_a"], edges.text["frame_b"], strict=True))
           if good[i] and a in at and b in at and SMALLEST <= abs(turn[b]) <= 1 / SMALLEST]
    residuals = np.array(out, np.float64)
    return residuals[np.isfinite(residuals)]


def _graph(edges: Columns, piece: Columns, kinds: list[str]) -> str:
    at = _centres(piece)
    good = edges.numbers("accepted") > 0
    fig, ax = plt.subplots(figsize=(6, 6))
    shown = [i for i in sorted(range(edges.rows), key=lambda k: bool(good[k]))
             if edges.text["frame_a"][i] in at and edges.text["frame_b"][i] in at]
    labels = [kinds[i] if good[i] else "refused" for i in shown]
    ends = [[(z.real, z.imag) for z in (at[edges.text[name][i]] for name in ("frame_a", "frame_b"))] for i in shown]
    styles: dict[str, dict[str, Any]] = {
        label: {"color": COLOURS.get(label, "tab:red"), "lw": 1.2, "alpha": 0.9} for label in labels}
    if "refused" in styles:
        styles["refused"] |= {"lw": 0.5, "alpha": 0.4}
    ax.add_collection(LineCollection(
        ends, colors=[to_rgba(styles[label]["color"], styles[label]["alpha"]) for label in labels],
        linewidths=[styles[label]["lw"] for label in labels], capstyle="projecting", joinstyle="round", zorder=2))
    x, y = [z.real for z in at.values()], [z.imag for z in at.values()]
    ax.plot(x, y, "k.", ms=4)
    ax.set(xlabel="x, px", ylabel="y, px")
    ax.set_aspect("equal", adjustable="datalim")
    ax.invert_yaxis()
    if styles:
        ax.legend([Line2D([], [], **style) for style in styles.values()], list(styles), fontsize=8)
    return plot(fig, "frame centres in the mosaic plane and the edges between them")


def _hist(residuals: np.ndarray[tuple[int], np.dtype[np.float64]]) -> str:
    fig, ax = plt.subplots(figsize=(5, 4))
    ax.hist(residuals, bins=30, color="tab:blue")
    ax.set(xlabel="residual, px", ylabel="accepted edges")
    return plot(fig, "residuals of the accepted edges against the poses")
