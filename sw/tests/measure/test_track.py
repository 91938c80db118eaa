# SPDX-License-Identifier: Apache-2.0
"""Tracking on real seabed against references made with OpenCV, and its policy on made-up motion."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
import skimage.data
from numpy.typing import NDArray

from golden.params import FULL
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.common.files import write_picture
from signum.frames.fit import Fit
from signum.measure.measurer import Measurer
from signum.measure.track import PRECISE_PX, Tracker, TrackPoint, TrackSettings
from signum.sources.files import FolderSource
from signum.sources.open import open_source
from tests.tracks import Clip, judge

DATA = Path(__file__).resolve().parents[4] / "shared" / "data"
NEAR_PX = 2.0


def _track(frames: Sequence[Image], fit: Fit, features: int = 30) -> list[list[TrackPoint]]:
    with GoldenBoard() as board:
        wanted = TrackSettings(features=features, precise_px=PRECISE_PX / max(fit.factor))
        tracker = Tracker(Measurer(board, fit.board, 2.5), wanted)
        return [tracker.step(fit.show(frame)) for frame in frames]


class _Reference:
    """Displacements of a point between two frames: SIFT matches around it, fitted affine, then ECC from there.

    Both must agree, or there is no reference: either alone is off by more than a pixel now and then.
    """

    def __init__(self, frames: Sequence[Image]) -> None:
        self.frames = frames
        sift = cv2.SIFT_create(2500, contrastThreshold=0.01)  # type: ignore[attr-defined]
        self._features = cache(lambda t: sift.detectAndCompute(frames[t], None))
        self._matches = cache(self._match)

    def _match(self, a: int, b: int) -> tuple[Floats, Floats]:
        (ka, da), (kb, db) = self._features(a), self._features(b)
        pairs = [m for m, *n in cv2.BFMatcher().knnMatch(da, db, 2) if n and m.distance < 0.8 * n[0].distance]
        return (np.array([ka[m.queryIdx].pt for m in pairs]).reshape(-1, 2),
                np.array([kb[m.trainIdx].pt for m in pairs]).reshape(-1, 2))

    def displacement(self, a: int, b: int, at: Floats, radius: float = 60, half: int = 24) -> Floats | None:
        """Where the point `at` of frame a moved until frame b, minus `at`; None where that cannot be told."""
        here, there = self._matches(a, b)
        near = np.hypot(*(here - at).T) < radius
        if near.sum() < 8:
            return None
        model, inliers = cv2.estimateAffine2D(here[near] - at, there[near] - at, ransacReprojThreshold=1.5)
        if model is None or inliers.sum() < 6 or inliers.mean() < 0.4:
            return None
        height, width = self.frames[a].shape
        corner = np.rint(at).astype(int) - half
        if min(corner) < 0 or corner[0] + 2 * half >= width or corner[1] + 2 * half >= height:
            return None
        patch = self.frames[a][corner[1]:corner[1] + 2 * half + 1, corner[0]:corner[0] + 2 * half + 1]
        warp = model.astype(np.float32)
        warp[:, 2] = model[:, :2] @ (corner - at) + at + model[:, 2]
        try:
            cc, warp = cv2.findTransformECC(  # type: ignore[call-overload]
                patch, self.frames[b], warp, cv2.MOTION_AFFINE, (3, 50, 1e-4), None, 5)
        except cv2.error:
            return None
        moved: Floats = warp[:, :2] @ (at - corner) + warp[:, 2] - at
        return moved if cc > 0.85 and np.hypot(*(moved - model[:, 2])) < 1.5 else None


def _steps_by_flow(a: Image, b: Image, points: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Pyramidal Lucas-Kanade from a to b, and whether it returns to within half a pixel."""
    start = points.astype(np.float32).reshape(-1, 1, 2)
    end, ok = _flow(a, b, start)
    back, ok_back = _flow(b, a, end)
    good = ok & ok_back & (np.hypot(*(back - start)[:, 0].T) < 0.5)
    return (end - start)[:, 0].astype(np.float64), good


def _flow(a: Image, b: Image, start: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    end, ok, _ = cv2.calcOpticalFlowPyrLK(a, b, start, None, winSize=(31, 31), maxLevel=4)  # type: ignore[call-overload]
    return np.asarray(end, np.float32), np.asarray(ok[:, 0] > 0, np.bool_)


def _distances(frames: Sequence[Image], fit: Fit, rows: list[list[TrackPoint]], every: int, gaps: Sequence[int],
               ) -> tuple[list[float], list[float]]:
    """Distances to the references, original pixels: of displacements since the first sight, and of single steps.

    The former of the features chosen in every `every`th frame, `gaps` frames on.
    """
    factor = np.array(fit.factor)
    reference = _Reference(frames)
    by_frame = [{p.feature: p for p in points if p.valid} for points in rows]
    births: dict[int, int] = {}
    for t, points in enumerate(rows):
        for p in points:
            births.setdefault(p.feature, t)
    long, steps = [], []
    for feature, born in births.items():
        if born % every:
            continue
        home = fit.to_source(np.array([by_frame[born][feature].x, by_frame[born][feature].y]))
        for gap in gaps:
            later = by_frame[born + gap].get(feature) if born + gap < len(rows) else None
            truth = None if later is None else reference.displacement(born, born + gap, home)
            if later is not None and truth is not None:
                long.append(float(np.hypot(*(np.array([later.dx, later.dy]) * factor - truth))))
    for t in range(1, len(rows)):
        both = sorted(by_frame[t].keys() & by_frame[t - 1].keys())
        if not both:
            continue
        was, now = (fit.to_source(np.array([[by_frame[s][f].x, by_frame[s][f].y] for f in both])) for s in (t - 1, t))
        flow, good = _steps_by_flow(frames[t - 1], frames[t], was)
        steps += np.hypot(*(now - was - flow).T)[good].tolist()
    return long, steps


@pytest.mark.parametrize(("name", "every", "gaps"), [("sparus", 1, (1, 2, 4, 6, 9, 14)),
                                                       ("aqualoc", 3, (3, 6, 9, 12, 15, 20))])
def test_real_seabed(name: str, every: int, gaps: tuple[int, ...]) -> None:
    """The bar: of what is called valid, 98 % within 2 px of the reference; and a good part is called valid."""
    file = DATA / name / f"{name}_snippet.mp4"
    if not file.exists():
        pytest.skip("real frames are not at hand: no ../shared/data")
    frames = [f.grey for f in open_source(file)]
    fit = Fit.to(frames[0].shape[::-1], FULL, 64)
    rows = _track(frames, fit)
    long, steps = _distances(frames, fit, rows, every, gaps)
    valid = sum(p.valid for points in rows for p in points)
    near = [sum(e <= NEAR_PX for e in errors) / len(errors) for errors in (long, steps)]
    print(f"{name}: {valid} valid in {len(frames)} frames; since first sight {near[0]:.3f} of {len(long)} within 2 px, "
          f"median {np.median(long):.2f}; step by step {near[1]:.3f} of {len(steps)}")
    assert valid >= 18 * len(frames), "too few measurements are called valid"
    assert len(long) >= 100 and len(steps) >= 250, "too few comparisons"
    assert near[0] >= 0.98 and near[1] >= 0.98
    _every_feature_is_tracked_or_flagged(rows)


def _every_feature_is_tracked_or_flagged(rows: list[list[TrackPoint]]) -> None:
    seen: set[int] = set()
    for points in rows:
        numbers = [p.feature for p in points]
        assert numbers == sorted(set(numbers)) and seen <= set(numbers)
        assert all(p.valid == (not p.reason) for p in points)
        seen |= set(numbers)
    assert seen


def test_folder_and_video_give_the_same_tracks(tmp_path: Path) -> None:
    frames = _flight([(3.0 * n, 2.0 * n) for n in range(4)])
    for n, frame in enumerate(frames):
        write_picture(tmp_path / f"{n}.png", frame)
    from_folder = [f.grey for f in FolderSource(tmp_path)]
    fit = Fit.to((400, 300), FULL, 64)
    assert _track(from_folder, fit, features=6) == _track(frames, fit, features=6)


def _flight(path: Sequence[tuple[float, float]], size: tuple[int, int] = (400, 300)) -> list[Image]:
    """Views of a photograph as the camera moves along `path`, pixels, with a little noise."""
    photo = _photo()
    rng = np.random.default_rng(0)
    frames = []
    for x, y in path:
        view = cv2.warpAffine(photo, np.array([[1, 0, -300 - x], [0, 1, -300 - y]], np.float64), size)
        frames.append(np.clip(view + rng.normal(0, 4, view.shape), 0, 255).astype(np.uint8))
    return frames


def _photo() -> Image:
    return np.asarray(cv2.resize(np.asarray(skimage.data.gravel(), np.uint8), (1024, 1024)), np.uint8)


def test_hover_never_leaves_the_initial_image() -> None:
    """However long it lasts: no drift, one link."""
    rng = np.random.default_rng(2)
    path = [(0.0, 0.0)] + [(float(x), float(y)) for x, y in rng.uniform(-3.5, 3.5, (14, 2))]
    rows = _track(_flight(path), Fit.to((400, 300), FULL, 64), features=12)
    last = [p for p in rows[-1] if p.valid]
    assert len(last) >= 10 and {p.links for p in last} == {1}
    errors = [np.hypot(p.dx + path[-1][0], p.dy + path[-1][1]) for p in last]
    assert max(errors) < 0.5 and len({p.feature for points in rows for p in points}) == len(rows[0])


def test_a_feature_is_the_centre_of_its_window() -> None:
    """Where a window's middle moves otherwise than the rest, as over relief, the middle counts."""
    fit = Fit.to((400, 300), FULL, 64)
    frames = _flight([(0.0, 0.0), (-3.0, 0.0), (-3.7, 0.0)])
    (first,) = _track(frames[:1], fit, features=12)
    odd = min(first, key=lambda p: abs(p.x - 200) + abs(p.y - 150))
    x, y = round(odd.x) + 3, round(odd.y)
    live = frames[1].copy()
    live[y - 19:y + 20, x - 19:x + 20] = frames[2][y - 19:y + 20, x - 19:x + 20]
    found = {p.feature: p for p in _track([frames[0], live], fit, features=12)[1]}
    assert found[odd.feature].valid and found[odd.feature].dx == pytest.approx(3.7, abs=0.25)
    rest = [p.dx for p in found.values() if p.valid and abs(p.x - x) + abs(p.y - y) > 100]
    assert len(rest) >= 5 and rest == pytest.approx([3.0] * len(rest), abs=0.25)


def test_a_veil_is_flagged_and_survived() -> None:
    path = [(2.0 * n, 0.0) for n in range(9)]
    frames = _flight(path)
    rng = np.random.default_rng(4)
    for n in (4, 5):
        frames[n] = rng.integers(0, 256, frames[n].shape, dtype=np.uint8)
    rows = _track(frames, Fit.to((400, 300), FULL, 64), features=12)
    first = {p.feature for p in rows[0]}
    assert not any(p.valid for n in (4, 5) for p in rows[n] if p.feature in first)
    again = [p for p in rows[-1] if p.feature in first and p.valid]
    assert len(again) >= 8
    assert max(np.hypot(p.dx + path[-1][0], p.dy) for p in again) < 0.5


def test_long_flight_replaces_what_leaves_and_tells_the_chain() -> None:
    """Zoom wears windows out: links are added, errors stay within what is wanted, and drift beyond it is flagged."""
    photo = _photo()
    zooms = [1.02**n for n in range(16)]
    views = [np.asarray(cv2.warpAffine(photo, np.array([[z, 0, 200 - 512 * z], [0, z, 150 - 512 * z]]), (400, 300)),
                        np.uint8) for z in zooms]
    links, reasons = set(), set()
    for wanted in (PRECISE_PX, 0.4):
        with GoldenBoard() as board:
            tracker = Tracker(Measurer(board, (400, 300), 2.5), TrackSettings(features=12, precise_px=wanted))
            rows = [tracker.step(view) for view in views]
        births = {p.feature: (zooms[t], p.x, p.y) for t, points in reversed(list(enumerate(rows))) for p in points}
        misses = []
        for z, points in zip(zooms, rows, strict=True):
            for p in points:
                first, x, y = births[p.feature]
                reasons.add(p.reason)
                if p.valid:
                    grown = z / first - 1
                    misses.append(float(np.hypot(p.dx - grown * (x - 200), p.dy - grown * (y - 150))))
                    links.add(p.links)
        assert len(misses) >= 80 and np.mean(np.array(misses) <= wanted) >= 0.98
    assert {0, 1, 2} <= links and "drift" in reasons


def test_murky_clip_that_returns() -> None:
    """A third of the length of `make tracks`: the bar of 30 frames becomes 10."""
    found = judge(Clip("gravel", 5, frames=80), murky=True)
    print(found)
    assert found.life >= 10 and found.rms <= 0.5 and found.worst <= 2.0 and found.home >= 15
    assert found.within >= 0.96


def test_clear_clip_that_returns() -> None:
    found = judge(Clip("grass", 6, frames=60, turned=1.0, zoomed=0.02), murky=False)
    print(found)
    assert found.rms <= 0.10 and found.worst <= 2.0 and found.home >= 15 and found.within >= 0.96


def test_a_board_of_few_slots_keeps_one_anchor() -> None:
    photo = _photo()
    with GoldenBoard(replace(FULL, slots=3)) as board:
        tracker = Tracker(Measurer(board, (400, 300), 2.5), TrackSettings(features=12))
        rows = [tracker.step(np.ascontiguousarray(photo[20 * k:20 * k + 300, 15 * k:15 * k + 400])) for k in range(8)]
    assert sum(p.valid for p in rows[-1]) >= 6 and {p.links for p in rows[-1] if p.valid} - {0, 1}
