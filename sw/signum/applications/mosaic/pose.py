# SPDX-License-Identifier: Apache-2.0
"""A placed frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.geometry.similarity import Similarity
from signum.report.rows import seconds


@dataclass(frozen=True)
class Pose:
    """A placed frame: its centre in the mosaic plane, original pixels, and its time; the columns of `POSES`."""

    frame: str
    x_px: float
    y_px: float
    rot_deg: float
    scale: float
    time_s: float | None = None

    @classmethod
    def of(cls, frame: str, place: Similarity, centre: tuple[float, float], time_s: float | None = None) -> Pose:
        """From the similarity that takes the frame's pixels to the plane, the frame's centre, pixels, and its time."""
        x, y = place(np.array(centre))
        return cls(frame, float(x), float(y), place.rot_deg, place.scale, time_s)

    @property
    def row(self) -> list[object]:
        """The row of the table."""
        return [self.frame, seconds(self.time_s), f"{self.x_px:.2f}", f"{self.y_px:.2f}", f"{self.rot_deg:.3f}",
                f"{self.scale:.5f}"]
