# SPDX-License-Identifier: Apache-2.0
"""Segments frames for the follower: by the range of a stereo pair, or by motion against the terrain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from signum.applications.follow.segment import (
    FLOW_RULES,
    NEAR_RULES,
    Segmented,
    segment_by_mask,
    segment_by_motion,
    segment_by_range,
)
from signum.common.arrays import Image
from signum.geometry.calibration import StereoGeometry
from signum.measure.dense_flow import measure_dense_flow
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer, View
from signum.measure.moving import segment_moving
from signum.measure.stereo import measure_range

RANGE_WINDOW, MOTION_WINDOW = 24, 32
"""Sides of the segmentation's windows, pixels, by range and by motion."""


class Eye(Protocol):
    """Segments frames. `live` is the view of the last frame, `before` that of the frame before, where it is kept."""

    measurer: Measurer
    live: View | None
    before: View | None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented | None:
        """Segment a frame, or the two of a stereo pair.

        Args:
            frames: uint8 (height, width).
            moved: predicted shift of the picture since the last frame by the camera's rotation, pixels.

        Returns:
            None where there is no frame before.
        """


class RangeEye:
    """Finds what is nearer than `nearer` metres, by stereo; searches from `closest` metres to beyond `nearer`."""

    def __init__(self, measurer: Measurer, geometry: StereoGeometry, nearer: float = 4.0, closest: float = 1.0,
                 window: int = RANGE_WINDOW, step: int = 24) -> None:
        self.measurer, self.geometry, self.nearer, self.window, self.step = measurer, geometry, nearer, window, step
        per_metre = geometry.focal * geometry.baseline
        # The range extends beyond the threshold so that it contains the correlation peak of slightly farther objects.
        self.disparities = (int(0.6 * per_metre / nearer - geometry.shift),
                            math.ceil(per_metre / closest - geometry.shift))
        self.live: View | None = None
        self.before: View | None = None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented:
        """Segment the left frame of a rectified pair, uint8 (height, width) each; `moved` is not used."""
        left, right = self.measurer.pair(frames[0], frames[1])
        found = measure_range(self.measurer, left, right, self.disparities, (self.window, self.window), self.step, None,
                              NEAR_RULES)
        self.measurer.release(right)
        if self.live is not None:
            self.measurer.release(self.live)
        self.live = left
        return segment_by_range(found, self.geometry, self.nearer)


class MotionEye:
    """Finds what moves relative to the terrain."""

    def __init__(self, measurer: Measurer, disagree_px: float = 1.5, window: int = MOTION_WINDOW, step: int = 24,
                 reach: int = 9) -> None:
        self.measurer, self.disagree_px, self.window, self.step, self.reach = measurer, disagree_px, window, step, reach
        self.live: View | None = None
        self.before: View | None = None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented | None:
        """Segment a frame, uint8 (height, width); None where there is no frame before.

        `moved` is the predicted shift of the picture since the last frame by the camera's rotation, pixels.
        """
        if self.before is not None:
            self.measurer.release(self.before)
        self.before, self.live = self.live, self.measurer.view(frames[0])
        if self.before is None:
            return None
        field = measure_flow(self.measurer, self.before, self.live, (self.window, self.window), self.step,
                             (self.reach, self.reach), moved, FLOW_RULES)
        return segment_by_motion(field, self.measurer.size, self.disagree_px)


class DenseEye:
    """Finds what moves by itself at every pixel, on a board with the dense engine; smaller things than MotionEye does,
    and their middle more exactly. The follower gets the mask at every `step`-th pixel."""

    def __init__(self, measurer: Measurer, window: int = MOTION_WINDOW, step: int = 8, reach: int = 9) -> None:
        self.measurer, self.window, self.step, self.reach = measurer, window, step, reach
        self.live: View | None = None
        self.before: View | None = None

    def look(self, frames: Sequence[Image], moved: tuple[float, float]) -> Segmented | None:
        """Segment a frame, uint8 (height, width); otherwise as MotionEye's.

        Raises:
            BoardError: if the board has no dense engine, or not of this window.
        """
        if self.before is not None:
            self.measurer.release(self.before)
        self.before, self.live = self.live, self.measurer.view(frames[0])
        if self.before is None:
            return None
        views, reach = (self.before, self.live), (self.reach, self.reach)
        field = measure_dense_flow(self.measurer, *views, self.window, self.step, reach, moved)
        found = segment_moving(self.measurer, *views, field, self.reach)
        x, y = (np.arange(self.step // 2, side, self.step).astype(np.float64) for side in self.measurer.size)
        return segment_by_mask(found, x, y)
