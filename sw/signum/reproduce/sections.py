"""What the page of `make reproduce` is made of, in its order."""

from __future__ import annotations

from signum.reproduce import Maker, filter, flow, follow, hold, mosaics, navigate, stereo, survey, tracking

MAKERS: dict[str, Maker] = {
    "filter": filter.make, "flow": flow.make, "tracking": tracking.make, "stereo": stereo.make, "hold": hold.make,
    "follow": follow.make, "mosaics": mosaics.make, "survey": survey.make, "navigate": navigate.make}
