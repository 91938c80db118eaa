# SPDX-License-Identifier: Apache-2.0
"""Stereo range as `DISTANCE_SENSOR` (132): the median of the middle of the view."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from signum.applications.mavlink.base import LinkSink
from signum.applications.mavlink.pace import Pace
from signum.common.arrays import Floats

RATE = 20.0
"""Largest number of messages a second: ArduPilot's filter reads its range finders every 50 ms (`sensorIntervalMin_ms`,
AP_NavEKF3.h)."""
LEAST_WINDOWS = 4
"""Valid windows in the middle of the view below which there is no distance."""
LONGEST_CM = 65535
NORMAL = 1.4826
"""Standard deviation of a normal distribution by its median absolute deviation."""
FACING = {"down": 25, "forward": 0}
"""MAV_SENSOR_ORIENTATION of the directions in which a pair of cameras may look."""


class Distance(NamedTuple):
    """Of what the middle of the view shows: metres along the optical axis, its standard error, metres, and the share of
    the windows that are valid, 0..1."""

    metres: float
    error: float
    share: float


def middle_distance(depth: Floats) -> Distance | None:
    """The median of the middle half of a grid of ranges, in both directions.

    Args:
        depth: (ny, nx) metres along the optical axis, NaN where not valid.

    Returns:
        None where fewer than `LEAST_WINDOWS` are valid.
    """
    rows, columns = (slice(n // 4, n - n // 4) for n in depth.shape)
    middle = depth[rows, columns]
    valid = middle[np.isfinite(middle)]
    if valid.size < LEAST_WINDOWS:
        return None
    metres = float(np.median(valid))
    spread = NORMAL * float(np.median(np.abs(valid - metres)))
    return Distance(metres, spread * math.sqrt(math.pi / 2 / valid.size), valid.size / middle.size)


class DistanceSink(LinkSink):
    """Sends the distance of each pair that shows one.

    Args:
        address: see `open_channel`.
        facing: direction in which the cameras look: a key of `FACING`.
        limits: shortest and longest distance that the search can find, metres.
        view: angles of the middle of the view across and down, radians.
    """

    def __init__(self, address: str, facing: str, limits: tuple[float, float], view: tuple[float, float]) -> None:
        super().__init__(address)
        self._orientation, self._view = FACING[facing], view
        low, high = (min(LONGEST_CM, 100 * m) for m in limits)
        self._limits = math.ceil(low), math.floor(high)
        self._pace = Pace(RATE, 0.0)

    def send(self, time: float, depth: Floats) -> None:
        """Send the distance of a pair, if it shows one and a message is due; see `middle_distance`.

        Args:
            time: of the pair, seconds.
            depth: (ny, nx) metres along the optical axis, NaN where not valid.
        """
        found = middle_distance(depth) if self._pace.due(time) else None
        if found is None:
            return
        m = self.link.messages
        variance = min(254, max(1, round((100 * found.error)**2)))
        if self.link.send(m.MAVLink_distance_sensor_message(
                self.stamp(time) // 1000 % 2**32, *self._limits, min(LONGEST_CM, round(100 * found.metres)),
                m.MAV_DISTANCE_SENSOR_UNKNOWN, 0, self._orientation, variance, *self._view, [0.0] * 4,
                max(1, round(100 * found.share)))):
            self._pace.sent(time)
