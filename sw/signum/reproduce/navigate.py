# SPDX-License-Identifier: Apache-2.0
"""Mosaic navigation: kidnapped starts, frames of other floors, and "look at that", on a simulated pan/tilt."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.applications.navigate.chart import Chart
from signum.applications.navigate.draw import draw_path
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.simulate.pan_tilt import PanTiltScene, PanTiltSite, Step, miss
from signum.applications.navigate.simulate.truth import random_target
from signum.boards.board import Board
from signum.frames.fit import Fit
from signum.measure.measurer import Measurer
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table
from signum.reproduce import OpenBoard, Progress
from signum.world.seafloor import PHOTOS

FLOORS = (*PHOTOS, *PHOTOS[:2])
"""Photographs on the floors, each floor with a seed of its own."""
TARGETS, KIDNAPS, STRANGE = 10, 20, 20
"""Per floor: targets, kidnapped starts, frames of another floor."""
SETTLED = 10
"""Frames at the end of a path; its final error is the largest among them."""
WRONG = 0.05
"""Error above which a place that is reported as known is wrong, as a share of the view."""


@dataclass
class Tally:
    """Outcomes over all floors; errors are shares of the view's width."""

    finals: list[float] = field(default_factory=list)
    reached: int = 0
    starts: list[float] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    recovered: int = 0
    kidnaps: int = 0
    wrong: int = 0
    strange: int = 0
    mistaken: int = 0
    misses: list[float] = field(default_factory=list)
    ways: list[list[Step]] = field(default_factory=list)


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """A mosaic per floor; on each, targets, kidnapped starts and frames of another floor."""
    floors = FLOORS[:1] if quick else FLOORS
    targets, kidnaps, strange = (2, 6, 4) if quick else (TARGETS, KIDNAPS, STRANGE)
    sweep = (0.27, 0.18) if quick else PanTiltScene().sweep
    tally, shown = Tally(), []
    with progress("navigate", len(floors) * (1 + targets + kidnaps + strange)) as tell:
        for k, floor in enumerate(floors):
            site = PanTiltSite(PanTiltScene(seed=seed + k, photo=floor, sweep=sweep))
            other = PanTiltSite(PanTiltScene(seed=seed + k + 100, photo=floor, sweep=sweep))
            with open_board() as board:
                measurer = _maker(board)
                chart = site.survey(measurer, out / f"mosaic_{k}")
                tell(f"mosaic of {floor}")
                largest = board.config.max_width, board.config.max_height
                localiser = Localiser(measurer, largest, Fit(site.size, site.size), chart)
                rng = np.random.default_rng([seed, k, 21])
                first = len(tally.ways)
                for _ in range(targets):
                    _go(site, chart, localiser, rng, tally)
                    tell(f"final error {100 * tally.finals[-1]:.2f} % of the view")
                for _ in range(kidnaps):
                    _kidnap(site, chart, localiser, rng, tally)
                    tell(f"{tally.recovered} of {tally.kidnaps} recovered")
                for _ in range(strange):
                    tally.strange += 1
                    tally.mistaken += localiser.locate(other.look(other.random_head(rng))).known
                    other.world.step(1.0)
                    tell(f"{tally.mistaken} of {tally.strange} strange frames mistaken")
            if k < 3:
                shown.append(_picture(chart, site, tally.ways[first]))
    bars = (
        Bar("targets reached, share", tally.reached / len(tally.finals), ">=", 1.0),
        Bar("final error, worst of all targets, % of the view", 100 * max(tally.finals), "<=", 1.0),
        Bar("kidnapped starts recovered, share", tally.recovered / tally.kidnaps, ">=", 0.95),
        Bar("confident wrong places", tally.wrong + tally.mistaken, "<=", 0.0))
    lines = [
        ("targets, each from an unknown start", str(len(tally.finals))),
        ("distance at the start, share of the view: median, largest",
         f"{np.median(tally.starts):.2f}, {max(tally.starts):.2f}"),
        ("seconds to the target: median, largest", f"{np.median(tally.times):.1f}, {max(tally.times):.1f}"),
        ("final error, % of the view: median, worst",
         f"{100 * np.median(tally.finals):.2f}, {100 * max(tally.finals):.2f}"),
        ("kidnapped starts; error of the place, % of the view: median, worst",
         f"{tally.kidnaps}; {100 * np.median(tally.misses):.2f}, {100 * max(tally.misses):.2f}"),
        ("frames of a floor not in the mosaic; mistaken for a place in it", f"{tally.strange}; {tally.mistaken}")]
    body = paragraph(
        "A camera on a pan/tilt, 2 m above a floor with relief, in turbid water with a lamp and snow, sweeps back and "
        "forth and makes a mosaic of five times its view. Its pictures are first projected stereographically, with "
        "its known focal length. Then it is turned to an unknown direction, and has to find where it looks and to turn "
        "to a given target. No angle is measured: every frame is found in the mosaic itself.")
    return [Section("Mosaic navigation: look at that", body + row(shown) + row([_plot(tally)]) + table(("", ""), lines),
                    bars)]


def _maker(board: Board) -> Callable[[tuple[int, int], float], Measurer]:
    return lambda size, sigma: Measurer(board, size, sigma)


def _go(site: PanTiltSite, chart: Chart, localiser: Localiser, rng: np.random.Generator, tally: Tally) -> None:
    target, head = random_target(chart, site.size, rng), site.random_head(rng)
    way = list(site.go(localiser, target, head))
    view = site.size[0]
    errors = [float(np.hypot(*step.truth)) / view for step in way]
    final = max(errors[-SETTLED:])
    tally.finals.append(final)
    tally.reached += way[-1].aim.sharp and final <= 0.01
    tally.starts.append(errors[0])
    tally.times.append(way[-1].time)
    tally.ways.append(way)


def _kidnap(site: PanTiltSite, chart: Chart, localiser: Localiser, rng: np.random.Generator, tally: Tally) -> None:
    head = site.random_head(rng)
    place = localiser.locate(site.look(head))
    site.world.step(1.0)
    tally.kidnaps += 1
    if place.known:
        off = miss(site, chart, place, head) / site.size[0]
        tally.wrong += off > WRONG
        tally.recovered += off <= WRONG
        tally.misses.append(off)


def _picture(chart: Chart, site: PanTiltSite, way: list[Step]) -> str:
    last = way[-1].aim.place.similarity
    centres = [step.aim.place.centre for step in way]
    target = None if last is None else tuple(last(way[-1].aim.error + (np.array(site.size) - 1) / 2))
    return figure(draw_path(chart, centres, last, site.size, target), "path (yellow), last view, target (red)")


def _plot(tally: Tally) -> str:
    fig, ax = plt.subplots(figsize=(9, 3))
    for way in tally.ways:
        ax.semilogy([s.time for s in way], [max(float(np.hypot(*s.truth)), 0.05) for s in way], lw=0.7)
    ax.set(xlabel="seconds", ylabel="true error, px")
    return plot(fig, "true distance from the target, every path")
