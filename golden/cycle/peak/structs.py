# SPDX-License-Identifier: Apache-2.0
"""Packed structs of rtl/peak/slog_peak_pkg.sv as Python layouts.

A score that may be absent (`maybe_t`) is {present, score}: `PRESENT + score`, or 0.
"""

from __future__ import annotations

from golden.params import NO_SCORE, SCORE_BITS
from golden.structs import Layout

PRESENT = 1 << SCORE_BITS
"""Value of the present bit."""
SCORE_ROW = Layout(("tag", 16), ("status", 3), ("last_x", 10), ("y", 10), ("first", 1), ("last", 1))
"""`row_t`: a row of a job's scores."""
SCORING = Layout(("surface", 1), ("one", 1), ("two", 1), ("area", 15))
SCAN = Layout(("fresh", 1), ("last", 1), ("above", 1), ("middle", 1), ("below", 1), ("only", 1), ("brief", 1),
              ("last_x", 10), ("best_x", 10))
OUTCOME = Layout(("fresh", 1), ("last", 1), ("other", 16), ("tag", 16), ("status", 3), ("best_x", 10), ("best_y", 10),
                 ("score", 16))
VERDICT = Layout(("tag", 16), ("status", 3), ("best_x", 10), ("best_y", 10), ("score", 15), ("runner_up", 15))



def or_no_score(value: int) -> int:
    """The score of a `maybe_t` as results carry it: NO_SCORE where it is absent."""
    return value - PRESENT if value else NO_SCORE
