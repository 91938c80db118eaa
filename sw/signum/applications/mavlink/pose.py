# SPDX-License-Identifier: Apache-2.0
"""Readings as absolute poses: `VISION_POSITION_ESTIMATE` (102) and `ODOMETRY` (331)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from signum.applications.hold.reading import UPRIGHT, Level, Reading
from signum.applications.mavlink.link import Link
from signum.applications.mavlink.pace import Pace
from signum.applications.mavlink.stamp import Stamp

UNKNOWN_TILT = 0.1
"""Standard error of roll and pitch where no attitude is known, radians: the vehicle is taken to be level."""
LEAST_S = 0.02
"""Shortest time between two poses, seconds: ArduPilot's filter drops an earlier one (`extNavIntervalMin_ms` of
AP_NavEKF3.h)."""
STATES = 6
"""x, y, z, roll, pitch, yaw: the covariance's rows."""


def covariance(reading: Reading, tilted: bool) -> list[float]:
    """Upper triangle (21,) of a reading's covariance, row by row: x, y, z in metres, roll, pitch, yaw in radians.

    Position, range and heading are those of the fit; an error of the range at the station, which scales all of them,
    is not among them.

    Args:
        reading: valid.
        tilted: whether roll and pitch are the vehicle's; they then have the heading's error.
    """
    tilt = reading.heading_error if tilted else UNKNOWN_TILT
    errors = [reading.offset_error, reading.offset_error, reading.range_error, tilt, tilt, reading.heading_error]
    whole = np.diag(np.square(errors))
    return [float(v) for v in whole[np.triu_indices(STATES)]]


def quaternion(roll: float, pitch: float, yaw: float) -> list[float]:
    """The rotation by yaw, then pitch, then roll, radians, from body to reference: w, x, y, z."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a / 2), math.sin(a / 2)) for a in (roll, pitch, yaw))
    return [cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]


def _down(r: Reading) -> float:
    """How far the vehicle is below its station, metres: its range then less that of now."""
    return (r.zoom - 1) * r.range_m


class PoseSender:
    """Sends the offset from the station, absolute, while it is valid.

    Args:
        link: to the autopilot.
        stamp: of the messages.
        rate: largest number of messages a second.
        message: `estimate` or `odometry`.

    Attributes:
        sent: messages that the link took.
        resets: changes of the reference; `reset_counter` is their number modulo 256.
    """

    def __init__(self, link: Link, stamp: Stamp, rate: float, message: str) -> None:
        self._link, self._stamp = link, stamp
        self._make = {"estimate": self._estimate, "odometry": self._odometry}[message]
        self._pace = Pace(rate, LEAST_S)
        self._reference: tuple[int, float] | None = None
        self.sent = self.resets = 0

    def send(self, time: float, reading: Reading, level: Level | None = None, north: float = 0.0) -> None:
        """Send a reading, if it is valid and a message is due.

        Args:
            time: of the frame, seconds.
            reading: of the frame.
            level: the vehicle's roll and pitch at that time; None where they are not known.
            north: heading of the station's axes from north, radians; the estimate's axes are turned by it.
        """
        if not reading.valid or not self._pace.due(time):
            return
        reference = reading.reference, north
        if self._reference is not None and reference != self._reference:
            self.resets += 1
        self._reference = reference
        if self._link.send(self._make(self._stamp(time), reading, level, north)):
            self._pace.sent(time)
            self.sent += 1

    def _estimate(self, stamp: int, r: Reading, level: Level | None, north: float) -> Any:
        roll, pitch, *_ = level or UPRIGHT
        c, s = math.cos(north), math.sin(north)
        return self._link.messages.MAVLink_vision_position_estimate_message(
            stamp, c * r.forward - s * r.right, s * r.forward + c * r.right, _down(r), roll, pitch,
            math.remainder(r.heading + north, 2 * math.pi), covariance(r, level is not None), self.resets % 256)

    def _odometry(self, stamp: int, r: Reading, level: Level | None, north: float) -> Any:
        m = self._link.messages
        roll, pitch, *_ = level or UPRIGHT
        unknown = math.nan  # speeds are not measured; NaN says so
        return m.MAVLink_odometry_message(
            stamp, m.MAV_FRAME_LOCAL_FRD, m.MAV_FRAME_BODY_FRD, r.forward, r.right, _down(r),
            quaternion(roll, pitch, r.heading), *[unknown] * 6, covariance(r, level is not None), [unknown] * 21,
            self.resets % 256, m.MAV_ESTIMATOR_TYPE_VISION, r.confidence)
