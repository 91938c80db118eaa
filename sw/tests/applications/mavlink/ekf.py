# SPDX-License-Identifier: Apache-2.0
"""What ArduPilot does with messages of external navigation, as far as their sender has to know.

Each rule names its source, a file of https://github.com/ArduPilot/ardupilot under `libraries/`, or a page of
https://ardupilot.org. Only what decides on a message is here: no filter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

INTERVAL_MS = 50
"""AP_NavEKF3/AP_NavEKF3.h, `sensorIntervalMin_ms`: a body odometry that comes earlier is dropped."""
POSE_INTERVAL_MS = 20
"""The same, `extNavIntervalMin_ms`, of poses."""
FILTER_STEP_S = 0.01
"""AP_NavEKF3_Measurements.cpp, `writeBodyFrameOdom`: a delta over less than the filter's step `dtEkfAvg` is lost."""
SPEED_ERROR = 0.1, 0.9
"""AP_NavEKF3.cpp, `VIS_VERR_MIN` and `VIS_VERR_MAX`, m/s: error of the speed at confidence 100 and at 0; the confidence
does nothing else, so a delta of confidence 0 is used."""
READY_ERROR, READY_MS = 1.0, 200
"""AP_NavEKF3_Control.cpp, `readyToUseBodyOdm`: largest error, m/s, and greatest age to begin aiding."""
HEALTHY_MS = 300
"""AP_VisualOdom/AP_VisualOdom_Backend.cpp, `healthy` (`AP_VISUALODOM_TIMEOUT_MS`)."""
RECKON_MS = 1000
"""AP_NavEKF3.h, `deadReckonDeclare_ms`: time without a velocity or position until dead reckoning is declared."""
POSE_NOISE, YAW_NOISE = (0.2, 100.0), (0.2, 1.5)
"""AP_VisualOdom/AP_VisualOdom_MAV.cpp, `handle_pose_estimate`: bounds of the errors, with `VISO_POS_M_NSE` (m) and
`VISO_YAW_M_NSE` (rad) at their defaults."""
LEAST_QUALITY = 0
"""AP_VisualOdom.cpp, `VISO_QUAL_MIN`: a pose of less quality is dropped; -1 is failed, 0 unknown."""
LEAST_HZ = 4.0
"""ardupilot.org/dev/docs/mavlink-nongps-position-estimation.html: poses should come at 4 Hz or more."""
FLOW_RATE = 4.2
"""AP_NavEKF3_Measurements.cpp, `writeOptFlowMeas`: largest flow that is used, rad/s; nor is one of quality 0."""
FLOW_TIMEOUT_S = 0.5
"""AP_OpticalFlow/AP_OpticalFlow_MAV.cpp, `update`: after a longer pause a flow is taken for none."""
FRAMES = 20, 12
"""GCS_MAVLink/GCS_Common.cpp, `handle_odometry`: MAV_FRAME_LOCAL_FRD and MAV_FRAME_BODY_FRD, no others."""


@dataclass
class ExternalNav:
    """The autopilot's entrance for external navigation.

    Attributes:
        speeds: (time_s, over_s, forward, right, error) of the velocities that it took from deltas: m/s in the body's
            axes, mean of the `over_s` before `time_s`.
        poses: (time_s, (x, y, z), yaw, error, yaw_error, reset) that it took.
        dropped: messages that it did not take, with the reason.
    """

    speeds: list[tuple[float, float, float, float, float]] = field(default_factory=list)
    poses: list[tuple[float, tuple[float, float, float], float, float, float, bool]] = field(default_factory=list)
    dropped: list[str] = field(default_factory=list)
    _came: float = 0.0
    _counter: int | None = None
    _flow: float | None = None

    def take(self, message: Any, arrived: float) -> None:
        """Take a message that arrived at a time, seconds."""
        handler = getattr(self, f"_{message.get_type().lower()}", None)
        if handler is not None:
            handler(message, arrived)

    def _vision_position_delta(self, m: Any, arrived: float) -> None:
        """`handle_vision_position_delta_msg`, which uses the time of arrival, then `writeBodyFrameOdom`."""
        values = [*m.position_delta, *m.angle_delta, m.confidence]
        now, over = m.time_usec / 1e6, m.time_delta_usec / 1e6
        if any(map(math.isnan, values)):
            self.dropped.append("delta: not a number")
        elif over < FILTER_STEP_S or (self.speeds and 1e3 * (arrived - self._came) < INTERVAL_MS):
            self.dropped.append("delta: too early")
        else:
            low, high = SPEED_ERROR
            error = low + (high - low) * (1 - 0.01 * m.confidence)
            self._came = arrived
            self.speeds.append((now, over, m.position_delta[0] / over, m.position_delta[1] / over, error))

    def _vision_position_estimate(self, m: Any, arrived: float) -> None:
        self._pose(m.usec / 1e6, (m.x, m.y, m.z), m.yaw, m.covariance, m.reset_counter, 0)

    def _odometry(self, m: Any, arrived: float) -> None:
        if (m.frame_id, m.child_frame_id) != FRAMES:
            self.dropped.append("odometry: frame")
            return
        w, x, y, z = m.q
        yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        self._pose(m.time_usec / 1e6, (m.x, m.y, m.z), yaw, m.pose_covariance, m.reset_counter, m.quality)

    def _pose(self, now: float, place: tuple[float, float, float], yaw: float, covariance: list[float], counter: int,
              quality: int) -> None:
        """`handle_odometry`, `handle_pose_estimate`, `get_reset_timestamp_ms`, then `writeExtNavData`."""
        error = turn = 0.0
        if not math.isnan(covariance[0]):
            error, turn = (math.cbrt(sum(covariance[k]**2 for k in places)) for places in ((0, 6, 11), (15, 18, 20)))
        error, turn = (min(max(e, low), high) for e, (low, high) in ((error, POSE_NOISE), (turn, YAW_NOISE)))
        if quality < LEAST_QUALITY:
            self.dropped.append("pose: quality")
        elif any(map(math.isnan, place)):
            self.dropped.append("pose: not a number")
        elif self.poses and 1e3 * (now - self.poses[-1][0]) < POSE_INTERVAL_MS:
            self.dropped.append("pose: too early")
        else:
            self.poses.append((now, place, yaw, error, turn, self._counter not in (None, counter)))
            self._counter = counter

    @property
    def starts(self) -> bool:
        """Whether the last delta lets the filter begin aiding."""
        return bool(self.speeds) and self.speeds[-1][4] < READY_ERROR

    @staticmethod
    def pauses(times: list[float], longest_ms: float) -> list[float]:
        """Times before which nothing came for longer."""
        return [b for a, b in pairwise(times) if 1e3 * (b - a) > longest_ms]

    def flow(self, m: Any) -> tuple[float, float] | None:
        """Flow about x and y that the filter takes of an `OPTICAL_FLOW`, rad/s in the vehicle's sense; None for none.

        `AP_OpticalFlow_MAV::handle_msg` takes the fields in rad/s once one of them was not 0.
        """
        now, last = m.time_usec / 1e6, self._flow
        self._flow = now
        if last is None or not 0 < now - last < FLOW_TIMEOUT_S or not m.quality:
            return None
        return None if math.hypot(m.flow_rate_x, m.flow_rate_y) >= FLOW_RATE else (m.flow_rate_x, m.flow_rate_y)
