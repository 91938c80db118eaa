# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the whole boards, composed of the models of their blocks.

Within a clock every signal between blocks is a register's output; an input from a block stepped later is read from the
state of that block's model.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

from golden.cycle.bits import all_or_zero
from golden.cycle.cells.ram_fifo import RamFifoModel
from golden.cycle.control.control import ControlModel
from golden.cycle.control.csr import CsrModel, FieldPlace
from golden.cycle.correlator.correlator import CorrelatorModel
from golden.cycle.correlator.grid import GridModel
from golden.cycle.frontend.frontend import FrontendModel
from golden.cycle.model import Inputs, Values
from golden.cycle.store.capture import CaptureModel
from golden.cycle.store.store import StoreModel
from golden.params import PIXEL_BITS, Config

RESET_START, RESET_END = 4, 7
"""Clocks from the reset at the pin to that of the blocks; from its end to their end, which is later."""


class CamerasModel:
    """What all boards have: cameras, capture, store, registers. Vectors over cameras are packed, camera 0 lowest.

    Args:
        config: the build.
        fields: the register map, as in `CsrModel`.
        extension: the board has more registers.
    """

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace], extension: bool = False) -> None:
        c = self.config = config
        self.resets = deque([1] * RESET_END, RESET_END)  # rst_i of the clocks before, the latest last
        self.control = ControlModel(c, fields, extension)
        self.front = [FrontendModel(c.max_width, c.radius, c.group_bits) for _ in range(c.cameras)]
        self.capture = CaptureModel(c.cameras, c.group_bits, c.slots, c.slot_words, c.words_per_row)
        self.store = StoreModel(c.store_words)

    def _reset(self, i: Inputs) -> Inputs:
        """The inputs, with the reset that the blocks see."""
        rst = int(any(list(self.resets)[:RESET_END - RESET_START + 1]))
        self.resets.append(i["rst_i"])
        return {**i, "rst_i": rst}

    def _keep(self, rst: int, control: Values, capture: Values, work: Values) -> Values:
        """Outputs of the store."""
        return self.store.step(all_or_zero({
            "rst_i": rst, **{f"wr_{name}_i": capture[f"wr_{name}_o"] for name in ("valid", "addr", "data")},
            "rd_valid_i": work["rd_valid_o"], "rd_addr_i": work["rd_addr_o"],
            "peek_valid_i": control["peek_valid_o"], "peek_addr_i": control["peek_addr_o"]}))

    @staticmethod
    def _events(fronts: Mapping[str, int], capture: Values, store: Values) -> Values:
        """What the registers see of cameras, capture and store."""
        return {"active_i": fronts["busy_o"], "accepted_i": fronts["accepted_o"], "dropped_i": fronts["dropped_o"],
                "slot_valid_i": capture["slot_valid_o"], "armed_i": capture["armed_o"],
                "writing_i": capture["writing_o"], "refused_i": capture["refused_o"], "captured_i": capture["done_o"],
                "peek_ready_i": store["peek_ready_o"], "peek_done_i": store["peek_done_o"]}

    def _take(self, rst: int, control: Values, fronts: Mapping[str, int], slot_busy: int | None) -> None:
        """Take the clock edge of the capture."""
        self.capture.step({
            "rst_i": rst, "cmd_valid_i": control["capture_valid_o"] or 0,
            "cmd_cancel_i": control["capture_cancel_o"] or 0, "cmd_camera_i": control["capture_camera_o"] or 0,
            "cmd_slot_i": control["capture_slot_o"] or 0, "clear_i": control["slots_clear_o"] or 0,
            "slot_busy_i": slot_busy or 0,
            **{f"{name}_i": fronts[f"{name}_o"] for name in ("word_valid", "word_data", "word_last", "frame_start",
                                                             "frame_done", "frame_abort")}})

    def _cameras(self, i: Mapping[str, int], control: dict[str, int]) -> dict[str, int]:
        """Outputs of all front ends, packed."""
        packed = dict.fromkeys(FrontendModel.OUTPUTS, 0)
        settings = {f"{name}_i": control[f"{name}_o"] for name in ("width", "height", "g", "g2")}
        for c, front in enumerate(self.front):
            out = front.step({
                "rst_i": i["rst_i"], **settings, "hold_i": control["hold_o"] >> c & 1,
                "abort_i": control["abort_o"] >> c & 1,
                "tdata_i": i["vid_tdata_i"] >> PIXEL_BITS * c & (1 << PIXEL_BITS) - 1,
                **{f"t{name}_i": i[f"vid_t{name}_i"] >> c & 1 for name in ("valid", "user", "last")}})
            for name, value in out.items():
                packed[name] |= (value or 0) << c * (self.config.group_bits if name == "word_data_o" else 1)
        return packed

class BoardModel(CamerasModel):
    """`slog_board`."""

    INPUTS = ("rst_i", *CsrModel.INPUTS, "vid_tdata_i", "vid_tvalid_i", "vid_tuser_i", "vid_tlast_i", "surf_tready_i")
    OUTPUTS = (*CsrModel.OUTPUTS, "vid_tready_o", "surf_tdata_o", "surf_tvalid_o", "surf_tuser_o", "surf_tlast_o",
               "irq_o")

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace]) -> None:
        super().__init__(config, fields)
        c = config
        self.grid = GridModel()
        self.jobs = RamFifoModel(c.job_depth)
        self.correlator = CorrelatorModel(c)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        i = self._reset(i)
        rst = i["rst_i"]
        control = self.control.outputs()
        capture = self.capture.outputs()
        fronts = self._cameras(i, all_or_zero(control))
        level = self.jobs.level
        job, laid = self._lay(rst, all_or_zero(control))
        work = self.correlator.step({
            "rst_i": rst, "job_valid_i": job["out_valid_o"] or 0, "job_i": job["out_data_o"] or 0,
            "image_width_i": control["width_o"] or 0, "image_height_i": control["height_o"] or 0,
            "slot_valid_i": capture["slot_valid_o"] or 0, "rd_data_i": self.store.data or 0,
            "surf_tready_i": i["surf_tready_i"], "res_ready_i": control["result_ready_o"] or 0})
        store = self._keep(rst, control, capture, work)
        events = all_or_zero({
            **i, **self._events(fronts, capture, store), "job_ready_i": laid["job_ready_o"],
            "job_level_i": level, "job_busy_i": int(bool(work["busy_o"] or level or not laid["job_ready_o"])),
            "result_valid_i": work["res_valid_o"], "result_level_i": work["res_level_o"],
            "work_i": work["busy_o"], "score_i": work["score_o"]})
        self.control.edge(events, work["res_o"], store["peek_data_o"])
        self._take(rst, control, fronts, work["slot_busy_o"])
        return {**{name: control[name] for name in CsrModel.OUTPUTS}, "vid_tready_o": fronts["tready_o"],
                **{name: work[name] for name in self.OUTPUTS if name.startswith("surf_")}, "irq_o": control["irq_o"]}

    def _lay(self, rst: int, control: dict[str, int]) -> tuple[Values, Values]:
        """Outputs of the job queue and of the grid before it."""
        laid = self.grid.step({
            "rst_i": rst, "job_valid_i": control["job_valid_o"], "job_i": control["job_o"],
            "count_x_i": control["grid_x_o"], "count_y_i": control["grid_y_o"], "step_x_i": control["step_x_o"],
            "step_y_i": control["step_y_o"], "job_ready_i": int(self.jobs.level < self.config.job_depth)})
        job = self.jobs.step({"rst_i": rst, "in_valid_i": laid["job_valid_o"] or 0, "in_data_i": laid["job_o"] or 0,
                              "out_ready_i": int(self.correlator.fetch.state == "idle")})
        return job, laid
