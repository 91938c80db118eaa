"""Follows one blob from frame to frame: by segmentation, between whiles by correlation, and says when it is lost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

from signum.applications.follow.segment import FLOW_RULES, NEAR_RULES, Blob, Segmented, by_motion, by_range, one_blob
from signum.common.arrays import Image
from signum.geometry.calibration import StereoGeometry
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer, Query, Rules, View
from signum.measure.stereo import measure_range

RANGE_WINDOW, MOTION_WINDOW = 24, 32
"""Sides of the windows by which a fish is told from what is behind it, pixels."""
TEMPLATE_RULES = Rules(min_score=0.66, min_margin=0.04, texture=False)
TEMPLATE = 48
REACH = 20
STAYS_PX = 50.0
"""By how much a blob not yet taken for a fish may move from frame to frame, the camera's turning aside."""
GATE_PX = 90.0
"""How far from where it is expected a followed blob may turn up."""


class State(StrEnum):
    """How the fish's place is known."""

    SEEN = "seen"
    """Segmentation shows it."""
    KEPT = "kept"
    """Segmentation does not, a fish at rest for instance; its picture of the frame before is found again."""
    COASTING = "coasting"
    """Neither, for a few frames: it is taken to go on as before."""
    LOST = "lost"


@dataclass(frozen=True, eq=False)
class Target:
    """A frame's answer: where the fish is, pixels, meaningless when lost; the blob, where segmentation shows one."""

    state: State
    x: float
    y: float
    range_m: float = float("nan")
    blob: Blob | None = None
    seen: Segmented | None = None

    @property
    def lost(self) -> bool:
        """Whether nothing is known of it."""
        return self.state is State.LOST


class Eye(Protocol):
    """Segments frames. `live` is the view of the last frame, `before` that of the one before, where it is kept."""

    measurer: Measurer
    live: View | None
    before: View | None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented | None:
        """Segment a frame, or the two of a stereo pair.

        Args:
            frames: uint8 (height, width).
            moved: how far the camera's own turning should have shifted the picture since the last frame, pixels.

        Returns:
            None where there is nothing to compare with yet.
        """


class RangeEye:
    """Sees what is nearer than `nearer` metres, by stereo; searches from `closest` metres to a little beyond."""

    def __init__(self, measurer: Measurer, geometry: StereoGeometry, nearer: float = 4.0, closest: float = 1.0,
                 window: int = RANGE_WINDOW, step: int = 24) -> None:
        self.measurer, self.geometry, self.nearer, self.window, self.step = measurer, geometry, nearer, window, step
        per_metre = geometry.focal * geometry.baseline
        # Beyond the threshold too, so that the peak of what is farther lies within the search and is not cut off.
        self.disparities = (int(0.6 * per_metre / nearer - geometry.shift),
                            math.ceil(per_metre / closest - geometry.shift))
        self.live: View | None = None
        self.before: View | None = None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented:
        """See `Eye`; takes a rectified pair."""
        left, right = self.measurer.pair(frames[0], frames[1])
        found = measure_range(self.measurer, left, right, self.disparities, (self.window, self.window), self.step, None,
                              NEAR_RULES)
        self.measurer.release(right)
        if self.live is not None:
            self.measurer.release(self.live)
        self.live = left
        return by_range(found, self.geometry, self.nearer)


class MotionEye:
    """Sees what moves otherwise than the terrain."""

    def __init__(self, measurer: Measurer, disagree_px: float = 1.5, window: int = MOTION_WINDOW, step: int = 24,
                 reach: int = 9) -> None:
        self.measurer, self.disagree_px, self.window, self.step, self.reach = measurer, disagree_px, window, step, reach
        self.live: View | None = None
        self.before: View | None = None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented | None:
        """See `Eye`."""
        if self.before is not None:
            self.measurer.release(self.before)
        self.before, self.live = self.live, self.measurer.view(frames[0])
        if self.before is None:
            return None
        field = measure_flow(self.measurer, self.before, self.live, (self.window, self.window), self.step,
                             (self.reach, self.reach), moved, FLOW_RULES)
        return by_motion(field, self.measurer.size, self.disagree_px)


@dataclass
class Follower:
    """Frame in, target out.

    Attributes:
        eye: segments.
        patience: frames without anything after which the fish is lost.
        keep: frames for which a picture of the fish alone is believed: what never moves may be a stone.
        confirm: frames in a row that must show a blob before it is taken for a fish.
    """

    eye: Eye
    patience: int = 4
    keep: int = 50
    confirm: int = 3
    target: Target = field(default_factory=lambda: Target(State.LOST, 0.0, 0.0))
    _moving: tuple[float, float] = field(init=False, default=(0.0, 0.0))
    _without: int = field(init=False, default=0)
    _kept: int = field(init=False, default=0)
    _shown: int = field(init=False, default=0)
    _sighting: Blob | None = field(init=False, default=None, repr=False)

    def step(self, frames: Sequence[Image], moved: tuple[float, float] = (0.0, 0.0),
             expected: tuple[float, float] | None = None) -> Target:
        """Take a frame (or a pair).

        Args:
            frames, moved: see `Eye.look`.
            expected: where the fish should be by what is known of its and the camera's motion, pixels; None to go on as
                in the frames before.
        """
        last = self.target
        seen = self.eye.look(frames, moved)
        x, y = expected or (last.x + self._moving[0], last.y + self._moving[1])
        inside = 0 <= x < self.eye.measurer.size[0] and 0 <= y < self.eye.measurer.size[1]
        blob = None if seen is None else one_blob(seen, None if last.lost else (x, y))
        if blob is not None and not last.lost and math.hypot(blob.x - x, blob.y - y) > GATE_PX:
            blob = None
        self._shown = self._sighted(blob, moved)
        if blob is not None and blob.sure and not (last.lost and self._shown < self.confirm):
            self._without = self._kept = 0
            self._set(Target(State.SEEN, blob.x, blob.y, blob.range_m, blob, seen))
        elif last.lost:
            self.target = Target(State.LOST, last.x, last.y, blob=blob, seen=seen)
        elif inside and self._kept < self.keep and (place := self._by_picture(x, y) or (blob and (blob.x, blob.y))):
            self._kept, self._without = self._kept + 1, 0
            self._set(Target(State.KEPT, *place, last.range_m, blob, seen))
        elif inside and self._without < self.patience:
            self._without += 1
            self.target = Target(State.COASTING, x, y, last.range_m, None, seen)
        else:
            self._without, self._kept, self._moving = 0, 0, (0.0, 0.0)
            self.target = Target(State.LOST, last.x, last.y, seen=seen)
        return self.target

    def _sighted(self, blob: Blob | None, moved: tuple[float, float]) -> int:
        """In how many frames in a row a blob has been there, each time where it was before."""
        before, self._sighting = self._sighting, blob
        if blob is None:
            return 0
        stays = before is not None and math.hypot(blob.x - before.x - moved[0], blob.y - before.y - moved[1]) < STAYS_PX
        return self._shown + 1 if stays else 1

    def _set(self, target: Target) -> None:
        if not self.target.lost:
            self._moving = 0.5 * (target.x - self.target.x), 0.5 * (target.y - self.target.y)
        self.target = target

    def _by_picture(self, x: float, y: float) -> tuple[float, float] | None:
        """Where the part of the last frame that showed the fish is now; None if nowhere near (x, y)."""
        eye, last = self.eye, self.target
        if eye.before is None or eye.live is None or last.state is State.COASTING:
            return None
        u, v = round(last.x), round(last.y)
        found = eye.measurer.measure([Query(eye.before, eye.live, u, v, TEMPLATE, TEMPLATE, (x - u, y - v),
                                            (REACH, REACH))], TEMPLATE_RULES)[0]
        return (last.x + found.dx_px, last.y + found.dy_px) if found.valid else None
