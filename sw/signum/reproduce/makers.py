# SPDX-License-Identifier: Apache-2.0
"""The makers of the page of `make reproduce`, by name, in the order of the page."""

from __future__ import annotations

from signum.reproduce import Maker, filter, flow, follow, hold, mosaics, navigate, stereo, survey, tracking

MAKERS: dict[str, Maker] = {
    "filter": filter.make, "flow": flow.make, "tracking": tracking.make, "stereo": stereo.make, "hold": hold.make,
    "follow": follow.make, "mosaics": mosaics.make, "survey": survey.make, "navigate": navigate.make}
