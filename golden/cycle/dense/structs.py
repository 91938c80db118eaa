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
