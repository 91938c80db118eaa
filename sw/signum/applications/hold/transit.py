# SPDX-License-Identifier: Apache-2.0
"""Readings over ground on which the reference changes: a new one is taken before the present one leaves the view.

A station is held without drift, as its reference never changes. On a way, each change adds the error of the reading at
which it was made, and what its heading's error does to the way that follows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from signum.applications.hold.reading import Reading

LEAVING = 0.5
"""Share of the reference in view below which the present view becomes the reference."""


@dataclass
class Transit:
    """Where the present reference is.

    Attributes:
        base: the reading, from the first station, at which the present reference was taken.
        start_m: range at the first station, metres.
    """

    start_m: float
    base: Reading = field(default_factory=Reading)

    def whole(self, reading: Reading) -> Reading:
        """A reading against the present reference as one from the first station; its errors are all that add up."""
        if not reading.valid:
            return reading
        base, way = self.base, math.hypot(reading.forward, reading.right)
        return replace(
            reading.after(base), zoom=self.start_m / reading.range_m,
            offset_error=math.hypot(base.offset_error, way * base.heading_error / math.sqrt(2), reading.offset_error),
            heading_error=math.hypot(base.heading_error, reading.heading_error),
            range_error=math.hypot(base.range_error, reading.range_error))

    def change(self, reading: Reading) -> Reading:
        """Take a view for the reference, with its reading against the one before; returns it from the first station."""
        self.base = self.whole(reading)
        return self.base

    def rescale(self, ratio: float) -> None:
        """Take all ranges to be `ratio` times as large."""
        self.start_m *= ratio
        self.base = self.base.scaled(ratio)
