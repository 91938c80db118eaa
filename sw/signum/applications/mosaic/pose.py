"""A placed frame, and how a column is made."""

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



@dataclass(frozen=True)
class Settings:
    """How a column is made.

    Attributes:
        step: share of the frame's width or height by which a stream's view moves before a frame is stored.
        turn_deg: rotation at which it is stored all the same.
        back: how many stored frames a new one is tried against before the chain is broken.
        patience: frames of a stream that may be refused before a new piece begins.
        reach: pixels of the board searched around a stream's predicted place.
    """

    step: float = 1 / 3
    turn_deg: float = 5.0
    back: int = 3
    patience: int = 15
    reach: int = 24
