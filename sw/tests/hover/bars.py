# SPDX-License-Identifier: Apache-2.0
"""Readings of hover clips against their truth, and the bars they are held to."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.watch import StationFrame, watch_station
from signum.boards.board import Board
from signum.common.arrays import Floats
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.measure.measurer import Measurer
from tests.hover.clips import FOCAL, RANGE_M, RATE, SIZE, Clip, Moment, render

SIGMA, WINDOW = 2.0, 64
"""The defaults of `signum hold`."""
HALF = 0.5
"""Share of the reference in sight from which a reading is due."""
GOOD = np.array([0.01, math.radians(0.3), 0.01])
"""Metres, radians and share of the range within which a reading of those is good."""
WRONG = np.array([0.05, math.radians(1.5), 0.05])
"""The same, outside of which a valid reading is wrong, in sight or not."""
BACK_FRAMES = 10
"""Frames in which a reading is due after half of the reference has come into sight again."""


@dataclass
class Figures:
    """Of some clips: counts of frames, and the rest of the figures.

    Attributes:
        due: frames that show half of the reference or more, the first frame aside; read: those with a reading.
        good: of these, within GOOD.
        valid: all valid readings; wrong: of these, outside WRONG.
        returns: frames from when half was in sight again to the first reading, for each loss.
        worst: largest errors of due readings: metres, radians, share.
        lost_ms: processor time of frames without a reading, calm_ms: of the others.
    """

    due: int = 0
    read: int = 0
    good: int = 0
    valid: int = 0
    wrong: int = 0
    returns: list[int] = field(default_factory=list)
    worst: Floats = field(default_factory=lambda: np.zeros(3))
    lost_ms: list[float] = field(default_factory=list)
    calm_ms: list[float] = field(default_factory=list)

    def __add__(self, other: Figures) -> Figures:
        return Figures(self.due + other.due, self.read + other.read, self.good + other.good, self.valid + other.valid,
                       self.wrong + other.wrong, self.returns + other.returns, np.maximum(self.worst, other.worst),
                       self.lost_ms + other.lost_ms, self.calm_ms + other.calm_ms)

    @property
    def bars(self) -> list[tuple[str, float, str, float]]:
        """Name, figure, relation and bound of each bar."""
        return [("frames with half of the reference in sight: with a reading, %", 100 * self.read / max(1, self.due),
                 ">=", 95.0),
                ("of these within 1 cm, 0.3 degrees, 1 %, %", 100 * self.good / max(1, self.read), ">=", 99.0),
                ("valid readings outside 5 cm, 1.5 degrees, 5 %", float(self.wrong), "<=", 0.0),
                ("frames until a reading, half of the reference in sight again", float(max(self.returns, default=0)),
                 "<=", BACK_FRAMES)]

    @property
    def met(self) -> bool:
        """Whether all bars are."""
        return all(value >= bound if relation == ">=" else value <= bound for _, value, relation, bound in self.bars)


def measure(board: Board, clip: Clip) -> Figures:
    """Render a clip and measure it as `signum hold --source` does."""
    fit = Fit.to(SIZE, board.config, WINDOW, clip.name)
    moments: list[Moment] = []

    def frames() -> Iterator[Frame]:
        for k, moment in enumerate(render(clip)):
            moments.append(moment)
            yield Frame(str(k), moment.picture, k / RATE)

    seen, spent = [], []
    watched = watch_station(Measurer(board, fit.board, SIGMA), frames(), fit, FOCAL, RANGE_M, RATE, WINDOW)
    while True:
        begun = time.process_time()
        one = next(watched, None)
        if one is None:
            break
        seen.append(one)
        spent.append(1e3 * (time.process_time() - begun))
    return judge(moments, seen, spent, clip.blind[0])


def judge(moments: Sequence[Moment], seen: Sequence[StationFrame], spent_ms: Sequence[float],
          begin: int) -> Figures:
    """Figures of a clip whose disturbance begins with frame `begin`; the first frame, the reference, is left out."""
    out = Figures()
    since: int | None = None
    for k, (moment, one) in enumerate(zip(moments, seen, strict=True)):
        reading, pose = one.reading, moment.pose
        (out.calm_ms if reading.valid else out.lost_ms).append(spent_ms[k])
        due = moment.open and pose.in_sight >= HALF
        if k and due:
            out.due += 1
            out.read += reading.valid
        if reading.valid:
            misses = np.array([math.hypot(reading.forward + pose.back, reading.right - pose.right),
                               abs(math.remainder(reading.heading - pose.heading, 2 * math.pi)),
                               abs(reading.range_m / pose.range_m - 1)])
            out.valid += 1
            out.wrong += not (moment.open and (misses <= WRONG).all())
            if k and due:
                out.good += bool((misses <= GOOD).all())
                out.worst = np.maximum(out.worst, misses)
        lost = k >= begin and not due
        if lost:
            since = None
        elif since is None and k and not _was_due(moments, k - 1):
            since = k
        if since is not None and reading.valid:
            out.returns.append(k - since)
            since = None
    if since is not None:
        out.returns.append(len(moments) - since)
    return out


def _was_due(moments: Sequence[Moment], k: int) -> bool:
    return moments[k].open and moments[k].pose.in_sight >= HALF
