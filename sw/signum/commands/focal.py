# SPDX-License-Identifier: Apache-2.0
"""The focal length of a source's frames."""

from __future__ import annotations

from pathlib import Path

from signum.common.console import notes
from signum.geometry.calibration import read_mono

VIEW = 400 / 384
"""Focal length per picture width where none is given: about 51 degrees across, a common lens under water."""


def focal_px(focal: float | None, calibration: Path | None, width: int, scales: str) -> float:
    """The focal length, pixels of the source's frames; prints a note where it is assumed.

    Args:
        focal: given, or None.
        calibration: of the camera, or None.
        width: of the frames, pixels.
        scales: what the focal length scales, for the note.
    """
    if focal is not None:
        return focal
    if calibration is not None:
        return float(read_mono(calibration)[0][0, 0])
    assumed = VIEW * width
    notes.print(f"no --focal or --calibration: taking {assumed:.0f} px; {scales} with it")
    return assumed
