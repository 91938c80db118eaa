# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_control`, with its counters; registers, coefficients and peek port are models of their own."""

from __future__ import annotations

from collections.abc import Mapping

from golden.cycle.control.csr import CsrModel, FieldPlace
from golden.cycle.control.filter_bank import FilterBankModel
from golden.cycle.control.peek import PeekModel
from golden.params import COEF_FRACTION, Config
from golden.structs import JOB, RESULT

STORED = {
    "image_size.width": 0, "image_size.height": 0, "coef.value": 0, "coef.second": 0, "coef.index": 0,
    "capture.slot": 0, "capture.camera": 0, "capture.cancel": 0, "job.tpl.x": 0, "job.tpl.y": 0, "job.tpl.slot": 0,
    "job.window.width": 0, "job.window.height": 0, "job.search.x": 0, "job.search.y": 0, "job.search.slot": 0,
    "job.offsets.across": 0, "job.offsets.down": 0, "job.grid.across": 1, "job.grid.down": 1, "job.step.x": 0,
    "job.step.y": 0, "job.submit.tag": 0, "job.submit.surface": 0, "peek_address.word": 0,
    "irq_enable.result": 0, "irq_enable.capture": 0, "irq_enable.drop": 0, "irq_enable.overflow": 0,
}
"""Fields the host writes and the block keeps, with their reset values."""
OVERFLOW = 5
"""Index of the overflow counter among the counters."""
EVENTS = ("irq_status.capture", "irq_status.drop", "irq_status.overflow")
"""Interrupt causes that stay set until the host clears them."""


class ControlModel:
    """Every output is a register, so `outputs` needs no inputs.

    Args:
        config: the build.
        fields: the register map, as in `CsrModel`.
        extension: a further register block answers, too.
    """

    INPUTS = ("rst_i", *CsrModel.INPUTS, "active_i", "accepted_i", "dropped_i", "slot_valid_i", "armed_i", "writing_i",
              "refused_i", "captured_i", "job_ready_i", "job_level_i", "job_busy_i", "result_valid_i", "result_i",
              "result_level_i", "work_i", "score_i", "peek_ready_i", "peek_done_i", "peek_data_i", "ext_rd_data_i",
              "ext_irq_i")
    OUTPUTS = (*CsrModel.OUTPUTS, "hold_o", "abort_o", "width_o", "height_o", "g_o", "g2_o", "capture_valid_o",
               "capture_cancel_o", "capture_camera_o", "capture_slot_o", "slots_clear_o", "job_valid_o", "job_o",
               "grid_x_o", "grid_y_o", "step_x_o", "step_y_o", "result_ready_o", "peek_valid_o", "peek_addr_o",
               "ext_req_o", "ext_is_wr_o", "ext_addr_o", "ext_data_o", "ext_biten_o", "irq_o")

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace], extension: bool = False) -> None:
        self.config, self.extension = config, extension
        self.csr = CsrModel(fields, STORED, EVENTS, "peek_data.value")
        self.bank = FilterBankModel(config)
        self.peek = PeekModel(config.group_bits, config.store_words)
        self.counts = [0] * 10
        self.irq = 0
        # Inputs of the register block, from the clock before.
        self.shown: dict[str, int | None] = {}
        self.events = dict.fromkeys(EVENTS, 0)
        self.peek_wait = False
        # Events of one and two clocks before.
        self.happened, self.counted = [0] * len(self.counts), [0] * len(self.counts)
        self.seen, self.refused = 0, False  # one clock before: a result is there; it is of a refused job
        self.pops = (0, 0, 0)  # pop commands of the host, one to three clocks before

    def outputs(self) -> dict[str, int | None]:
        """Outputs of this clock."""
        v, bank = self.csr.value, self.bank
        return {
            **self.csr.outputs(),
            "hold_o": sum(h << c for c, h in enumerate(bank.hold)),
            "abort_o": (v["filter.abort_0"] | v["filter.abort_1"] << 1) & (1 << self.config.cameras) - 1,
            "width_o": bank.size[0],
            "height_o": bank.size[1], "g_o": bank.coefs(0), "g2_o": bank.coefs(1), "slots_clear_o": bank.changed,
            "capture_valid_o": v["capture.go"], "capture_cancel_o": v["capture.cancel"],
            "capture_camera_o": v["capture.camera"], "capture_slot_o": v["capture.slot"],
            "job_valid_o": v["job.submit.go"],
            "job_o": JOB.pack({
                "tag": v["job.submit.tag"], "surface": v["job.submit.surface"], "tpl_slot": v["job.tpl.slot"],
                "tpl_x": v["job.tpl.x"], "tpl_y": v["job.tpl.y"], "width": v["job.window.width"],
                "height": v["job.window.height"], "search_slot": v["job.search.slot"],
                "search_x": v["job.search.x"], "search_y": v["job.search.y"],
                "offsets_x": v["job.offsets.across"], "offsets_y": v["job.offsets.down"]}),
            "grid_x_o": v["job.grid.across"], "grid_y_o": v["job.grid.down"], "step_x_o": v["job.step.x"],
            "step_y_o": v["job.step.y"], "result_ready_o": self.pops[1],
            "peek_valid_o": int(self.peek.valid), "peek_addr_o": self.peek.address if self.peek.valid else None,
            **self._extended(), "irq_o": self.irq,
        }

    def _extended(self) -> dict[str, int | None]:
        """The request to a further register block: direction and address for three clocks after it, data and enables
        in the last two of them."""
        csr = self.csr
        request = csr.passed or csr.parted or csr.found or csr.decoded
        out: dict[str, int | None] = dict.fromkeys(("ext_is_wr_o", "ext_addr_o", "ext_data_o", "ext_biten_o"))
        out["ext_req_o"] = int(csr.passed is not None)
        if request is not None:
            out |= {"ext_is_wr_o": int(request.is_write), "ext_addr_o": request.address}
            if request.is_write and request in (csr.found, csr.decoded):
                out |= {"ext_data_o": request.data, "ext_biten_o": request.enable}
        return out

    def status(self, i: Mapping[str, int], result: int | None) -> dict[str, int | None]:
        """Fields driven by hardware, by dotted path, as the host would read them in this clock; None if undefined."""
        c = self.config
        r: dict[str, int | None] = dict.fromkeys(name for name, _ in RESULT.fields)
        if result is not None:
            r.update(RESULT.unpack(result))
        status: dict[str, int | None] = {
            "id.value": int.from_bytes(b"SLOG"), "version.minor": 1, "version.major": 1,
            "build_image.max_width": c.max_width, "build_image.max_height": c.max_height,
            "build_filter.min_image": c.min_image, "build_filter.radius": c.radius,
            "build_filter.fraction": COEF_FRACTION, "build_window.min_window": c.min_window,
            "build_window.max_window": c.max_window, "build_window.group_bits": c.group_bits,
            "build_window.words_per_row": c.words_per_row, "build_board.cameras": c.cameras,
            "build_board.slots": c.slots, "build_board.lanes": c.lanes, "build_board.surface_depth": c.surface_depth,
            "build_queue.job_depth": c.job_depth, "build_queue.result_depth": c.result_depth,
            "image_active.width": self.bank.size[0], "image_active.height": self.bank.size[1],
            "filter.busy": self.bank.busy, "filter.size_error": self.bank.error, "filter.active": i["active_i"],
            "slot_status.valid": i["slot_valid_i"], "slot_status.armed": i["armed_i"],
            "slot_status.writing": i["writing_i"], "slot_status.refused": i["refused_i"],
            "job.status.waiting": i["job_level_i"], "job.status.ready": i["job_ready_i"],
            "job.status.busy": i["job_busy_i"], "result.pop.waiting": i["result_level_i"],
            "result.head.tag": r["tag"] if self.seen else 0,
            "result.head.status": r["status"] if self.seen else 0, "result.head.valid": self.seen,
            "result.best.x": r["best_x"], "result.best.y": r["best_y"], "result.scores.score": r["score"],
            "result.scores.runner_up": r["runner_up"], "irq_status.result": self.seen,
            "peek_data.value": self.peek.data,
        }
        for k in range(4):
            status[f"result.neighbour[{k}].even"] = r[f"neighbour{2 * k}"]
            status[f"result.neighbour[{k}].odd"] = r[f"neighbour{2 * k + 1}"]
        names = ["clocks", "busy", "scores", "jobs", "refused", "overflows", "frames[0]", "frames[1]", "drops[0]",
                 "drops[1]"]
        status.update({f"counter.{name}.value": n for name, n in zip(names, self.counts, strict=True)})
        return status

    def edge(self, i: Mapping[str, int], result: int | None, peek_data: int | None) -> None:
        """Take the clock edge; `result` and `peek_data` are `result_i` and `peek_data_i`, None if undefined."""
        v = self.csr.value
        overflow = int(v["job.submit.go"] and not i["job_ready_i"])
        others = i["ext_rd_data_i"] if self.extension else 0
        events, shown, wait, peeked = self.events, self.shown, self.peek_wait, self.csr.taken
        lost = self.happened[OVERFLOW]
        self.events = dict(zip(EVENTS, (i["captured_i"], int(i["dropped_i"] != 0), lost), strict=True))
        self.peek_wait = not self.peek.ready or bool(v["peek_address.go"])
        found = self.csr.found
        if found is not None and not found.is_write:  # otherwise nothing is read in the next clock
            self.shown = self.status(i, result)
        taken = bool(self.seen and self.pops[2])
        refused, seen = self.refused, self.seen
        self.seen = i["result_valid_i"]
        self.refused = result is not None and RESULT.unpack(result)["status"] != 0
        if i["rst_i"]:
            self.csr.edge(i, shown, events, wait, others)
            self.bank.reset()
            self.peek.reset()
            self.counts, self.irq = [0] * len(self.counts), 0
            self.events, self.happened = dict.fromkeys(EVENTS, 0), [0] * len(self.counts)
            self.counted, self.pops = [0] * len(self.counts), (0, 0, 0)
            return
        self.pops = (v["result.pop.go"], *self.pops[:2])
        happened: list[int] = [1, i["work_i"], i["score_i"], taken and not refused, taken and refused, overflow,
                    i["accepted_i"] & 1, i["accepted_i"] >> 1, i["dropped_i"] & 1, i["dropped_i"] >> 1]
        irq = (seen and v["irq_enable.result"]) or any(
            v[name] and v[name.replace("status", "enable")] for name in EVENTS) or (self.extension and i["ext_irq_i"])
        active = i["active_i"] | i["writing_i"]
        before = dict(v)
        self.csr.edge(i, shown, events, wait, others)
        v = before
        self.bank.edge(coef=bool(v["coef.go"]), second=v["coef.second"], index=v["coef.index"], value=v["coef.value"],
                       commit=bool(v["filter.go"]), size=(v["image_size.width"], v["image_size.height"]),
                       active=active)
        self.peek.edge(go=v["peek_address.go"], address=v["peek_address.word"], take=peeked,
                       ready=i["peek_ready_i"], done=i["peek_done_i"], data=peek_data)
        self.counts = [(n + bool(e)) & 0xFFFFFFFF for n, e in zip(self.counts, self.counted, strict=True)]
        self.counted, self.happened = self.happened, happened
        self.irq = int(bool(irq))

    def step(self, i: Mapping[str, int]) -> dict[str, int | None]:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.outputs()
        self.edge(i, i["result_i"], i["peek_data_i"])
        return out
