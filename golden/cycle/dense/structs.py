# SPDX-License-Identifier: Apache-2.0
"""Packed structs of rtl/dense/slog_dense_pkg.sv as Python layouts."""

from __future__ import annotations

from golden.structs import Layout

SUM_BITS, INDEX_BITS = 11, 8
NO_SUM = (1 << SUM_BITS) - 1
"""`Absent`: no offset counts there."""
BITS = Layout(("incoming", 1), ("leaving", 1), ("incoming_ago", 1), ("leaving_ago", 1))
LEFT = Layout(("in_row", 1), ("first", 1), ("bits", BITS.bits))
RIGHT = Layout(("in_row", 1), ("bits", BITS.bits))
WINNER = Layout(("fresh", 1), ("index", INDEX_BITS),
                *((name, SUM_BITS) for name in ("best", "lower", "upper", "rest", "earlier", "last")))
BACK = Layout(("index", INDEX_BITS), ("best", SUM_BITS))
NO_WINNER = WINNER.pack({"fresh": 0, "index": 0, **dict.fromkeys(("best", "lower", "upper", "rest", "earlier", "last"),
                                                                  NO_SUM)})
NO_BACK = BACK.pack({"index": 0, "best": NO_SUM})
DENSE_JOB = Layout(("left_slot", 3), ("right_slot", 3), ("window", 6), ("offsets", 9), ("start", 10), ("down", 10),
                   ("step_x", 8), ("step_y", 8), ("most", SUM_BITS), ("margin", SUM_BITS), ("check", 1), ("live", 1))
"""`dense_job_t`; start and down in two's complement."""
SUMS = tuple((name, SUM_BITS) for name in ("best", "lower", "upper", "rest"))
MAP = Layout(("zero", 9), ("valid", 1), ("agrees", 1), ("found", 1), ("index", INDEX_BITS), *SUMS)
"""`map_t`: a word of the map."""
PLAN = Layout(("shrink", 3), ("mask", 10), ("left", 16), ("right", 16), ("above", 16), ("pitch", 11),
              ("left_delay", 10), ("right_delay", 10), ("column", 10), ("skip", 10), ("count", 10), ("meets", 1),
              ("words", 10))
"""`plan_t`."""
ROW = Layout(("incoming", 16), ("leaving", 16), ("has_incoming", 1), ("has_leaving", 1), ("column", 10), ("skip", 10),
             ("count", 10), ("ok", 2), ("first", 1))
"""`row_t`."""
CHECKED = Layout(("found", 1), ("agrees", 1), ("index", INDEX_BITS), *SUMS)
"""`checked_t`."""
NOTHING = CHECKED.pack({"found": 0, "agrees": 0, "index": 0, **{name: NO_SUM for name, _ in SUMS}})
OK, BAD_WINDOW, BAD_OFFSETS, BAD_SLOT, BAD_STEP, CANCELLED, LOST = range(7)
"""`dense_status_e`."""
