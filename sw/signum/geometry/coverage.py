# SPDX-License-Identifier: Apache-2.0
"""How well views of a board cover a camera's picture, and what is missing of a good calibration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats

CELLS = 8, 6
"""Cells across and down in which corners are counted."""
GOOD_VIEWS = 12
"""Views from which a calibration is steady."""
GOOD_SHARE = 0.75
"""Share of the cells with a corner from which the coverage is good."""
GOOD_EDGE = 0.5
"""Share of the cells along an edge with a corner that is good."""
GOOD_REACH = 0.8
"""Distance of the outermost corners from the middle, as a share of the picture's half diagonal, that is good."""
TILTED_DEG = 15.0
"""Tilt of a board, against the picture's plane, that tells focal length and range apart."""
GOOD_TILTED = 4
"""Views with a board so tilted that are good."""
BIG_RESIDUAL_PX = 1.0
"""Residual above which something is wrong."""


def corner_counts(corners: Floats, size: tuple[int, int]) -> NDArray[np.int64]:
    """Corners (n, 2) in each of the picture's CELLS: (down, across)."""
    across, down = CELLS
    counts, _, _ = np.histogram2d(corners[:, 1], corners[:, 0], (down, across),
                                  ((-0.5, size[1] - 0.5), (-0.5, size[0] - 0.5)))
    return counts.astype(np.int64)


def hints(corners: Floats, size: tuple[int, int], tilts_deg: Floats, rms_px: float) -> list[str]:
    """What is missing of a good calibration, a sentence each; none if nothing is.

    Args:
        corners: of all used views, pixels (n, 2).
        size: width and height of the pictures, pixels.
        tilts_deg: of the board in each used view (n,).
        rms_px: of the corners from the computed ones.
    """
    out = []
    if len(tilts_deg) < GOOD_VIEWS:
        out.append(f"Only {len(tilts_deg)} views of the board are used; take {GOOD_VIEWS} or more, from all sides.")
    counts = corner_counts(corners, size)
    share = float((counts > 0).mean())
    if share < GOOD_SHARE:
        out.append(f"The board's corners were seen in {share:.0%} of the picture only; bring it also to the "
                   f"{_regions(counts)}.")
    else:
        bare = [name for name, cells in (("left", counts[:, 0]), ("right", counts[:, -1]), ("upper", counts[0]),
                                         ("lower", counts[-1])) if (cells > 0).mean() < GOOD_EDGE]
        if bare:
            out.append(f"Hardly any corner lies at the {' and the '.join(bare)} edge of the picture: bring the board "
                       "there, where the distortion is largest.")
    middle = (np.array(size) - 1) / 2
    reach = float(np.hypot(*(corners - middle).T).max() / np.hypot(*middle))
    if reach < GOOD_REACH:
        out.append(f"No corner is farther from the middle than {reach:.0%} of the way to the picture's corners: beyond "
                   "that the distortion is a guess. Bring the board closer, or to the edges.")
    tilted = int((tilts_deg >= TILTED_DEG).sum())
    if tilted < GOOD_TILTED:
        out.append(f"The board was tilted by {TILTED_DEG:g} degrees or more in {tilted} views only; without tilt, "
                   "focal length and range cannot be told apart. Tilt it by 20 to 45 degrees in all directions.")
    if rms_px > BIG_RESIDUAL_PX:
        out.append(f"The corners lie {rms_px:.2f} px from the computed ones: the board is not flat, its squares are "
                   "not as given, pictures are blurred by motion, or the lens needs another --model.")
    return out


def _regions(counts: NDArray[np.int64]) -> str:
    """The parts of the picture where most cells are empty."""
    rows, columns = np.array_split(np.arange(counts.shape[0]), 3), np.array_split(np.arange(counts.shape[1]), 3)
    names = [f"{v} {h}".strip() or "middle" for v in ("upper", "", "lower") for h in ("left", "", "right")]
    empty = [float((counts[np.ix_(r, c)] == 0).mean()) for r in rows for c in columns]
    worst = [name for name, share in zip(names, empty, strict=True) if share >= 0.5]
    return ", ".join(worst) + (" part" if len(worst) == 1 else " parts") if worst else "edges"
