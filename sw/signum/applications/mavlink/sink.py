# SPDX-License-Identifier: Apache-2.0
"""Readings of station keeping to an autopilot, in the message that it takes."""

from __future__ import annotations

import numpy as np

from signum.applications.hold.reading import Level, Reading
from signum.applications.mavlink.base import LinkSink
from signum.applications.mavlink.delta import LONGEST_GAP_S, DeltaSender
from signum.applications.mavlink.pose import PoseSender
from signum.common.arrays import Floats
from signum.common.errors import SignumError

MESSAGES = {"delta": 10.0, "estimate": 30.0, "odometry": 30.0}
"""Largest number of messages a second of each kind. ArduPilot's filter takes 20 deltas and 50 poses a second."""


class MavlinkSink(LinkSink):
    """Sends readings over a link of its own.

    Args:
        address: `udpout:HOST:PORT`, `udpin:HOST:PORT`, `tcp:HOST:PORT` or `serial:DEVICE:BAUD`.
        rate: largest number of messages a second; None for the message's own.
        message: `delta` (`VISION_POSITION_DELTA`), `estimate` (`VISION_POSITION_ESTIMATE`) or `odometry` (`ODOMETRY`).

    Attributes:
        link: to the autopilot; its `vehicle` has what arrived.
        stamp: of the messages.

    Raises:
        SignumError: if pymavlink is not installed, or the address cannot be opened or resolved or is refused, or there
            is no such message.
    """

    def __init__(self, address: str, rate: float | None = None, message: str = "delta") -> None:
        if message not in MESSAGES:
            raise SignumError(f"--message {message}: choose one of {', '.join(MESSAGES)}")
        super().__init__(address)
        rate = rate or MESSAGES[message]
        self._deltas = DeltaSender(self.link, self.stamp, rate) if message == "delta" else None
        self._poses = PoseSender(self.link, self.stamp, rate, message) if message != "delta" else None

    @property
    def gaps(self) -> int:
        """Times that the reference of the deltas changed without a message."""
        return self._deltas.gaps if self._deltas else 0

    @property
    def lost(self) -> Floats:
        """Change of `forward`, `right` and `heading` over the gaps, metres and radians, (3,). Deltas of position, each
        turned by the heading at its beginning, add up to the last valid reading less the first and less this."""
        return self._deltas.lost if self._deltas else np.zeros(3)

    @property
    def said(self) -> str:
        """How many messages were sent, and what was not, for the line on an outcome."""
        forward, right, _ = self.lost
        gaps = (f" ({self.gaps} gaps of over {LONGEST_GAP_S:g} s not sent: {forward:+.3f} m ahead, {right:+.3f} m to "
                "the right)" if self.gaps else "")
        resets = self._poses.resets if self._poses else 0
        return super().said + gaps + (f", reference changed {resets} times" if resets else "")

    def send(self, time: float, reading: Reading, level: Level | None = None, north: float = 0.0) -> None:
        """Send a reading, if it is valid and a message is due; of one that is not valid nothing is ever sent.

        Args:
            time: of the frame, seconds.
            reading: of the frame.
            level: the vehicle's roll and pitch at that time; None where they are not known.
            north: heading of the station's axes from north, radians, for the estimate.
        """
        if self._deltas is not None:
            self._deltas.send(time, reading)
        elif self._poses is not None:
            self._poses.send(time, reading, level, north)

    def close(self) -> None:
        """Send what is left, and close the link."""
        if self._deltas is not None:
            self._deltas.finish()
        super().close()
