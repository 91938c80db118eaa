# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_peak`: its parts wired together."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import or_zero
from golden.cycle.cells.ram import RamModel
from golden.cycle.cells.ram_fifo import RamFifoModel
from golden.cycle.cells.stage import StageModel
from golden.cycle.model import Inputs, Values
from golden.cycle.peak.peak_best import PeakBestModel
from golden.cycle.peak.peak_collect import PeakCollectModel
from golden.cycle.peak.peak_intake import PeakIntakeModel
from golden.cycle.peak.peak_room import PeakRoomModel
from golden.cycle.peak.peak_rows import PeakRowsModel
from golden.cycle.peak.peak_scan import PeakScanModel
from golden.cycle.peak.running_max import RunningMaxModel
from golden.cycle.peak.structs import SCAN, SCORE_ROW, VERDICT
from golden.params import NO_SCORE, SCORE_BITS
from golden.structs import RESULT

BANKS = 4
"""Row banks."""
CONTEXT_DEPTH = 8
SURFACE_DEPTH = 16
SURFACE_ROOM = 6
"""Free places of the surface queue below which no score is taken."""


def _advance(rst: int, stage: StageModel, queue: deque[int], taken: int | None) -> None:
    """Take the clock edge of a stage that a queue feeds; `taken`: the receiver takes a word."""
    out = stage.step({"rst_i": rst, "in_valid_i": int(bool(queue)), "in_data_i": queue[0] if queue else 0,
                      "out_ready_i": or_zero(taken)})
    if queue and out["in_ready_o"]:
        queue.popleft()


class PeakModel:
    """Peak unit. `surf_tdata_o`, `surf_tuser_o`, `surf_tlast_o` and `res_o` are undefined while not offered."""

    INPUTS = ("rst_i", "ctx_valid_i", "ctx_i", "row_valid_i", "row_offsets_i", "mismatch_valid_i", "mismatch_i",
              "surf_tready_i", "res_ready_i")
    OUTPUTS = ("ctx_ready_o", "row_ready_o", "surf_tvalid_o", "surf_tdata_o", "surf_tuser_o", "surf_tlast_o",
               "res_valid_o", "res_o", "res_level_o")

    def __init__(self, max_offsets: int, score_depth: int, result_depth: int) -> None:
        self.result_depth = result_depth
        self.queue = RamFifoModel(score_depth)
        self.room = PeakRoomModel(score_depth, max_offsets)
        self.rows, self.intake, self.row_max = PeakRowsModel(), PeakIntakeModel(BANKS), RunningMaxModel()
        self.best, self.scan, self.collect = PeakBestModel(), PeakScanModel(BANKS), PeakCollectModel()
        self.banks = [RamModel() for _ in range(BANKS)]
        self.around, self.verdict = RamFifoModel(result_depth), RamFifoModel(result_depth)
        self.clear()

    def clear(self) -> None:
        """Empty the queues between the parts."""
        self.near_context, self.contexts, self.context = StageModel(half=True), deque[int](), StageModel(half=True)
        self.surface: deque[tuple[int, int, int]] = deque()
        self.surface_ok = [0, 0]  # for this clock and the next
        self.popped_score = 0  # a score was taken in the clock before
        self.begun, self.begun_row = deque[int](), StageModel(half=True)
        self.tops: deque[tuple[int, int]] = deque()
        self.outcomes = deque[int]()
        self.taken: int | None = None
        self.kept, self.popped = 0, 0
        self.front, self.waiting = StageModel(half=True), 0
        self.arrived: tuple[int, int] = 0, 0  # mismatch_valid_i and mismatch_i of the clock before

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rst = i["rst_i"]
        surf = self.surface[0] if self.surface else None
        offered = self.front.word is not None
        popped = int(offered and i["res_ready_i"])
        out: Values = {
            "ctx_ready_o": int(self.near_context.word is None), "surf_tvalid_o": int(surf is not None),
            "surf_tlast_o": surf[0] if surf else None, "surf_tuser_o": surf[1] if surf else None,
            "surf_tdata_o": surf[2] if surf else None, "res_valid_o": int(offered),
            "res_o": self.front.word, "res_level_o": self.waiting}

        best, scan = self._search(rst)
        collected = self._gather(rst, scan)
        whole = self._result() if self.verdict.front else None
        moved = self.front.step({"rst_i": rst, "in_valid_i": int(whole is not None), "in_data_i": or_zero(whole),
                                 "out_ready_i": i["res_ready_i"]})["in_ready_o"]
        for queue, name in ((self.around, "around"), (self.verdict, "verdict")):
            queue.step({"rst_i": rst, "in_valid_i": or_zero(collected[f"{name}_valid_o"]),
                        "out_ready_i": int(whole is not None and bool(moved)),
                        "in_data_i": or_zero(collected[f"{name}_o"])})
        self.waiting += or_zero(collected["verdict_valid_o"]) - popped
        ordered = bool(best["order_valid_o"])
        # A departure counts one clock late.
        self.kept += int(ordered and SCAN.unpack(or_zero(best["order_o"]))["last"]) - self.popped
        self.popped = popped

        intake, row = self._take_in(i, out, or_zero(best["released_o"]))
        self._put_away(intake, scan)

        # Queues between the parts: a pushed word is visible from the next clock on.
        if surf and i["surf_tready_i"]:
            self.surface.popleft()
        if intake["surf_valid_o"]:
            last, first, score = (or_zero(intake[f"{name}_o"]) for name in ("surf_last", "surf_first", "score"))
            self.surface.append((last, first, score))
        _advance(rst, self.begun_row, self.begun, best["row_ready_o"])
        if best["top_ready_o"]:
            self.tops.popleft()
        if self.taken is not None:
            self.begun.append(self.taken)
        self.taken = row
        top = self.row_max.step({"rst_i": rst, "in_valid_i": or_zero(intake["score_valid_o"]),
                                 "in_first_i": or_zero(intake["score_first_o"]),
                                 "in_last_i": or_zero(intake["score_last_o"]),
                                 "in_value_i": or_zero(intake["score_o"]), "in_index_i": or_zero(intake["score_x_o"])})
        if top["out_valid_o"]:
            self.tops.append((or_zero(top["out_value_o"]), or_zero(top["out_index_o"])))
        if scan["far_valid_o"]:
            self.outcomes.popleft()
        if ordered:
            self.outcomes.append(or_zero(best["outcome_o"]))
        if rst:
            self.clear()
        return out

    def _result(self) -> int:
        """The front result, packed."""
        verdict = VERDICT.unpack(self.verdict.front[0])
        around = self.around.front[0]
        return RESULT.pack({**verdict, **{f"neighbour{k}": around >> k * SCORE_BITS & NO_SCORE for k in range(8)}})

    def _search(self, rst: int) -> tuple[Values, Values]:
        """Outputs of the decision on rows and of the scan."""
        score, x = self.tops[0] if self.tops else (0, 0)
        best = self.best.step({
            "rst_i": rst, "row_valid_i": int(self.begun_row.word is not None), "row_i": or_zero(self.begun_row.word),
            "top_level_i": len(self.tops), "top_coming_i": int(self.row_max.due[0] is not None), "top_score_i": score,
            "top_x_i": x, "room_i": int(self.kept < self.result_depth), "order_room_i": int(self.scan.room)})
        data = sum(or_zero(bank.out) << b * SCORE_BITS for b, bank in enumerate(self.banks))
        scan = self.scan.step({"rst_i": rst, "order_valid_i": or_zero(best["order_valid_o"]),
                               "order_i": or_zero(best["order_o"]), "data_i": data})
        return best, scan

    def _gather(self, rst: int, scan: Values) -> Values:
        """Outputs of the collection of neighbours and runner-up."""
        near = {name.replace("_o", "_i"): or_zero(scan[name])
                for name in (*PeakScanModel.FLAGS, *PeakScanModel.VALUES, "far_valid_o", "far_o")}
        return self.collect.step({"rst_i": rst, **near, "outcome_i": self.outcomes[0] if self.outcomes else 0})

    def _take_in(self, i: Inputs, out: Values, released: int) -> tuple[Values, int | None]:
        """Outputs of the intake, and the row it begins."""
        rst = i["rst_i"]
        queued = self.queue.front[0] if self.queue.front else None
        taken = self.intake.takes(int(queued is not None))
        rows = self.rows.step({"rst_i": rst, "ctx_valid_i": int(self.context.word is not None),
                               "ctx_i": or_zero(self.context.word), "row_taken_i": int(taken)})
        row = rows["row_o"]
        fields = SCORE_ROW.unpack(or_zero(row))
        intake = self.intake.step({
            "rst_i": rst, "row_coming_i": or_zero(rows["row_coming_o"]), "row_refused_i": int(fields["status"] != 0),
            "row_last_x_i": fields["last_x"], "row_first_i": fields["first"], "row_last_i": fields["last"],
            "scoring_i": or_zero(rows["scoring_o"]), "released_i": released,
            "mismatch_valid_i": int(queued is not None), "mismatch_i": or_zero(queued),
            "surf_ok_i": self.surface_ok[0]})
        self.surface_ok = [self.surface_ok[1], int(len(self.surface) <= SURFACE_DEPTH - SURFACE_ROOM)]
        room = len(self.contexts) < CONTEXT_DEPTH
        _advance(rst, self.context, self.contexts, rows["ctx_ready_o"])
        near = self.near_context.step({"rst_i": rst, "in_valid_i": i["ctx_valid_i"], "in_data_i": i["ctx_i"],
                                       "out_ready_i": int(room)})
        if near["out_valid_o"] and room:
            self.contexts.append(or_zero(near["out_data_o"]))
        popped = int(queued is not None and bool(intake["mismatch_ready_o"]))
        out.update(self.room.step({"rst_i": rst, "row_valid_i": i["row_valid_i"], "row_offsets_i": i["row_offsets_i"],
                                   "taken_i": self.popped_score}))
        self.popped_score = popped
        valid, mismatch = self.arrived
        self.arrived = i["mismatch_valid_i"], i["mismatch_i"]
        self.queue.step({"rst_i": rst, "in_valid_i": valid, "in_data_i": mismatch,
                         "out_ready_i": or_zero(intake["mismatch_ready_o"])})
        return intake, row if taken else None

    def _put_away(self, intake: Values, scan: Values) -> None:
        """Writes and reads of the row banks."""
        for b, bank in enumerate(self.banks):
            bank.step({"wr_en_i": or_zero(intake["bank_o"]) >> b & 1, "wr_addr_i": or_zero(intake["score_x_o"]),
                       "wr_data_i": or_zero(intake["score_o"]), "rd_en_i": or_zero(scan["read_o"]) >> b & 1,
                       "rd_addr_i": or_zero(scan["read_x_o"])})
