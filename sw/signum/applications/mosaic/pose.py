# SPDX-License-Identifier: Apache-2.0
"""A placed frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.geometry.similarity import Similarity


@dataclass(frozen=True)
class Pose:
    """A placed frame: its centre in the mosaic plane, original pixels; the columns of `POSES`."""

    frame: str
    x_px: float
    y_px: float
    rot_deg: float
    scale: float

    @classmethod
    def of(cls, frame: str, place: Similarity, centre: tuple[float, float]) -> Pose:
        """From the similarity that takes the frame's pixels to the plane, and the frame's centre, pixels."""
        x, y = place(np.array(centre))
        return cls(frame, float(x), float(y), place.rot_deg, place.scale)

    @property
    def row(self) -> list[object]:
        """The row of the table."""
        return [self.frame, f"{self.x_px:.2f}", f"{self.y_px:.2f}", f"{self.rot_deg:.3f}", f"{self.scale:.5f}"]
