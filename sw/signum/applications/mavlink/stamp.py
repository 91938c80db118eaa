# SPDX-License-Identifier: Apache-2.0
"""The stamps of messages: of the autopilot's clock where it is known, else of the frames' own."""

from __future__ import annotations

from signum.applications.mavlink.clock import VehicleClock


class Stamp:
    """Microseconds of a frame's time.

    Which clock the stamps are of is decided by the first one and kept, as a jump would disturb the autopilot's
    correction of jitter.

    Args:
        clock: the autopilot's.

    Attributes:
        origin: monotonic time of a frame of time 0, seconds; None where frames and monotonic clock have nothing to do
            with each other, and stamps are of the frames' own clock.
    """

    def __init__(self, clock: VehicleClock) -> None:
        self._clock = clock
        self._offset: float | None = None
        self._begun = False
        self.origin: float | None = None

    def __call__(self, time: float) -> int:
        """Of a frame's time, seconds."""
        if not self._begun or self._offset is not None:
            offset = self._clock.offset
            if self.origin is not None and offset is not None:
                self._offset = self.origin + offset
            self._begun = True
        return max(0, round((time + (self._offset or 0.0)) * 1e6))
