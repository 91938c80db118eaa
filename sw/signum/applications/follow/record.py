# SPDX-License-Identifier: Apache-2.0
"""Writes `follow.csv` row by row, and frames with windows and blob drawn in, as a film or for the report."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from signum.applications.follow.follower import State, Target
from signum.common.arrays import Image
from signum.frames.frame import grey
from signum.report.draw import GREEN, RED, YELLOW, write_line
from signum.report.movie import Movie
from signum.tables.schemas import FOLLOW, FOLLOW_TRUTH
from signum.tables.table import Table

ORANGE, WHITE, GRAY = (0, 150, 255), (240, 240, 240), (110, 110, 110)
STATE_COLOURS = {State.SEEN: YELLOW, State.KEPT: ORANGE, State.COASTING: ORANGE, State.LOST: RED}


def follow_row(frame: str, time: float, t: Target, factor: tuple[float, float] = (1.0, 1.0)) -> list[object]:
    """A row of `follow.csv`; `factor` is original pixels per pixel of the target."""
    kx, ky = factor
    place = ["", ""] if t.lost else [f"{(t.x + 0.5) * kx - 0.5:.1f}", f"{(t.y + 0.5) * ky - 0.5:.1f}"]
    blob: list[object] = ["", "", 0]
    if t.blob is not None and not t.lost:
        blob = [f"{t.blob.width * kx:.0f}", f"{t.blob.height * ky:.0f}", t.blob.windows]
    near = "" if t.lost or math.isnan(t.range_m) else f"{t.range_m:.3f}"
    return [frame, f"{time:.3f}", str(t.state), *place, *blob, near]


def draw_target(picture: Image, target: Target) -> Image:
    """A frame with the windows (green: not fish, red: fish, grey: not measured), the blob's box, the target and the
    centre quarter.

    Args:
        picture: uint8 (H, W) or (H, W, 3), in the target's pixels.
    """
    canvas = np.asarray(cv2.cvtColor(grey(picture), cv2.COLOR_GRAY2BGR), np.uint8)
    height, width = canvas.shape[:2]
    cv2.rectangle(canvas, (width // 4, height // 4), (width - width // 4, height - height // 4), WHITE, 1)
    s, colour = target.seen, STATE_COLOURS[target.state]
    if s is not None:
        for j, v in enumerate(s.y):
            for i, u in enumerate(s.x):
                dot = RED if s.fish[j, i] else ORANGE if s.changed[j, i] else GREEN if s.known[j, i] else GRAY
                cv2.circle(canvas, (int(u), int(v)), 2, dot, -1)
        if target.blob is not None:
            rows, columns = np.nonzero(target.blob.mask)
            half = (s.x[1] - s.x[0]) / 2 if s.x.size > 1 else 8.0
            low = int(s.x[columns].min() - half), int(s.y[rows].min() - half)
            high = int(s.x[columns].max() + half), int(s.y[rows].max() + half)
            cv2.rectangle(canvas, low, high, colour, 1, cv2.LINE_AA)
    if not target.lost:
        cv2.drawMarker(canvas, (round(target.x), round(target.y)), colour, cv2.MARKER_CROSS, 18, 2, cv2.LINE_AA)
    text = str(target.state) + ("" if target.lost or math.isnan(target.range_m) else f"  {target.range_m:.2f} m")
    write_line(canvas, text, 0.45)
    return canvas


@dataclass
class FollowRecord:
    """Writes `follow.csv`, and `follow.mp4` where a film is asked for; keeps frames for the report.

    Attributes:
        folder: exists. truth: whether rows contain the simulation's truth. rate: frames per second, of the film.
        often: seconds between two shots; most: largest number of shots, the frames in which the fish is lost or found
            included.
    """

    folder: Path
    truth: bool
    rate: float = 10.0
    film: bool = False
    often: float = 60.0
    most: int = 9
    shots: list[tuple[str, Image]] = field(default_factory=list)
    states: list[tuple[float, State]] = field(default_factory=list)
    _table: Table = field(init=False, repr=False)
    _movie: Movie | None = field(init=False, default=None, repr=False)
    _next_shot: float = field(init=False, default=1.0)

    def __post_init__(self) -> None:
        self._table = Table(self.folder / "follow.csv", [*FOLLOW, *FOLLOW_TRUTH] if self.truth else FOLLOW)

    def add(self, name: str, time: float, target: Target, picture: Image,
            factor: tuple[float, float] = (1.0, 1.0), truth: tuple[float, ...] | None = None) -> None:
        """Record a frame; `truth`: x, y (NaN out of view), range, pan and tilt in degrees."""
        row = follow_row(name, time, target, factor)
        if truth is not None:
            row += ["" if math.isnan(v) else f"{v:.3f}" for v in truth]
        self._table.write(row)
        turned = bool(self.states) and (target.state is State.LOST) != (self.states[-1][1] is State.LOST)
        self.states.append((time, target.state))
        if self.film or (len(self.shots) < self.most and (turned or time >= self._next_shot)):
            drawn = draw_target(picture, target)
            if self.film:
                self._show(drawn)
            if len(self.shots) < self.most and (turned or time >= self._next_shot):
                why = "" if not turned else ", lost" if target.lost else ", found"
                self.shots.append((f"{time:.1f} s{why}", drawn))
                self._next_shot = self._next_shot if turned else time + self.often

    def share(self, state: State) -> float:
        """Share of the frames in a state."""
        return sum(s is state for _, s in self.states) / max(len(self.states), 1)

    def _show(self, drawn: Image) -> None:
        if self._movie is None:
            self._movie = Movie(self.folder / "follow.mp4", self.rate)
        self._movie.write(drawn)

    def close(self) -> None:
        """Close the files."""
        self._table.close()
        if self._movie is not None:
            self._movie.close()
