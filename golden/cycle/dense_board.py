# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_board`: the dense engine and its registers, beside what all boards have."""

from __future__ import annotations

from collections.abc import Mapping

from golden.cycle.bits import all_or_zero
from golden.cycle.board import CamerasModel
from golden.cycle.control.csr import CsrModel, FieldPlace
from golden.cycle.control.dense_control import DenseControlModel
from golden.cycle.dense.block import DenseBlockModel
from golden.cycle.dense.plan import DenseBuild
from golden.cycle.model import Inputs, Values
from golden.params import Config

LINGER = 64
"""Clocks after a pass from which on nothing in the engine's block changes until the next: its clock may stop."""
STREAM = "map_tdata_o", "map_tvalid_o", "map_tuser_o", "map_tlast_o"


def out_depth(config: Config) -> int:
    """Words of maps that the board holds: a power of two, three rows or more: with a ready sink no row waits."""
    return 1 << (3 * config.max_width - 1).bit_length()


def dense_build(config: Config) -> DenseBuild:
    """The dense engine of a board."""
    return DenseBuild(config.group_bits, config.max_width, config.max_height, config.words_per_row, config.slots,
                      config.dense_offsets, config.dense_lanes, config.dense_window, config.dense_sizes,
                      out_depth(config))


class DenseBoardModel(CamerasModel):
    """The whole board.

    Args:
        config: the build.
        fields: the map of the registers that all boards have, as in `CsrModel`.
        dense_fields: the engine's registers.
    """

    INPUTS = ("rst_i", *CsrModel.INPUTS, "vid_tdata_i", "vid_tvalid_i", "vid_tuser_i", "vid_tlast_i", "map_tready_i")
    OUTPUTS = (*CsrModel.OUTPUTS, "vid_tready_o", *STREAM, "irq_o")

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace], dense_fields: Mapping[str, FieldPlace],
                 ) -> None:
        super().__init__(config, fields, extension=True)
        self.dense_control = DenseControlModel(config, dense_fields)
        self.dense = DenseBlockModel(dense_build(config))
        self.still = 0  # clocks in which the block was idle
        self.work: Values = {}  # its outputs

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        i = self._reset(i)
        rst = i["rst_i"]
        control, capture, extension = self.control.outputs(), self.capture.outputs(), self.dense_control.outputs()
        commands, asked = all_or_zero(control), all_or_zero(extension)
        fronts = self._cameras(i, commands)
        work = self._work({
            "rst_i": rst, **{f"{name}_i": asked[f"{name}_o"] for name in ("start", "job", "cancel")},
            "image_width_i": commands["width_o"], "image_height_i": commands["height_o"],
            "slot_valid_i": capture["slot_valid_o"] or 0, "progress_i": capture["progress_o"] or 0,
            "clear_i": commands["slots_clear_o"], "rd_data_i": self.store.data or 0,
            "map_tready_i": i["map_tready_i"]})
        store = self._keep(rst, control, capture, work)
        jobless = dict.fromkeys(("job_ready_i", "job_level_i", "job_busy_i", "result_valid_i", "result_level_i",
                                 "score_i"), 0)
        events = all_or_zero({**i, **jobless, **self._events(fronts, capture, store), "work_i": work["busy_o"],
                              "ext_rd_data_i": extension["rd_data_o"], "ext_irq_i": extension["irq_o"]})
        self.control.edge(events, 0, store["peek_data_o"])
        self.dense_control.edge(all_or_zero({
            "rst_i": rst,
            **{f"{name}_i": control[f"ext_{name}_o"] for name in ("req", "is_wr", "addr", "data", "biten")},
            **{f"{name}_i": work[f"{name}_o"] for name in ("busy", "done", "status", "row", "stall")}}))
        self._take(rst, control, fronts, work["slot_busy_o"])
        return {**{name: control[name] for name in CsrModel.OUTPUTS}, "vid_tready_o": fronts["tready_o"],
                **{name: work[name] for name in STREAM}, "irq_o": control["irq_o"]}

    def _work(self, i: Inputs) -> Values:
        """Outputs of the engine's block, which is not stepped while its clock may stop."""
        if i["rst_i"] or i["start_i"] or self.still < LINGER:
            self.work = self.dense.step(i)
            idle = not (i["rst_i"] or i["start_i"] or self.work["busy_o"] or self.work["map_tvalid_o"])
            self.still = self.still + 1 if idle else 0
        return self.work
