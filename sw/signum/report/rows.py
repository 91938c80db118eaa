"""Tables on disk."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from signum.geometry.calibration import StereoGeometry
from signum.measure.flow import FlowField
from signum.sources.open import Fit
from signum.measure.stereo import RangeMap
from signum.measure.track import TrackPoint

TRACK = "frame", "feature", "x_px", "y_px", "dx_px", "dy_px", "score", "margin", "valid"
"""Of `track.csv`, original pixels: (x, y) is where the feature is, (dx, dy) how far from where it was first seen."""
DRIFT = "frame", "valid", "direct", "links", "error_px"
"""Of `drift.csv`: valid features of a frame, how many of them rest on one measurement against their initial image, the
longest chain of measurements behind one, and the distance in original pixels that 98 % of its positions are within by
the tracker's estimate, for the worst of them; the last two are empty where none is valid."""
FLOW = "frame_a", "frame_b", "x_px", "y_px", "dx_px", "dy_px", "score", "valid"
"""Of `flow.csv`, original pixels: the window at (x, y) of frame a lies (dx, dy) further on in frame b; empty where not
valid."""
DISPARITY = "frame", "x_px", "y_px", "disparity_px", "range_m", "score", "margin", "valid"
"""Of `disparity.csv`, original pixels of the rectified left picture; empty where not valid or not known."""
NAVIGATE = "frame", "x_px", "y_px", "rot_deg", "scale", "score", "confidence"
"""Of `navigate.csv`: the frame's centre, rotation and zoom in mosaic.png, its pixels; empty and confidence 0 where it
was not found."""
GOTO = "frame", "right_px", "down_px", "sharp"
"""Of `goto.csv`: the way from the middle of the frame to the target, original pixels, empty where not known; 1 where it
was measured about the target itself."""


class Table:
    """A CSV file that is good after every row."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._file = path.open("w", newline="", encoding="utf-8")
        self._rows = csv.writer(self._file)
        self.write(columns)

    def write(self, row: Sequence[object]) -> None:
        """Append a row and push it to the disk."""
        self._rows.writerow(row)
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def flow_rows(a: str, b: str, field: FlowField, fit: Fit) -> Iterator[list[object]]:
    """Rows of `flow.csv` from a field in pixels of the board's picture."""
    kx, ky = fit.factor
    for j, y in enumerate(field.y):
        for i, x in enumerate(field.x):
            good = bool(field.valid[j, i])
            moved = [f"{field.dx[j, i] * kx:.3f}", f"{field.dy[j, i] * ky:.3f}"] if good else ["", ""]
            yield [a, b, f"{(x + 0.5) * kx - 0.5:.1f}", f"{(y + 0.5) * ky - 0.5:.1f}", *moved,
                   f"{field.score[j, i]:.4f}", int(good)]


def disparity_rows(frame: str, found: RangeMap, geometry: StereoGeometry | None) -> Iterator[list[object]]:
    """Rows of `disparity.csv` from a map in original pixels."""
    depth = np.full(found.disparity.shape, np.nan) if geometry is None else geometry.depth(found.disparity)
    for j, y in enumerate(found.y):
        for i, x in enumerate(found.x):
            figures = ["" if np.isnan(v) else f"{v:.4f}" for v in (found.disparity[j, i], depth[j, i])]
            yield [frame, f"{x:.1f}", f"{y:.1f}", *figures, f"{found.score[j, i]:.4f}", f"{found.margin[j, i]:.4f}",
                   int(found.valid[j, i])]


def drift_row(frame: str, points: Sequence[TrackPoint], fit: Fit) -> list[object]:
    """A row of `drift.csv`."""
    valid = [p for p in points if p.valid]
    worst = max((p.error_px for p in valid), default=0.0) * max(fit.factor)
    figures = [str(max(p.links for p in valid)), f"{worst:.3f}"] if valid else ["", ""]
    return [frame, len(valid), sum(p.links <= 1 for p in valid), *figures]


def track_row(frame: str, point: TrackPoint, fit: Fit) -> list[object]:
    """A row of `track.csv` from a point in pixels of the board's picture."""
    kx, ky = fit.factor
    x, y = (point.x + 0.5) * kx - 0.5, (point.y + 0.5) * ky - 0.5
    figures = [f"{v:.3f}" for v in (x, y, point.dx * kx, point.dy * ky)]
    return [frame, point.feature, *figures, f"{point.score:.4f}", f"{point.margin:.4f}", int(point.valid)]
