# SPDX-License-Identifier: Apache-2.0
"""Figure 7: features tracked against their initial image, and their remaining drift."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.measurer import Measurer, Query, View
from signum.measure.track import Tracker, TrackPoint, TrackSettings
from signum.report.draw import draw_tracks
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table
from signum.reproduce import OpenBoard, Progress
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.water import COASTAL
from signum.world.world import World

CAMERA = Pinhole()
RATE = 5.0
HEIGHT_M = 2.0
TRACK_WINDOW = 64
TRACK_SIGMA = 2.5
HOVER = "hovering: the view sways by up to a fifth of its width and comes back"
TRANSIT = "in transit at 0.2 m/s: every view is soon left"


@dataclass
class Drift:
    """Errors of a flight, pixels: of the tracker's valid positions by frames since the feature was chosen, and of a
    chain of frame-to-frame measurements of the same features."""

    ages: list[int] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    chain_ages: list[int] = field(default_factory=list)
    chain_errors: list[float] = field(default_factory=list)
    links: list[int] = field(default_factory=list)
    first: tuple[Image, list[TrackPoint]] | None = None
    last: tuple[Image, list[TrackPoint]] | None = None

    def within(self, px: float) -> float:
        """Share of the valid positions within `px` of the truth."""
        return float((np.array(self.errors) <= px).mean()) if self.errors else 0.0


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """Two simulated flights, with the truth of every feature."""
    frames = 24 if quick else 300
    runs: dict[str, Drift] = {}
    with progress("tracking", 2 * frames) as tell:
        for name in (HOVER, TRANSIT):
            with open_board() as board, open_board() as other:
                measurers = Measurer(board, CAMERA.size, TRACK_SIGMA), Measurer(other, CAMERA.size, TRACK_SIGMA)
                runs[name] = _fly(*measurers, name == HOVER, frames, seed, tell)
    sections = []
    for name, run in runs.items():
        assert run.first is not None and run.last is not None
        errors, chain = np.array(run.errors), np.array(run.chain_errors)
        late = np.array(run.ages) > 0.8 * max(run.ages)
        lines = [
            ("valid measurements", str(len(errors))), ("median error, px", f"{np.median(errors):.2f}"),
            ("98 % are within, px", f"{np.percentile(errors, 98):.2f}"),
            ("the oldest fifth of them: median error, px", f"{np.median(errors[late]):.2f}"),
            ("measurements in the chain behind a position, mean", f"{np.mean(run.links):.1f}"),
            ("frame-to-frame sums, median error at the end, px",
             f"{np.median(chain[np.array(run.chain_ages) > 0.8 * max(run.chain_ages)]):.2f}")]
        body = paragraph(f"A camera {name}. Turbid water, lamp, snow, relief; {frames} frames at {RATE:g} Hz.")
        body += row([figure(draw_tracks(*run.first, TRACK_WINDOW), "initial image"),
                     figure(draw_tracks(*run.last, TRACK_WINDOW), "last image"), _plot(run)])
        body += table(("", ""), lines) + paragraph(_statement(run))
        sections.append(Section(
            f"Figure 7: feature tracking, {name.split(':')[0]}", body,
            (Bar("valid positions within 2 px of the truth, share", run.within(2.0), ">=", 0.98),)))
    return sections


def _statement(run: Drift) -> str:
    ages = np.array(run.ages) / RATE
    growth = float(np.polyfit(ages, run.errors, 1)[0]) * ages.max()
    single = np.mean(np.array(run.links) <= 1)
    return (f"Drift: {single:.0%} of the positions rest on one measurement against the initial image and cannot drift. "
            f"Over the {ages.max():.0f} s that a feature stays in view at most, all errors grow by {growth:+.2f} px.")


def _sight(hover: bool, time: float) -> Sight:
    if hover:
        sway = 0.18 * np.sin(2 * np.pi * time / 11), 0.22 * np.sin(2 * np.pi * time / 17)
        turn = 0.03 * np.sin(2 * np.pi * time / 23)
        position = np.array([sway[0], sway[1], -HEIGHT_M + 0.05 * np.sin(2 * np.pi * time / 9)])
    else:
        position, turn = np.array([0.2 * time - 4.0, 0.05 * np.sin(time / 3), -HEIGHT_M]), 0.02 * np.sin(time / 5)
    return Sight(position, rotation(0.01 * np.sin(time / 2), 0.01 * np.cos(time / 3), turn) @ LOOK_DOWN)


def _fly(measurer: Measurer, plain: Measurer, hover: bool, frames: int, seed: int, tell: Callable[[str], None]
         ) -> Drift:
    """Fly: the tracker uses one measurer, the sums of frame-to-frame displacements the other."""
    world = World(Seafloor(extent=12.0, relief=0.04, texel=0.005, seed=seed), COASTAL, seed=seed)
    tracker = Tracker(measurer, TrackSettings(window=TRACK_WINDOW, features=12))
    run = Drift()
    ground: dict[int, tuple[int, Floats]] = {}
    summed: dict[int, Floats] = {}
    before: View | None = None
    for k in range(frames):
        sight = _sight(hover, k / RATE)
        shot = world.look(CAMERA, sight)
        points = tracker.step(shot.frame)
        live = plain.view(shot.frame)
        if before is not None:
            _sum(plain, before, live, summed)
            plain.release(before)
        before = live
        for p in points:
            if p.feature not in ground:
                ground[p.feature] = k, _on_ground(sight, shot.depth, p.x, p.y)
                summed[p.feature] = np.array([p.x, p.y])
                continue
            born, place = ground[p.feature]
            true = CAMERA.project(sight, place)[0]
            if p.valid:
                run.ages.append(k - born)
                run.links.append(p.links)
                run.errors.append(float(np.hypot(p.x - true[0], p.y - true[1])))
        for number, at in summed.items():
            born, place = ground[number]
            if k > born and np.isfinite(at).all():
                run.chain_ages.append(k - born)
                run.chain_errors.append(float(np.hypot(*(at - CAMERA.project(sight, place)[0]))))
        run.first = run.first or (shot.frame, points)
        run.last = shot.frame, points
        world.step(1 / RATE)
        tell(f"{sum(p.valid for p in points)} valid")
    return run


def _on_ground(sight: Sight, depth: NDArray[np.float32], x: float, y: float) -> Floats:
    """The world point (3,) at a pixel."""
    z = float(depth[round(y), round(x)])
    ray = np.array([(x - CAMERA.centre[0]) / CAMERA.focal, (y - CAMERA.centre[1]) / CAMERA.focal, 1.0])
    return np.asarray(sight.position + sight.rotation @ (z * ray), np.float64)


def _sum(measurer: Measurer, before: View, live: View, summed: dict[int, Floats]) -> None:
    """For comparison, sum up displacements from frame to frame; a feature lost once stays lost (NaN)."""
    kept = [n for n, at in summed.items() if np.isfinite(at).all()]
    places = [np.rint(summed[n]).astype(int) for n in kept]
    queries = [Query(before, live, int(x), int(y), TRACK_WINDOW, TRACK_WINDOW, reach=(24, 24)) for x, y in places]
    for number, m in zip(kept, measurer.measure(queries), strict=True):
        summed[number] = summed[number] + (m.dx_px, m.dy_px) if m.valid else np.full(2, np.nan)


def _plot(run: Drift) -> str:
    fig, ax = plt.subplots(figsize=(5, 3.4))
    ax.plot(np.array(run.chain_ages) / RATE, run.chain_errors, ".", ms=2, color="0.7", label="frame to frame, summed")
    ax.plot(np.array(run.ages) / RATE, run.errors, ".", ms=2, color="tab:green", label="against the initial image")
    ax.set(xlabel="seconds since the feature was chosen", ylabel="error, px", ylim=(0, 4))
    ax.legend(loc="upper left", markerscale=4)
    return plot(fig, "error against the truth")
