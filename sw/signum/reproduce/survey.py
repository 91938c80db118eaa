# SPDX-License-Identifier: Apache-2.0
"""Surveys of many columns: how the error grows, perspective against parallel rays, real surveys against references."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from matplotlib import pyplot as plt

from signum.applications.mosaic.accuracy import pose_errors
from signum.applications.mosaic.simulate import Plan, simulate_survey
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.track_reader import read_track
from signum.boards.board import Board
from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table
from signum.reproduce import OpenBoard, Progress
from signum.reproduce.growth import METHODS, corner_errors, measure_grid
from signum.reproduce.projection import HEIGHTS, SIZE, Projection, compare_projections
from signum.reproduce.reference import SHARED, read_pairs, residuals
from signum.sources.open import open_source

SEEDS, SIDES = 20, range(3, 11)
WINDOW, SIGMA = 48, 2.0
PAIRS = 16
CORNERS = 4
METHOD_NAMES = {"a": "(a) sequential chain", "b": "(b) adjacent columns", "c": "(c) least squares over all edges"}
RUNS = "skerki", "imos/test1", "imos/test5"


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """Error growth, projections, and the real surveys where they are on this machine."""
    with open_board() as board:
        return [_growth(board, seed, quick, progress), _projection(board, seed, quick, progress),
                *_real(board, out, quick, progress)]


def registrar(board: Board, size: tuple[int, int], window: int, sigma: float) -> Registrar:
    """A registrar on a board for frames of a size."""
    def measurer(seen: tuple[int, int], wide: float) -> Measurer:
        return Measurer(board, seen, wide)

    return Registrar.on(measurer, Fit.to(size, board.config, window), window, sigma)


def _growth(board: Board, seed: int, quick: bool, progress: Progress) -> Section:
    sides = range(3, 5) if quick else SIDES
    seeds = 2 if quick else SEEDS
    plan = Plan(rows=max(sides), columns=max(sides))
    squares: dict[str, Floats] = {k: np.full((seeds, len(sides)), np.nan) for k in METHODS}
    spread, refused, measured_edges = [], 0, 0
    with progress("error growth", seeds) as tell:
        for k in range(seeds):
            flown = simulate_survey(plan, 1000 * seed + k)
            measured = measure_grid(flown, registrar(board, plan.size, WINDOW, SIGMA))
            refused, measured_edges = refused + measured.refused, measured_edges + len(measured.edges)
            spread.append(measured.errors)
            for j, side in enumerate(sides):
                found = [e for corner in range(CORNERS)
                         if (e := corner_errors(flown, measured, side, corner)) is not None]
                for method in METHODS if found else ():
                    squares[method][k, j] = np.mean([abs(e[method]) ** 2 for e in found])
            tell(f"seed {k}")
    variance = {m: np.nanmean(squares[m], axis=0) for m in METHODS}
    m = np.array(sides, float)
    edges = {"a": np.where(m % 2 == 0, m * (m - 1), m * m - 1), "b": 2 * (m - 1), "c": np.full(len(m), np.nan)}
    slope = {k: _slope(m, variance[k]) for k in METHODS}
    lines = [[METHOD_NAMES[k], *(f"{np.sqrt(v):.2f}" for v in variance[k]), f"{slope[k]:.2f}",
              "" if k == "c" else f"{_slope(edges[k], variance[k]):.2f}"] for k in METHODS]
    errors = np.vstack(spread)
    text = (
        f"{seeds} simulated surveys of {plan.rows}x{plan.columns} frames, rendered and registered through the board "
        f"({measured_edges} edges between neighbours, {refused} refused); no error model is put in. Every edge is off "
        f"by {errors[:, 0].std():.2f}, {errors[:, 1].std():.2f} px (standard deviations of x, y; means "
        f"{errors[:, 0].mean():.2f}, {errors[:, 1].mean():.2f}). The vehicle's heading wobbles by {plan.yaw_deg:g} "
        f"degree and its height by {plan.zoom:.0%}, which chains of offsets cannot represent. An m x m survey is the "
        f"m x m frames in a corner of the {plan.rows}x{plan.columns} ones, four to a seed, so the points of a curve "
        "share edges. In the paper the variance grows with the number of edges between the corners: m(m-1) to m^2-1 "
        "for (a), 2(m-1) for (b).")
    bars = [Bar("(c) over (b), RMS at the far corner, worst m", float(np.max(np.sqrt(variance["c"] / variance["b"]))),
                "<=", 1.0)]
    if not quick:
        bars += [Bar(f"{METHOD_NAMES[k]}: exponent of the variance in the number of edges, off the paper's 1",
                     abs(_slope(edges[k], variance[k]) - 1), "<=", 0.25) for k in ("a", "b")]
        bars += [Bar("(b) over (a), RMS at the far corner, m = 10",
                     float(np.sqrt(variance["b"][-1] / variance["a"][-1])), "<=", 1.0)]
    body = paragraph(text) + row([_curves(m, variance, slope)]) + table(
        ("RMS error at the far corner, px", *(f"m = {s}" for s in sides), "variance ~ m^", "~ edges^"), lines)
    return Section("Error growth over columns (figures 16 and 17)", body, tuple(bars))


def _slope(x: Floats, variance: Floats) -> float:
    return float(np.polyfit(np.log(x), np.log(variance), 1)[0])


def _curves(m: Floats, variance: dict[str, Floats], slope: dict[str, float]) -> str:
    fig, ax = plt.subplots(figsize=(7, 4.5))
    for method, colour in zip(METHODS, ("tab:red", "tab:blue", "tab:green"), strict=True):
        ax.loglog(m, variance[method], "o", color=colour)
        fit = np.exp(np.polyval(np.polyfit(np.log(m), np.log(variance[method]), 1), np.log(m)))
        ax.loglog(m, fit, "-", color=colour, label=f"{METHOD_NAMES[method]}: m^{slope[method]:.2f}")
    ax.set(xlabel="m", ylabel="variance at the far corner, px^2")
    ax.set_xticks(m, [f"{v:.0f}" for v in m])
    ax.minorticks_off()
    ax.legend(fontsize=8)
    return plot(fig, "squared error of the far corner's place, mean over seeds, with fitted powers of m")


def _projection(board: Board, seed: int, quick: bool, progress: Progress) -> Section:
    pairs = 4 if quick else PAIRS
    with progress("projections", len(HEIGHTS) + 1) as tell:
        views = compare_projections(registrar(board, SIZE, WINDOW, SIGMA), seed, pairs, tell)
    lines = [[v.label, f"{v.angle_deg:.0f}", f"{v.accepted:.0%}", f"{v.agreed:.0%}", f"{v.spread_px:.2f}",
              f"{v.rms_px:.2f}"] for v in views]
    text = ("The same floor with the same pixels on it, seen from different heights through lenses to match, and "
            "through parallel rays; frames half a frame apart are registered, truth is the step over the mean floor. "
            "Seen under perspective, what stands high moves further between two frames than what lies low, and its "
            "sides are seen from different directions; through parallel rays both frames show the same.")
    bars = (Bar("offset error, RMS, 90-degree lens over parallel rays", views[0].rms_px / views[-1].rms_px
                if views[0].accepted else float("inf"), ">=", 3.0),
            Bar("windows that agree, parallel rays less 90-degree lens, share", views[-1].agreed - views[0].agreed,
                ">=", 0.1))
    shown = [figure(_overlay(v), f"{v.label}: first frame red, second cyan, laid over each other as registered")
             for v in (views[0], views[2], views[-1])]
    return Section("Perspective against orthographic projection over relief (figure 13)", paragraph(text) + row(shown)
                   + table(("projection", "field of view, degrees", "pairs accepted", "windows that agree",
                            "windows off the similarity, RMS px", "offset error, RMS px"), lines), bars)


def _overlay(view: Projection) -> Image:
    """The second frame cyan, the first red, brought onto it."""
    first, second = view.pair
    moved = np.asarray(cv2.warpAffine(first, view.found.matrix, first.shape[::-1]), np.uint8)
    both = np.dstack([second, second, moved])
    top = max(0, round(float(view.found.shift.imag)))
    return np.ascontiguousarray(both[top:] if top < both.shape[0] - 20 else both)


def _real(board: Board, out: Path, quick: bool, progress: Progress) -> list[Section]:
    runs = [run for run in (RUNS[:1] if quick else RUNS) if (SHARED / run).exists()]
    if not runs:
        return [Section("Real surveys", paragraph("Not on this machine: ../shared/data holds none of skerki, imos."))]
    lines, shown, bars = [], [], []
    for run in runs:
        source = open_source(SHARED / run)
        with progress(run, source.count) as tell:
            survey = survey_of(source.label, board, out / run.replace("/", "-"), tell)
        piece = survey.ranked()[0]
        pairs = read_pairs(SHARED / run / "sift_pairs.csv")
        if len(piece.stored) == source.count:
            off = residuals(piece.places, pairs, survey.ledger.size)
        else:
            off = np.array([np.inf])
        edges = survey.ledger.accepted
        line = [run, f"{len(piece.stored)} of {source.count}", str(len(edges)), f"{off.mean():.2f}",
                f"{np.median(off):.2f}"]
        if run == "skerki":
            bars += [Bar("skerki: residual against the SIFT pairs, mean px", float(off.mean()), "<=", 6.0),
                     Bar("skerki: residual against the SIFT pairs, median px", float(np.median(off)), "<=", 4.5)]
            line.append("")
        else:
            truth = read_track(SHARED / "imos" / "georef.csv", source.label)
            error = pose_errors(survey.poses(piece), truth)
            rms = 100 * float(np.sqrt(np.mean(error.ape**2))) if len(error.ape) == source.count else float("inf")
            bars.append(Bar(f"{run}: frame centres against georef.csv, RMS cm", rms, "<=", 6.0))
            line.append(f"{rms:.1f}")
        lines.append(line)
        picture = np.asarray(cv2.imread(str(survey.out / "mosaic.png"), cv2.IMREAD_UNCHANGED), np.uint8)
        less = min(1.0, 900 / max(picture.shape[:2]))
        shown.append(figure(np.asarray(cv2.resize(picture, None, fx=less, fy=less, interpolation=cv2.INTER_AREA),
                                       np.uint8), run))
    heads = ("survey", "frames in one component", "edges", "SIFT residual: mean, px", "median, px", "georef RMS, cm")
    text = ("No columns are given: the frames are taken in order, edges to all neighbours are measured, and all are "
            "placed by least squares. Residuals are means over the quarter points of each pair's frame.")
    return [Section("Real surveys", paragraph(text) + row(shown) + table(heads, lines), tuple(bars))]


def survey_of(source: str, board: Board, out: Path, tell: Callable[[str], None] = lambda _: None) -> Survey:
    """Make the mosaic of a source as the command does."""
    frames = open_source(source)
    survey: Survey | None = None
    for frame in frames:
        if survey is None:
            survey = Survey(registrar(board, frame.size, 64, 2.5), out, not frames.snapshots, source=source)
        tell(survey.add(frame))
    assert survey is not None
    survey.settle()
    for _ in survey.finish():
        pass
    survey.close()
    return survey
