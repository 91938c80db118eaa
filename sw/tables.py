"""Tables on disk."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from sw.sources import Fit
from sw.track import TrackPoint

TRACK = "frame", "feature", "x_px", "y_px", "dx_px", "dy_px", "score", "margin", "valid"
"""Of `track.csv`, original pixels: (x, y) is where the feature is, (dx, dy) how far from where it was first seen."""


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


def track_row(frame: str, point: TrackPoint, fit: Fit) -> list[object]:
    """A row of `track.csv` from a point in pixels of the board's picture."""
    kx, ky = fit.factor
    x, y = (point.x + 0.5) * kx - 0.5, (point.y + 0.5) * ky - 0.5
    figures = [f"{v:.3f}" for v in (x, y, point.dx * kx, point.dy * ky)]
    return [frame, point.feature, *figures, f"{point.score:.4f}", f"{point.margin:.4f}", int(point.valid)]
