# SPDX-License-Identifier: Apache-2.0
"""What the station meter takes in and gives out: how the camera is inclined, and the vehicle's offset."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from signum.common.arrays import Floats
from signum.geometry.camera import LOOK_DOWN, pan_tilt, rotation


class Level(NamedTuple):
    """How the camera is turned from looking straight down, radians: the vehicle's roll and pitch, (0, 0) where it has
    no attitude sensor, and the angles of the pan/tilt, (0, 0) where the camera is fixed."""

    roll: float = 0.0
    pitch: float = 0.0
    pan: float = 0.0
    tilt: float = 0.0

    @property
    def turn(self) -> Floats:
        """Camera to level camera (3, 3)."""
        return LOOK_DOWN.T @ rotation(self.roll, self.pitch, 0.0) @ LOOK_DOWN @ pan_tilt(self.pan, self.tilt)


UPRIGHT = Level()


@dataclass(frozen=True)
class Reading:
    """The vehicle's offset from its station.

    Attributes:
        forward: metres in the reference's body axes, level.
        right: the same.
        heading: radians, clockwise seen from above.
        zoom: initial range divided by the present one.
        range_m: present range, metres.
        confidence: 0 to 100; where it is 0, no other field is valid.
        agreed: features that agree.
        tried: features searched for.
        offset_error: standard error of `forward` and of `right` by the fit, metres; that of the assumed range, which
            scales them, is not in it.
        heading_error: of `heading`, radians.
        range_error: of `range_m`, metres, in the same way.
        reference: number of times that what is measured against has changed, or its range.
    """

    forward: float = 0.0
    right: float = 0.0
    heading: float = 0.0
    zoom: float = 1.0
    range_m: float = 0.0
    confidence: int = 0
    agreed: int = 0
    tried: int = 0
    offset_error: float = 0.0
    heading_error: float = 0.0
    range_error: float = 0.0
    reference: int = 0

    @property
    def valid(self) -> bool:
        """Whether the offset may be used."""
        return self.confidence > 0

    def scaled(self, ratio: float) -> Reading:
        """This reading where all ranges, and so all metres, are `ratio` times as large."""
        return replace(self, forward=self.forward * ratio, right=self.right * ratio, range_m=self.range_m * ratio,
                       offset_error=self.offset_error * ratio, range_error=self.range_error * ratio)

    def since(self, base: Reading) -> Reading:
        """This reading relative to a reference taken at `base`: the inverse of `after`."""
        c, s = np.cos(base.heading), np.sin(base.heading)
        ahead, aside = self.forward - base.forward, self.right - base.right
        return replace(self, forward=float(c * ahead + s * aside), right=float(-s * ahead + c * aside),
                       heading=self.heading - base.heading)

    def after(self, base: Reading) -> Reading:
        """This reading, measured against a reference taken at `base`, relative to base's own station."""
        c, s = np.cos(base.heading), np.sin(base.heading)
        return replace(self, forward=base.forward + float(c * self.forward - s * self.right),
                       right=base.right + float(s * self.forward + c * self.right), heading=base.heading + self.heading)
