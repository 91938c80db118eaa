# SPDX-License-Identifier: Apache-2.0
"""Figures of a simulated hold, from its readings and the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.reading import Reading
from signum.common.arrays import Floats, Image

WRONG_M, WRONG_RAD = 0.04, 0.02
"""A valid reading is wrong if its error exceeds one of these."""


@dataclass(frozen=True, eq=False)
class Moment:
    """One frame of a hold.

    Attributes:
        time: seconds.
        reading: of the frame.
        truth: offset (forward, right, down, heading), metres and radians in the station's axes.
        range_m: true range, metres.
        frame: uint8 (height, width).
        features: (n, 2) pixels, their positions by the reading.
        level: true roll and pitch, radians.
    """

    time: float
    reading: Reading
    truth: tuple[float, float, float, float]
    range_m: float
    frame: Image
    features: Floats
    level: tuple[float, float] = (0.0, 0.0)

    @property
    def row(self) -> tuple[float, ...]:
        """Time, truth (4), reading (forward, right, heading, range), confidence, true range, agreed, tried."""
        r = self.reading
        return (self.time, *self.truth, r.forward, r.right, r.heading, r.range_m, r.confidence, self.range_m, r.agreed,
                r.tried)


@dataclass
class HoldFigures:
    """Figures of a hold; metres, radians, fractions.

    Attributes:
        rms_m, heading_rms: true offset from the station and true heading, RMS.
        range_rms: true range relative to that at the station, RMS of the difference.
        range_miss: measured range of valid readings relative to the true range, RMS of the difference.
        drift_m: mean position of the last minute less that of the first.
        valid: share of valid readings.
        worst_valid_m: largest position error of a valid reading.
        wrong: valid readings whose error exceeds WRONG_M or WRONG_RAD.
        longest_blind: frames of the longest run without a valid reading.
        series: rows (n, 13) of `Moment.row`.
    """

    rms_m: float
    heading_rms: float
    range_rms: float
    range_miss: float
    drift_m: float
    valid: float
    worst_valid_m: float
    wrong: int
    longest_blind: int = 0
    series: Floats = field(default_factory=lambda: np.zeros((0, 13)), repr=False)


def judge_hold(moments: Sequence[Moment], settle: float = 10.0) -> HoldFigures:
    """Figures of a hold, from `settle` seconds on."""
    return judge_hold_rows(np.array([m.row for m in moments]), settle)


def judge_hold_rows(rows: Floats, settle: float = 10.0, apart: Sequence[tuple[float, float]] = ()) -> HoldFigures:
    """Figures of a hold from its moments' rows (n, 13), from `settle` seconds on.

    Args:
        apart: (from, to) seconds that do not count for the position, heading and range errors, as the vehicle was
            pushed or its view was blocked. They do count for wrong readings.
    """
    after = rows[rows[:, 0] >= settle]
    ok = after[:, 9] > 0
    miss = np.hypot(after[:, 5] - after[:, 1], after[:, 6] - after[:, 2])
    wrong = ok & ((miss > WRONG_M) | (np.abs(after[:, 7] - after[:, 4]) > WRONG_RAD))
    counts = np.ones(len(after), bool)
    for begin, end in apart:
        counts &= (after[:, 0] < begin) | (after[:, 0] >= end)
    calm = after[counts]
    first, last = calm[calm[:, 0] < settle + 60], calm[calm[:, 0] >= calm[-1, 0] - 60]
    drift = np.hypot(*(last[:, 1:3].mean(axis=0) - first[:, 1:3].mean(axis=0)))
    blind = max((len(run) for run in "".join("1" if v else "0" for v in ok).split("1")), default=0)
    station = rows[0, 10]
    return HoldFigures(
        float(np.sqrt((calm[:, 1] ** 2 + calm[:, 2] ** 2).mean())), float(np.sqrt((calm[:, 4] ** 2).mean())),
        float(np.sqrt(((calm[:, 10] / station - 1) ** 2).mean())),
        float(np.sqrt(((after[ok, 8] / after[ok, 10] - 1) ** 2).mean())), float(drift), float(ok.mean()),
        float(miss[ok].max()) if ok.any() else float("nan"), int(wrong.sum()), blind, rows)
