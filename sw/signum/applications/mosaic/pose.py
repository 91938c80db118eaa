"""A placed frame."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Pose:
    """A placed frame: its centre in the mosaic plane, original pixels; as `POSES`."""

    frame: str
    x_px: float
    y_px: float
    rot_deg: float
    scale: float

    @property
    def row(self) -> list[object]:
        """The row of the table."""
        return [self.frame, f"{self.x_px:.2f}", f"{self.y_px:.2f}", f"{self.rot_deg:.3f}", f"{self.scale:.5f}"]
