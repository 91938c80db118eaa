# SPDX-License-Identifier: Apache-2.0
"""Writes `hold.csv` row by row, and keeps what the report shows: a series and some frames with the reading drawn in.

What is kept is bounded, however long the run: of a long one every second, fourth, ... frame of the series, a frame
without a reading before its neighbours, and pictures farther apart. Its memory is taken with the first frame, so that a
run that goes on for hours needs no more than it did in its first minute.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from signum.applications.hold.reading import Reading
from signum.common.arrays import Floats, Image
from signum.frames.frame import grey
from signum.report.draw import GREEN, RED, write_line
from signum.tables.schemas import HOLD, HOLD_TRUTH
from signum.tables.table import Table

MOST_ROWS = 1 << 13
"""Frames of the series that are kept; even."""
CONFIDENCE = 5
"""Column of the series."""


def hold_row(frame: str, time: float, r: Reading) -> list[object]:
    """A row of `hold.csv`."""
    figures = [f"{r.forward:.5f}", f"{r.right:.5f}", f"{math.degrees(r.heading):.4f}", f"{r.zoom:.6f}",
               f"{r.range_m:.5f}"] if r.valid else [""] * 5
    return [frame, f"{time:.3f}", *figures, r.confidence, r.agreed, r.tried, f"{r.offset_error:.5f}" if r.valid else "",
            r.reference if r.valid else ""]


def draw_reading(picture: Image, reading: Reading, features: Floats, window: int, words: str = "") -> Image:
    """A frame with the station's features at their positions by the reading, red where it is not valid.

    Args:
        picture: uint8 (H, W) or (H, W, 3).
        features: (n, 2) pixels.
        window: side of the windows, pixels; drawn at a third.
        words: written before the reading.
    """
    canvas = np.asarray(cv2.cvtColor(grey(picture), cv2.COLOR_GRAY2BGR), np.uint8)
    colour, half = GREEN if reading.valid else RED, max(window // 6, 3)
    for x, y in np.rint(np.nan_to_num(features)).astype(int).tolist():
        cv2.rectangle(canvas, (x - half, y - half), (x + half, y + half), colour, 1, cv2.LINE_AA)
    text = (f"x {100 * reading.forward:+.1f} y {100 * reading.right:+.1f} cm  "
            f"{math.degrees(reading.heading):+.2f} deg  R {reading.range_m:.3f} m  conf {reading.confidence}"
            if reading.valid else "no reading: confidence 0")
    write_line(canvas, words + text, 0.4)
    return canvas


@dataclass
class HoldRecord:
    """Writes `hold.csv` and keeps what the report needs; the table is complete after every frame.

    Attributes:
        folder: exists.
        truth: whether the rows contain the simulation's truth.
        often: seconds between pictures at first.
        most: pictures that are kept.
        shots: (caption, frame with the reading drawn in): first, every `often` seconds, and where readings stop or
            return.
        count: frames; valid: those with a reading.
    """

    folder: Path
    truth: bool
    often: float = 60.0
    most: int = 9
    shots: list[tuple[str, Image]] = field(default_factory=list)
    count: int = 0
    valid: int = 0
    _rows: Floats = field(init=False, repr=False)
    _filled: int = field(init=False, repr=False, default=0)
    _slots: list[Image] = field(init=False, repr=False, default_factory=list)
    _worst: tuple[float, ...] | None = field(init=False, repr=False, default=None)
    _every: int = field(init=False, repr=False, default=1)
    _turns: list[bool] = field(init=False, repr=False, default_factory=list)
    _table: Table = field(init=False, repr=False)
    _was_valid: bool | None = field(init=False, default=None)
    _next_shot: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self._rows = np.full((MOST_ROWS, 10 if self.truth else 6), np.nan)
        self._table = Table(self.folder / "hold.csv", [*HOLD, *HOLD_TRUTH] if self.truth else HOLD)

    def add(self, name: str, time: float, reading: Reading, picture: Image, features: Floats,
            window: int = 64, truth: tuple[float, float, float, float] | None = None) -> None:
        """Record a frame.

        Args:
            truth: forward, right (metres), heading (radians) and range (metres).
        """
        row = hold_row(name, time, reading)
        if truth is not None:
            row += [f"{truth[0]:.5f}", f"{truth[1]:.5f}", f"{math.degrees(truth[2]):.4f}", f"{truth[3]:.5f}"]
        self._table.write(row)
        self.valid += reading.valid
        self.count += 1
        self._keep((time, reading.forward, reading.right, reading.heading, reading.range_m, float(reading.confidence),
                    *(truth or ())))
        turned = self._was_valid is not None and reading.valid != self._was_valid
        if turned or time >= self._next_shot:
            if len(self.shots) >= self.most:
                self._spread()
            if len(self.shots) < self.most:
                why = "" if not turned else ", found again" if reading.valid else ", lost"
                drawn = self._keep_picture(draw_reading(picture, reading, features, window))
                self.shots.append((f"{time:.1f} s{why}", drawn))
                self._turns.append(turned)
            self._next_shot = max(self._next_shot, time + self.often) if not turned else self._next_shot
        self._was_valid = reading.valid

    def _keep_picture(self, canvas: Image) -> Image:
        """A copy in memory that is taken with the first picture for all of them."""
        if not self._slots and not self.shots:
            self._slots = list(np.full((self.most, *canvas.shape), 1, np.uint8))
        slot = self._slots.pop()
        slot[:] = canvas
        return slot

    def _keep(self, row: tuple[float, ...]) -> None:
        """Take a row into the series: of each `_every` rows that of the least confidence."""
        if self._worst is None or row[CONFIDENCE] < self._worst[CONFIDENCE]:
            self._worst = row
        if self.count % self._every:
            return
        self._rows[self._filled] = self._worst
        self._filled += 1
        self._worst = None
        if self._filled == MOST_ROWS:
            pairs = self._rows.reshape(-1, 2, len(row))
            self._filled //= 2
            self._rows[:self._filled] = pairs[np.arange(len(pairs)), pairs[:, :, CONFIDENCE].argmin(1)]
            self._every *= 2

    def _spread(self) -> None:
        """Drop every second picture that was taken for the time alone, the first aside, and take them less often."""
        plain = [k for k, turned in enumerate(self._turns) if not turned]
        for k in reversed(plain[1::2]):
            self._slots.append(self.shots[k][1])
            del self.shots[k], self._turns[k]
        self.often *= 2

    @property
    def series(self) -> Floats:
        """(n, 6) time, forward, right, heading, range, confidence; (n, 10) with the four of the truth after them."""
        rows = self._rows[:self._filled]
        return np.vstack([rows, self._worst]) if self._worst else rows.copy()

    def close(self) -> None:
        """Close the table."""
        self._table.close()
