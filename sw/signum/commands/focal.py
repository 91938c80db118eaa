# SPDX-License-Identifier: Apache-2.0
"""The focal length of a source's frames."""

from __future__ import annotations

from pathlib import Path

from signum.common.console import notes
from signum.sources.open import open_lens

VIEW = 400 / 384
"""Focal length per picture width where none is given: about 51 degrees across, a common lens under water."""


def focal_px(focal: float | None, calibration: Path | None, size: tuple[int, int], scales: str) -> float:
    """The focal length, pixels of the source's frames; prints a note where it is assumed.

    Args:
        focal: given, or None.
        calibration: of the camera, or None.
        size: width and height of the frames, pixels.
        scales: what the focal length scales, for the note.
    """
    if focal is not None:
        return focal
    if calibration is not None:
        return open_lens(calibration).scaled(size, str(calibration)).focal
    assumed = VIEW * size[0]
    notes.print(f"no --focal or --calibration: taking {assumed:.0f} px; {scales} with it")
    return assumed
