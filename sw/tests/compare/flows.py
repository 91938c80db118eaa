# SPDX-License-Identifier: Apache-2.0
"""Optical flow: photographs shifted by known amounts, and a camera that moves over rendered relief."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import cv2
import numpy as np

from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer
from signum.report.page import Section, figure, row
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor, photograph
from signum.world.world import World
from tests.compare.table import WATERS, Column, Task, Tell, in_water, rms

SIZE = 384, 288
WINDOW, STEP, SIGMA = 64, 32, 1.5
MOST_PX = 8.0
"""Largest shift along an axis, pixels."""
FAR_PX = 1.0
"""Error of an outlier, pixels."""
Flow = Callable[[Image, Image, Floats], Floats]
"""(earlier, later, points (n, 2)) -> displacements (n, 2), NaN where the method refuses."""
Pair = tuple[str, Image, Image, Floats]
"""What it shows, the earlier and the later picture, the true displacement (n, 2) at `points`."""


def points() -> Floats:
    """Where flow is judged: the centres of Signum's windows, (n, 2)."""
    x, y = (np.arange(WINDOW // 2, n - WINDOW // 2 + 1, STEP) for n in SIZE)
    return np.stack(np.meshgrid(x, y), -1).reshape(-1, 2).astype(np.float64)


def signum(a: Image, b: Image, at: Floats) -> Floats:
    """The golden board."""
    with GoldenBoard() as board:
        measurer = Measurer(board, SIZE, SIGMA)
        found = measure_flow(measurer, measurer.view(a), measurer.view(b), (WINDOW, WINDOW), STEP, support=1)
    return np.stack([found.dx, found.dy], -1).reshape(-1, 2)


def lucas_kanade(a: Image, b: Image, at: Floats) -> Floats:
    """Pyramidal, windows of 21, with the usual check forward and backward to 1 pixel."""
    start = at.astype(np.float32)[:, None]
    there, good, _ = cv2.calcOpticalFlowPyrLK(a, b, start, None, winSize=(21, 21), maxLevel=3)  # type: ignore[call-overload]
    back, again, _ = cv2.calcOpticalFlowPyrLK(b, a, there, None, winSize=(21, 21), maxLevel=3)  # type: ignore[call-overload]
    off = (there - start)[:, 0].astype(np.float64)
    bad = (good[:, 0] == 0) | (again[:, 0] == 0) | (np.hypot(*(back - start)[:, 0].T) > 1)
    return np.where(bad[:, None], np.nan, off)


def dense_inverse_search(a: Image, b: Image, at: Floats) -> Floats:
    """DIS with its preset MEDIUM; it refuses nothing."""
    field = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(a, b, None)  # type: ignore[call-overload]
    return np.asarray(field[at[:, 1].astype(int), at[:, 0].astype(int)], np.float64)


def phase_correlation(a: Image, b: Image, at: Floats) -> Floats:
    """Of the same windows as Signum's, with a Hann window; it refuses nothing."""
    half, hann = WINDOW // 2, cv2.createHanningWindow((WINDOW, WINDOW), cv2.CV_32F)
    out = []
    for x, y in at.astype(int):
        here = np.s_[y - half:y + half, x - half:x + half]
        out.append(cv2.phaseCorrelate(a[here].astype(np.float32), b[here].astype(np.float32), hann)[0])
    return np.array(out)


METHODS: dict[str, Flow] = {"Signum": signum, "pyramidal Lucas-Kanade": lucas_kanade, "DIS": dense_inverse_search,
                            "phase correlation": phase_correlation}


def pairs(seed: int, quick: bool) -> Iterator[Pair]:
    """Photographs, then rendered scenes."""
    rng = np.random.default_rng([seed, 31])
    at = points()
    for name in ("gravel",) if quick else ("gravel", "grass", "brick"):
        photo = photograph(name).astype(np.float32)
        for _ in range(1 if quick else 4):
            shift = rng.uniform(-MOST_PX, MOST_PX, 2)
            shots = [np.asarray(np.clip(cv2.warpAffine(photo, np.array([[1, 0, x - 60], [0, 1, y - 60]]), SIZE,
                                                       flags=cv2.INTER_CUBIC), 0, 255), np.uint8)
                     for x, y in (np.zeros(2), shift)]
            yield name, shots[0], shots[1], np.tile(shift, (len(at), 1))
    camera = Pinhole(SIZE)
    for k in range(0 if quick else 3):
        world = World(Seafloor(extent=6.0, relief=0.1, seed=100 * seed + k), seed=100 * seed + k)
        sights = [Sight(np.array([*(rng.uniform(-0.03, 0.03, 2) * i), -2 + 0.02 * i]),
                        rotation(*(rng.normal(0, 0.004, 3) * i)) @ LOOK_DOWN) for i in (0, 1)]
        first, second = (world.look(camera, sight) for sight in sights)
        depth = first.depth[at[:, 1].astype(int), at[:, 0].astype(int)].astype(np.float64)
        seen = camera.project(sights[1], camera.unproject(sights[0], at, depth))
        yield "relief", first.frame, second.frame, seen - at


def compare_flow(seed: int, quick: bool, tell: Tell) -> tuple[Task, Section]:
    """All methods on all pairs."""
    task = Task("Optical flow over known shifts", (
        Column("points measured", "{:.0%}", "more"), Column("error, RMS px", "{:.3f}", "less"),
        Column(f"beyond {FAR_PX:g} px", "{:.1%}", "less")))
    at, all_pairs, shown = points(), list(pairs(seed, quick)), []
    for water in WATERS:
        for name, method in METHODS.items():
            errors = []
            for k, (_, a, b, truth) in enumerate(all_pairs):
                dull = [in_water(p, water, 1000 * seed + 2 * k + i) for i, p in enumerate((a, b))]
                with task.timed(name):
                    found = method(dull[0], dull[1], at)
                errors.append(np.hypot(*(found - truth).T))
                if k == 0 and name == "Signum":
                    shown.append(figure(dull[0], f"{all_pairs[0][0]}, {water}"))
            off = np.concatenate(errors)
            good = off[np.isfinite(off)]
            task.note(name, water, np.isfinite(off).mean(), rms(good), (good > FAR_PX).mean())
            tell(f"{name}, {water}")
    names = [n for n, *_ in all_pairs]
    what = ", ".join(f"{names.count(n)} of {n}" for n in dict.fromkeys(names))
    text = (f"{len(all_pairs)} pairs of 384x288 ({what}), moved by up to {MOST_PX:g} pixels along each axis; judged at "
            f"the same {len(at)} points. Pictures in figure 8's water have snow of their own each.")
    return task, task.section(text, row(shown))
