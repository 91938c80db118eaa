# SPDX-License-Identifier: Apache-2.0
"""Figures of a simulated chase, from the follower's targets and the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from signum.applications.follow.follower import State


class ChaseRow(NamedTuple):
    """A frame of a chase without its picture: time, whether the fish is in the centre quarter, its true pixel (NaN out
    of view), the follower's state and pixel, and the fish's length in pixels."""

    time: float
    centred: bool
    true_x: float
    true_y: float
    state: State
    x: float
    y: float
    length_px: float


@dataclass(frozen=True)
class ChaseFigures:
    """Figures of a chase: shares of the frames, and seconds.

    Attributes:
        centred: share in which the fish is in the centre quarter.
        in_view: share in which it is in view.
        lost: share in which it is reported lost.
        wrong: share in which it is not reported lost, yet the target is farther from it than its length.
        silent_s: longest time out of view without being reported lost.
        longest_lost_s: longest time reported lost.
        finds: number of times it was found again.
    """

    centred: float
    in_view: float
    lost: float
    wrong: float
    silent_s: float
    longest_lost_s: float
    finds: int


def judge_chase(rows: Sequence[ChaseRow], rate: float = 10.0, settle: float = 5.0) -> ChaseFigures:
    """Figures of a chase at `rate` frames a second, from `settle` seconds on."""
    rows = [r for r in rows if r.time >= settle]
    seen = np.array([np.isfinite(r.true_x) for r in rows])
    lost = np.array([r.state is State.LOST for r in rows])
    far = np.array([not np.hypot(r.x - r.true_x, r.y - r.true_y) <= r.length_px for r in rows])
    return ChaseFigures(float(np.mean([r.centred for r in rows])), float(seen.mean()), float(lost.mean()),
                        float((~lost & far).mean()), _longest(~seen & ~lost) / rate, _longest(lost) / rate,
                        int((lost[:-1] & ~lost[1:]).sum()))


def _longest(flags: NDArray[np.bool_]) -> int:
    return max((len(run) for run in "".join("1" if f else "0" for f in flags).split("0")), default=0)
