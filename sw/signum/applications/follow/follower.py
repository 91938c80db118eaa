# SPDX-License-Identifier: Apache-2.0
"""Follows one blob from frame to frame by segmentation, by correlation where that fails, and reports its loss."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from signum.applications.follow.eyes import Eye
from signum.applications.follow.segment import Blob, Segmented, one_blob
from signum.applications.follow.template import find_template
from signum.common.arrays import Image

STAYS_PX = 50.0
"""Largest motion of a blob not yet confirmed from frame to frame, less the camera's rotation."""
GATE_PX = 90.0
"""Largest distance of a followed blob from its expected position."""


class State(StrEnum):
    """How the fish's position is known."""

    SEEN = "seen"
    """By segmentation."""
    KEPT = "kept"
    """By its template from the frame before, where segmentation does not find it: at rest, for instance."""
    COASTING = "coasting"
    """By neither, for a few frames: its last motion is extrapolated."""
    LOST = "lost"


@dataclass(frozen=True, eq=False)
class Target:
    """A frame's result: the fish's position, pixels, not valid when lost; its range; the blob, where there is one."""

    state: State
    x: float
    y: float
    range_m: float = float("nan")
    blob: Blob | None = None
    seen: Segmented | None = None

    @property
    def lost(self) -> bool:
        """Whether the position is not known."""
        return self.state is State.LOST


@dataclass
class Follower:
    """Frame in, target out.

    Attributes:
        eye: segments.
        patience: frames without a measurement after which the fish is lost.
        keep: largest number of frames in a row by template alone: an object that never moves may be a stone.
        confirm: frames in a row that must contain a blob before it counts as a fish.
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
        """Process a frame (or a pair).

        Args:
            frames: uint8 (H, W), one of a single camera, or left and right of a rectified pair.
            moved: predicted shift of the picture since the last frame by the camera's rotation, pixels right and down.
            expected: predicted position of the fish by its and the camera's motion, pixels; None to extrapolate the
                motion of the frames before.
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
        elif inside and self._kept < self.keep and (place := self._by_template(x, y) or (blob and (blob.x, blob.y))):
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
        """Number of frames in a row with a blob, each near its position in the frame before."""
        before, self._sighting = self._sighting, blob
        if blob is None:
            return 0
        stays = before is not None and math.hypot(blob.x - before.x - moved[0], blob.y - before.y - moved[1]) < STAYS_PX
        return self._shown + 1 if stays else 1

    def _set(self, target: Target) -> None:
        if not self.target.lost:
            self._moving = 0.5 * (target.x - self.target.x), 0.5 * (target.y - self.target.y)
        self.target = target

    def _by_template(self, x: float, y: float) -> tuple[float, float] | None:
        """Position of the last frame's template of the fish in this one; None if it is not found near (x, y)."""
        eye, last = self.eye, self.target
        if eye.before is None or eye.live is None or last.state is State.COASTING:
            return None
        moved = find_template(eye.measurer, (eye.before, eye.live), (last.x, last.y), (x, y))
        return None if moved is None else (last.x + moved[0], last.y + moved[1])
