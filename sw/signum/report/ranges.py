# SPDX-License-Identifier: Apache-2.0
"""A range map as a picture, and its points as a PLY file."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.geometry.calibration import StereoGeometry
from signum.measure.stereo import RangeMap

SCALE_WIDTH = 64
"""Width of the colour scale beside a drawn map, pixels."""


def write_ply(path: Path, points: Floats) -> None:
    """Write points (n, 3) in metres as an ASCII PLY file."""
    header = (f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    path.write_text(header + "".join(f"{x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in points))


def draw_range(found: RangeMap, geometry: StereoGeometry | None, picture: Image) -> Image:
    """The map in colour over the left picture, with its scale: metres with a geometry, pixels of disparity without.

    Args:
        found: the map.
        geometry: of the pair, or None.
        picture: uint8 (H, W), the left view.

    Returns:
        uint8 (H, W + SCALE_WIDTH, 3) blue, green, red; without colour where no measurement is valid.
    """
    values = found.disparity if geometry is None else geometry.depth(found.disparity)
    out = np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.uint8)
    seen = values[np.isfinite(values)]
    low, high = (float(v) for v in np.percentile(seen, (1, 99))) if seen.size else (0.0, 1.0)
    high = max(high, low + 1e-3)
    near_is_red = 1.0 if geometry is None else -1.0
    row, column = (cells_of(centres, size) for centres, size in zip((found.y, found.x), picture.shape, strict=True))
    cells = np.where((row[:, None] >= 0) & (column >= 0), values[row[:, None], column], np.nan)
    shown = np.isfinite(cells)
    colours = _colours((cells[shown] - low) / (high - low), near_is_red)
    out[shown] = np.asarray(0.35 * out[shown] + 0.65 * colours, np.uint8)
    height = picture.shape[0]
    scale = np.full((height, SCALE_WIDTH, 3), 255, np.uint8)
    for y in range(8, height - 8):
        scale[y, 8:22] = _colours(np.array([1 - (y - 8) / (height - 16)]), near_is_red)
    for share in (0.0, 0.5, 1.0):
        y = round(height - 8 - share * (height - 16))
        cv2.putText(scale, f"{low + share * (high - low):.3g}", (25, min(max(y + 4, 12), height - 4)),
                    cv2.FONT_HERSHEY_SIMPLEX, 0.38, (0, 0, 0), 1, cv2.LINE_AA)
    return np.hstack([out, scale])


def cells_of(centres: Floats, size: int) -> NDArray[np.int64]:
    """For each pixel of a side the number of the cell that it lies in, -1 where it lies in none."""
    step = int(centres[1] - centres[0]) if centres.size > 1 else 16
    cells = np.full(size, -1)
    for n, centre in enumerate(centres.astype(int)):
        cells[max(centre - step // 2, 0):centre + (step + 1) // 2] = n
    return cells


def _colours(shares: Floats, sign: float) -> Image:
    """Blue (0) to red (1), or the other way round for a negative sign; uint8 (n, 3)."""
    shares = np.clip(shares, 0.0, 1.0)
    levels = np.rint(255 * (shares if sign > 0 else 1 - shares)).astype(np.uint8)
    table = np.asarray(cv2.applyColorMap(np.arange(256, dtype=np.uint8)[:, None], cv2.COLORMAP_TURBO), np.uint8)
    return np.asarray(table[levels, 0], np.uint8)
