# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak_best`."""

from __future__ import annotations

from golden.correlate import Status
from golden.cycle.model import Inputs, Values
from golden.cycle.peak.structs import OUTCOME, PRESENT, SCAN, SCORE_ROW


class PeakBestModel:
    """Decides per row whether it holds the best of its job so far, from the maxima of all rows of the job."""

    INPUTS = ("rst_i", "row_valid_i", "row_i", "top_level_i", "top_coming_i", "top_score_i", "top_x_i", "room_i",
              "order_room_i")
    OUTPUTS = ("row_ready_o", "top_ready_o", "order_valid_o", "outcome_valid_o", "order_o", "outcome_o",
               "released_o")

    def __init__(self) -> None:
        self.clear()
        self.row: dict[str, int] = {}
        self.tops: list[tuple[int, int]] = []
        """(score, x) of the job's rows up to this one."""

    def clear(self) -> None:
        """Hold no row."""
        self.held, self.hand, self.complete = False, False, False
        """A row is held; it leaves in this clock; the waiting row can be taken."""

    def decided(self) -> tuple[int, int]:
        """Packed scan order and outcome of the row."""
        row, tops = self.row, self.tops
        if row["status"] != Status.OK:
            return (SCAN.pack({"fresh": 1, "last": row["last"], "above": not row["first"], "middle": 0,
                               "below": not row["last"], "only": 1, "brief": 1, "last_x": row["last_x"],
                               "best_x": 0}),
                    OUTCOME.pack({**row, "fresh": 1, "other": 0, "best_x": 0, "best_y": row["y"], "score": 0}))
        scores = [score for score, _ in tops]
        r, best = len(tops) - 1, scores.index(max(scores))
        fresh = best == r
        # Rows outside the scan: those above its three, or, without a scan, a row below the neighbourhood.
        candidates = scores[:max(r - 1, 0)] if fresh else scores[r:] if r >= best + 2 else []
        order = {"fresh": fresh, "last": row["last"], "above": not row["first"], "middle": 1,
                 "below": not row["last"], "only": not (fresh and row["last_x"]),
                 "brief": not (fresh and row["last_x"] > 1), "last_x": row["last_x"], "best_x": tops[r][1]}
        outcome = {**row, "fresh": fresh, "other": PRESENT + max(candidates) if candidates else 0,
                   "best_x": tops[best][1], "best_y": best, "score": PRESENT + scores[best]}
        return SCAN.pack(order), OUTCOME.pack(outcome)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        hand, row = self.hand, self.row
        coming = SCORE_ROW.unpack(i["row_i"])
        refused = coming["status"] != Status.OK
        load = self.complete and (hand or not self.held)
        order, outcome = self.decided() if hand else (None, None)
        out: Values = {"row_ready_o": int(load), "top_ready_o": int(load and not refused),
                        "order_valid_o": int(hand), "outcome_valid_o": int(hand), "order_o": order,
                        "outcome_o": outcome,
                        "released_o": (not row["first"]) + row["last"] if hand else 0}
        level = i["top_level_i"] + i["top_coming_i"]
        self.complete = bool(i["row_valid_i"] and (refused or level >= 2 or (coming["last"] and level)))
        self.hand = self.held and not hand and bool(i["order_room_i"] and (i["room_i"] or not row["last"]))
        self.held = load or (self.held and not hand)
        if load:
            self.row = coming
            self.tops = [] if coming["first"] else self.tops
            self.tops.append((i["top_score_i"], i["top_x_i"]))
        if i["rst_i"]:
            self.clear()
        return out
