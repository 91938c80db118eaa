# SPDX-License-Identifier: Apache-2.0
"""Optical flow as `OPTICAL_FLOW` (100), in radians per second about the vehicle's axes.

The camera looks down, the top of its picture ahead. A vehicle that moves to the right at speed v at range Z sees the
floor move to the left, by f v / Z pixels a second; so would one that rolls to the left. MAVLink's flow about an axis is
the turn of the sensor, by the right-hand rule, that would cause the flow: dx / (f dt) about x, which points ahead, and
dy / (f dt) about y, which points to the right. Both are raw: the autopilot takes out its own turning.
"""

from __future__ import annotations

from signum.applications.mavlink.base import LinkSink
from signum.applications.mavlink.pace import Pace
from signum.measure.flow import FlowField

RATE = 30.0
"""Largest number of messages a second."""
LEAST_S = 0.02
"""Shortest time between two, seconds: ArduPilot's filter drops an earlier one (`flowIntervalMin_ms`, AP_NavEKF3.h)."""
UNKNOWN_M = -1.0
"""Ground distance that is not known."""


def flow_rates(field: FlowField, focal: tuple[float, float], dt: float) -> tuple[float, float]:
    """Flow about x and about y, radians per second: of the median displacement.

    Args:
        field: in the pixels of `focal`.
        focal: across and down, pixels.
        dt: seconds between the two frames.
    """
    dx, dy = field.dominant()
    return dx / (focal[0] * dt), dy / (focal[1] * dt)


class FlowSink(LinkSink):
    """Sends the flow between frames; of a field without a valid window nothing."""

    def __init__(self, address: str) -> None:
        super().__init__(address)
        self._pace = Pace(RATE, LEAST_S)

    def send(self, time: float, dt: float, field: FlowField, focal: tuple[float, float]) -> None:
        """Send a field, if it has a valid window and a message is due.

        Args:
            time: of the later frame, seconds.
            dt: seconds since the earlier one.
            field: between them, in the pixels of `focal`.
            focal: across and down, pixels.
        """
        if dt <= 0 or not field.valid.any() or not self._pace.due(time):
            return
        x, y = flow_rates(field, focal, dt)
        quality = max(1, round(255 * float(field.valid.mean())))
        if self.link.send(self.link.messages.MAVLink_optical_flow_message(
                self.stamp(time), 0, 0, 0, 0.0, 0.0, quality, UNKNOWN_M, x, y)):  # whole rad/s are of no use
            self._pace.sent(time)
