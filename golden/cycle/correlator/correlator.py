# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_correlator`: the models of fetch, sequencer, operands, array and peak unit joined."""

from __future__ import annotations

from golden.cycle.array.operand_array import OperandArrayModel
from golden.cycle.array.timing import drain_clocks
from golden.cycle.bits import all_or_zero
from golden.cycle.correlator.fetch import FetchModel
from golden.cycle.correlator.sequencer import SequencerModel
from golden.cycle.model import Inputs, Values
from golden.cycle.peak.peak import PeakModel
from golden.params import Config
from golden.structs import STEP


class CorrelatorModel:
    """Steps the models in the order of the signals within a clock; signals that flow back are registered."""

    INPUTS = ("rst_i", "job_valid_i", "job_i", "image_width_i", "image_height_i", "slot_valid_i", "rd_data_i",
              "surf_tready_i", "res_ready_i")
    OUTPUTS = ("job_ready_o", "slot_busy_o", "rd_valid_o", "rd_addr_o", "surf_tvalid_o", "surf_tdata_o", "surf_tuser_o",
               "surf_tlast_o", "res_valid_o", "res_o", "res_level_o", "busy_o", "score_o")

    def __init__(self, config: Config, score_depth: int | None = None) -> None:
        self.fetch = FetchModel(config)
        self.sequencer = SequencerModel(config.group_bits, config.pitch, config.ring_rows,
                                        drain_clocks(config.group_bits, config.lanes))
        self.array = OperandArrayModel(config.group_bits, config.ring_rows, hold_idle=False)
        self.peak = PeakModel(config.max_width, score_depth or config.surface_depth, config.result_depth)
        self.at_work = self.busy = self.score = 0
        # The power-up contents of the memories affect no score: any value will do.
        rows, words = range(config.ring_rows), range(config.words_per_row + 3)
        self.array.operands.ring.update({(r, w): 0 for r in rows for w in words})
        steps = range(config.max_window)
        self.array.operands.tpl.update({(b, g, s): 0 for b in (0, 1) for g in (0, 1) for s in steps})

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rst = i["rst_i"]
        ctx_ready, row_ready = int(self.peak.near_context.word is None), self.peak.room.ready
        walker = self.sequencer.walker
        fetch = self.fetch.step({
            **{k: i[k] for k in self.INPUTS if k in FetchModel.INPUTS},
            "ticket_ready_i": int(self.sequencer.state == "idle"), "rows_freed_i": walker.freed,
            "bank_free_i": walker.bank_free})
        f = all_or_zero(fetch)
        sequencer = self.sequencer.step({
            "rst_i": rst, "ticket_valid_i": f["ticket_valid_o"], "ticket_i": f["ticket_o"],
            "tpl_done_i": f["tpl_done_o"], "rows_written_i": f["rows_written_o"],
            "ctx_ready_i": ctx_ready, "row_ready_i": row_ready})
        s = all_or_zero(sequencer)
        step = STEP.pack({**STEP.unpack(s["step_o"]), "valid": s["step_valid_o"]})
        array = self.array.step({
            "rst_i": rst, "step_i": step, "mask_i": s["mask_o"],
            **{f"wr_{k}_i": f[f"wr_{k}_o"] for k in ("valid", "tpl", "wide", "bank", "row", "word", "data")}})
        peak = self.peak.step({
            "rst_i": rst, "ctx_valid_i": s["ctx_valid_o"], "ctx_i": s["ctx_o"], "row_valid_i": s["row_valid_o"],
            "row_offsets_i": s["row_offsets_o"], "mismatch_valid_i": array["mismatch_valid_o"] or 0,
            "mismatch_i": array["mismatch_o"] or 0, "surf_tready_i": i["surf_tready_i"],
            "res_ready_i": i["res_ready_i"]})
        busy, score = self.busy, self.score
        self.score = 0 if rst else array["mismatch_valid_o"] or 0
        self.busy = 0 if rst else self.at_work
        self.at_work = int(not rst and bool(i["job_valid_i"] or f["busy_o"] or s["busy_o"]))
        return {**{k: fetch[k] for k in ("job_ready_o", "slot_busy_o", "rd_valid_o", "rd_addr_o")},
                **{k: peak[k] for k in self.OUTPUTS if k in peak},
                "busy_o": busy, "score_o": score}
