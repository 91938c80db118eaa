"""Cycle model of `slog_board`, composed of the models of its blocks.

Within a clock the blocks hear from one another only through registered outputs; what a block needs from one stepped after
it is read from that one's state.
"""

from __future__ import annotations

from collections.abc import Mapping

from golden.array_timing import drain_clocks
from golden.cycle_capture import CaptureModel
from golden.cycle_control import ControlModel
from golden.cycle_csr import CsrModel, FieldPlace
from golden.cycle_fetch import FetchModel
from golden.cycle_fifo import FifoModel
from golden.cycle_frontend import FrontendModel
from golden.cycle_grid import GridModel
from golden.cycle_operand_array import OperandArrayModel
from golden.cycle_peak import CONTEXT_DEPTH, PeakModel
from golden.cycle_sequencer import SequencerModel
from golden.cycle_store import StoreModel
from golden.params import PIXEL_BITS, Config
from golden.structs import STEP

STEP_VALID = 1 << STEP.bits - 1
Values = dict[str, int | None]


def known(values: Mapping[str, int | None]) -> dict[str, int]:
    """Undefined values as 0: for blocks that look at them only when they are defined."""
    return {name: value or 0 for name, value in values.items()}


class BoardModel:
    """The whole board. Vectors over cameras are packed, camera 0 lowest.

    Args:
        config: the build.
        fields: the register map, as in `CsrModel`.
    """

    INPUTS = ("rst_i", *CsrModel.INPUTS, "vid_tdata_i", "vid_tvalid_i", "vid_tuser_i", "vid_tlast_i", "surf_tready_i")
    OUTPUTS = (*CsrModel.OUTPUTS, "vid_tready_o", "surf_tdata_o", "surf_tvalid_o", "surf_tuser_o", "surf_tlast_o",
               "irq_o")

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace]) -> None:
        c = self.config = config
        self.control = ControlModel(c, fields)
        self.front = [FrontendModel(c.max_width, c.radius, c.group_bits) for _ in range(c.cameras)]
        self.capture = CaptureModel(c.cameras, c.group_bits, c.slots, c.slot_words, c.words_per_row)
        self.store = StoreModel(c.store_words)
        self.grid = GridModel()
        self.jobs = FifoModel(c.job_depth)
        self.fetch = FetchModel(c)
        self.sequencer = SequencerModel(c.group_bits, c.pitch, c.ring_rows, drain_clocks(c.group_bits, c.lanes))
        self.array = OperandArrayModel(c.group_bits, c.ring_rows)
        self.peak = PeakModel(c.max_width, c.surface_depth, c.result_depth)

    def step(self, i: Mapping[str, int]) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rst = i["rst_i"]
        control = self.control.outputs()
        capture = self.capture.outputs()
        fronts = self._cameras(i, known(control))
        level = len(self.jobs.words)
        job, laid = self._lay(rst, known(control))
        fetch, store = self._fetch(rst, known(job), known(capture), known(control))
        mismatch, sequencer = self._array(rst, known(fetch))
        peak = self.peak.step({**sequencer, "rst_i": rst, "mismatch_valid_i": mismatch["mismatch_valid_o"] or 0,
                               "mismatch_i": mismatch["mismatch_o"] or 0, "surf_tready_i": i["surf_tready_i"],
                               "res_ready_i": control["result_ready_o"] or 0})
        work = bool(fetch["busy_o"] or sequencer["busy_i"])
        events = known({
            **i, "active_i": fronts["busy_o"], "accepted_i": fronts["accepted_o"], "dropped_i": fronts["dropped_o"],
            "slot_valid_i": capture["slot_valid_o"], "armed_i": capture["armed_o"], "writing_i": capture["writing_o"],
            "refused_i": capture["refused_o"], "captured_i": capture["done_o"], "job_ready_i": laid["job_ready_o"],
            "job_level_i": level, "job_busy_i": int(work or bool(job["out_valid_o"]) or bool(laid["job_valid_o"])),
            "result_valid_i": peak["res_valid_o"], "result_level_i": peak["res_level_o"],
            "work_i": int(work), "score_i": mismatch["mismatch_valid_o"], "peek_ready_i": store["peek_ready_o"],
            "peek_done_i": store["peek_done_o"]})
        self.control.edge(events, peak["res_o"], store["peek_data_o"])
        self.capture.step({
            "rst_i": rst, "cmd_valid_i": control["capture_valid_o"] or 0,
            "cmd_cancel_i": control["capture_cancel_o"] or 0, "cmd_camera_i": control["capture_camera_o"] or 0,
            "cmd_slot_i": control["capture_slot_o"] or 0, "clear_i": control["slots_clear_o"] or 0,
            "slot_busy_i": fetch["slot_busy_o"] or 0,
            **{f"{name}_i": fronts[f"{name}_o"] for name in ("word_valid", "word_data", "word_last", "frame_start",
                                                             "frame_done", "frame_abort")}})
        return {**{name: control[name] for name in CsrModel.OUTPUTS}, "vid_tready_o": fronts["tready_o"],
                **{name: peak[name] for name in self.OUTPUTS if name.startswith("surf_")}, "irq_o": control["irq_o"]}

    def _cameras(self, i: Mapping[str, int], control: dict[str, int]) -> dict[str, int]:
        """Outputs of both front ends, packed."""
        packed = dict.fromkeys((*FrontendModel.OUTPUTS,), 0)
        settings = {f"{name}_i": control[f"{name}_o"] for name in ("width", "height", "hold", "g", "g2")}
        for c, front in enumerate(self.front):
            out = front.step({
                "rst_i": i["rst_i"], **settings, "tdata_i": i["vid_tdata_i"] >> PIXEL_BITS * c & (1 << PIXEL_BITS) - 1,
                **{f"t{name}_i": i[f"vid_t{name}_i"] >> c & 1 for name in ("valid", "user", "last")}})
            for name, value in out.items():
                packed[name] |= (value or 0) << c * (self.config.group_bits if name == "word_data_o" else 1)
        return packed

    def _lay(self, rst: int, control: dict[str, int]) -> tuple[Values, Values]:
        """Outputs of the job queue and of the grid before it."""
        laid = self.grid.step({
            "rst_i": rst, "job_valid_i": control["job_valid_o"], "job_i": control["job_o"],
            "count_x_i": control["grid_x_o"], "count_y_i": control["grid_y_o"], "step_x_i": control["step_x_o"],
            "step_y_i": control["step_y_o"], "job_ready_i": int(len(self.jobs.words) < self.config.job_depth)})
        job = self.jobs.step({"rst_i": rst, "in_valid_i": laid["job_valid_o"] or 0, "in_data_i": laid["job_o"] or 0,
                              "out_ready_i": int(self.fetch.state == "idle")})
        return job, laid

    def _fetch(self, rst: int, job: dict[str, int], capture: dict[str, int], control: dict[str, int],
               ) -> tuple[Values, Values]:
        """Outputs of the fetch and of the store."""
        walker = self.sequencer.walker
        fetch = self.fetch.step({
            "rst_i": rst, "job_valid_i": job["out_valid_o"], "job_i": job["out_data_o"],
            "image_width_i": control["width_o"], "image_height_i": control["height_o"],
            "slot_valid_i": capture["slot_valid_o"], "rd_data_i": self.store.data or 0,
            "ticket_ready_i": int(self.sequencer.state == "idle"), "rows_freed_i": walker.freed,
            "bank_free_i": walker.bank_free})
        store = self.store.step({
            "rst_i": rst, **{f"wr_{name}_i": capture[f"wr_{name}_o"] for name in ("valid", "addr", "data")},
            "rd_valid_i": fetch["rd_valid_o"] or 0, "rd_addr_i": fetch["rd_addr_o"] or 0,
            "peek_valid_i": control["peek_valid_o"], "peek_addr_i": control["peek_addr_o"]})
        return fetch, store

    def _array(self, rst: int, fetch: dict[str, int]) -> tuple[Values, dict[str, int]]:
        """Outputs of operands and array; the sequencer's, named as inputs of the peak unit."""
        peak = self.peak
        s = known(self.sequencer.step({
            "rst_i": rst, "ticket_valid_i": fetch["ticket_valid_o"], "ticket_i": fetch["ticket_o"],
            "tpl_done_i": fetch["tpl_done_o"], "rows_written_i": fetch["rows_written_o"],
            "ctx_ready_i": int(len(peak.contexts) < CONTEXT_DEPTH), "row_ready_i": peak.room.ready}))
        mismatch = self.array.step({
            "rst_i": rst, **{f"wr_{name}_i": fetch[f"wr_{name}_o"]
                             for name in ("valid", "tpl", "wide", "bank", "row", "word", "data")},
            "step_i": s["step_o"] | STEP_VALID if s["step_valid_o"] else 0, "mask_i": s["mask_o"]})
        return mismatch, {f"{name[:-2]}_i": value for name, value in s.items()}
