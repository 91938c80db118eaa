# SPDX-License-Identifier: Apache-2.0
"""Tracks: a camera circles over a floor and returns to where it began; features of every frame against its motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.report.page import Section, figure, row
from tests.compare.flows import lucas_kanade
from tests.compare.registers import LEAST_INLIERS, detector, matches
from tests.compare.table import WATERS, Column, Task, Tell, rms
from tests.tracks import FRAMES, NEAR_PX, Clip, judge

FEATURES = 60
"""Features kept alive by chains, about as many as Signum's tracker has."""
SPARSE = 4
"""Every so many frames descriptors are matched with the first one."""


@dataclass
class Walk:
    """What a method made of a clip: errors of its positions, pixels, frames that features lived, those right at the
    end."""

    errors: list[float] = field(default_factory=list)
    lives: list[int] = field(default_factory=list)
    home: int = 0

    def figures(self) -> tuple[float, float, float, float]:
        """Mean life, RMS, the largest error, those right at the end."""
        off = np.array(self.errors)
        return (float(np.mean(self.lives)) if self.lives else 0.0, rms(off), float(off.max()) if len(off) else math.nan,
                float(self.home))


Step = Callable[[Image, Image, Floats], Floats]
"""(frame, next one, points (n, 2)) -> places (n, 2), NaN where lost."""


def _lucas_kanade(a: Image, b: Image, at: Floats) -> Floats:
    return at + lucas_kanade(a, b, at)


def _dis(a: Image, b: Image, at: Floats) -> Floats:
    flow = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(a, b, None)  # type: ignore[call-overload]
    x, y = at.astype(np.float32).T
    step = [cv2.remap(np.ascontiguousarray(flow[..., k]), x[:, None], y[:, None], cv2.INTER_LINEAR)[:, 0]
            for k in (0, 1)]
    there = at + np.stack(step, 1)
    height, width = a.shape
    lost = (there < 8).any(axis=1) | (there[:, 0] > width - 9) | (there[:, 1] > height - 9)
    return np.where(lost[:, None], np.nan, there)


def chained(clip: Clip, murky: bool, step: Step) -> Walk:
    """Features followed from frame to frame, new ones found where some are lost."""
    walk = Walk()
    before = clip.frame(0, murky)
    born = _corners(before, np.zeros((0, 2)))
    first, now, ages = np.zeros(len(born), int), born.copy(), np.zeros(len(born), int)
    for k in range(1, len(clip)):
        frame = clip.frame(k, murky)
        now = step(before, frame, now)
        kept = np.isfinite(now).all(axis=1)
        walk.lives += ages[~kept].tolist()
        born, first, now, ages = born[kept], first[kept], now[kept], ages[kept] + 1
        off = [float(np.hypot(*(p - clip.moved(q, f, k)))) for p, q, f in zip(now, born, first, strict=True)]
        walk.errors += off
        if k == len(clip) - 1:
            walk.home = int(((np.array(off) <= NEAR_PX) & (first == 0)).sum())
        fresh = _corners(frame, now)
        born, now = np.vstack([born, fresh]), np.vstack([now, fresh])
        first, ages = np.append(first, np.full(len(fresh), k)), np.append(ages, np.zeros(len(fresh), int))
        before = frame
    walk.lives += ages.tolist()
    return walk


def _corners(frame: Image, near: Floats) -> Floats:
    """New features, away from the present ones."""
    wanted = FEATURES - len(near)
    if wanted <= 0:
        return np.zeros((0, 2))
    free = np.full(frame.shape, 255, np.uint8)
    free[:24], free[-24:], free[:, :24], free[:, -24:] = 0, 0, 0, 0
    for x, y in near:
        cv2.circle(free, (round(x), round(y)), 24, 0, -1)
    found = cv2.goodFeaturesToTrack(frame, wanted, 0.01, 24, mask=free)
    return np.zeros((0, 2)) if found is None else np.asarray(found[:, 0], np.float64)


def matched(clip: Clip, murky: bool, kind: str) -> Walk:
    """Descriptors of every fourth frame matched with the first one's, kept where a similarity bears them out."""
    walk = Walk()
    detect = detector(kind)
    points, words = detect(clip.frame(0, murky))
    seen = np.zeros(len(points), int)
    for k in [*range(SPARSE, len(clip) - 1, SPARSE), len(clip) - 1]:
        there, theirs = detect(clip.frame(k, murky))
        p, q = matches(words, theirs, kind)
        good = np.zeros(len(p), bool)
        if len(p) >= 4:
            _, inside = cv2.estimateAffinePartial2D(points[p], there[q], ransacReprojThreshold=3.0)
            if inside is not None and inside.sum() >= LEAST_INLIERS:
                good = inside[:, 0] > 0
        off = [float(np.hypot(*(there[j] - clip.moved(points[i], 0, k))))
               for i, j in zip(p[good], q[good], strict=True)]
        walk.errors += off
        seen[p[good]] += SPARSE
        if k == len(clip) - 1:
            walk.home = int((np.array(off) <= NEAR_PX).sum())
    walk.lives = seen.tolist()
    return walk


def compare_tracks(seed: int, quick: bool, tell: Tell) -> tuple[Task, Section]:
    """All methods on a clip in both waters."""
    clip = Clip("gravel", seed, 6, across=4.0) if quick else Clip("gravel", seed, FRAMES)
    task = Task("Tracks of a camera that returns to its start", (
        Column("mean life, frames", "{:.0f}", "more"), Column("error, RMS px", "{:.3f}", "less"),
        Column("largest, px", "{:.1f}", "less"),
        Column("first frame's features right at the end", "{:.0f}", "more")))
    chains: dict[str, Step] = {"Lucas-Kanade chain": _lucas_kanade, "DIS chain": _dis}
    for water in WATERS:
        murky = water != WATERS[0]
        with task.timed("Signum"):
            own = judge(clip, murky)
        task.note("Signum", water, own.life, own.rms, own.worst, own.home)
        tell(f"Signum, {water}")
        for name, step in chains.items():
            with task.timed(name):
                walk = chained(clip, murky, step)
            task.note(name, water, *walk.figures())
            tell(f"{name}, {water}")
        for kind in ("ORB", "SIFT"):
            name = f"{kind}, matched with the first frame"
            with task.timed(name):
                walk = matched(clip, murky, kind)
            task.note(name, water, *walk.figures())
            tell(f"{name}, {water}")
    text = (f"{len(clip)} frames of 640x480 over a quilt of gravel; the camera circles, turns by up to 8 degrees, "
            "rises and sinks, and ends where it began. Errors are those of a feature's place since its first frame. "
            f"Chains find new features where some are lost, to keep {FEATURES}. Descriptors are matched with the first "
            f"frame only, every {SPARSE} frames, and many more of them, so that their lives and numbers do not compare "
            "with the others'.")
    shown = row([figure(clip.frame(0, m), f"first frame, {w}") for m, w in ((False, WATERS[0]), (True, WATERS[1]))])
    return task, task.section(text, shown)
