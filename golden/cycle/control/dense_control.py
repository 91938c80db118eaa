# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_control`: the dense engine's registers, behind the extension port of `slog_control`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from golden.cycle.control.axil import Request
from golden.cycle.control.csr import FieldPlace, RegistersModel
from golden.cycle.dense.structs import DENSE_JOB
from golden.cycle.model import Inputs, Values
from golden.dense_job import MOST
from golden.params import Config

JOB_FIELDS = {
    "left_slot": "planes.left", "right_slot": "planes.right", "window": "planes.window", "offsets": "search.offsets",
    "start": "search.start", "down": "vertical.down", "step_x": "vertical.step_x", "step_y": "vertical.step_y",
    "most": "limits.most", "margin": "limits.margin", "check": "planes.check", "live": "planes.live",
}
"""Fields of `dense_job_t` and those of the registers, without `dense.`."""
RESET = {"vertical.step_x": 1, "vertical.step_y": 1, "limits.most": MOST}
"""Reset values that are not 0."""
EVENTS = "dense.irq_status.done", "dense.irq_status.lost"
STORED = {f"dense.{name}": RESET.get(name, 0) for name in (*JOB_FIELDS.values(), "irq_enable.done", "irq_enable.lost")}
PULSES = "dense.run.go", "dense.run.cancel"
UNKNOWN = 4
"""Clocks from a reset until what was being read has left the read path."""


class DenseControlModel:
    """Every output is a register, so `outputs` needs no inputs.

    Args:
        config: the build.
        fields: the engine's registers, as in `RegistersModel`.
    """

    INPUTS = ("rst_i", "req_i", "is_wr_i", "addr_i", "data_i", "biten_i", "busy_i", "done_i", "status_i", "row_i",
              "stall_i")
    OUTPUTS = "rd_data_o", "irq_o", "start_o", "cancel_o", "job_o"

    def __init__(self, config: Config, fields: Mapping[str, FieldPlace]) -> None:
        self.config = config
        self.registers = RegistersModel(fields, STORED, EVENTS, PULSES)
        self.counts, self.happened = [0, 0], [0, 0]
        self.shown: dict[str, int | None] = {}  # inputs of the register block, from the clock before
        self.events = dict.fromkeys(EVENTS, 0)
        self.start = self.irq = 0
        self.unknown = UNKNOWN

    def outputs(self) -> Values:
        """Outputs of this clock."""
        value, answer = self.registers.value, self.registers.answer
        job = {name: value[f"dense.{path}"] for name, path in JOB_FIELDS.items()}
        return {"rd_data_o": None if self.unknown else answer[0] if answer else 0, "irq_o": self.irq,
                "start_o": self.start, "cancel_o": value["dense.run.cancel"],
                "job_o": DENSE_JOB.pack(job)}

    def _status(self, i: Inputs, free: bool) -> dict[str, int | None]:
        """Fields driven by hardware, as the host would read them in this clock."""
        c = self.config
        return {"dense.build.offsets": c.dense_offsets, "dense.build.max_window": c.dense_window,
                "dense.build.sizes": c.dense_sizes, "dense.build.lanes": c.dense_lanes,
                "dense.run.busy": int(not free), "dense.run.status": i["status_i"],
                "dense.rows.value": self.counts[0], "dense.stalls.value": self.counts[1]}

    def edge(self, i: Inputs) -> None:
        """Take the clock edge."""
        registers = self.registers
        free = not i["busy_i"] and not self.start
        go = registers.value["dense.run.go"]
        shown, events = self.shown, self.events
        self.shown = self._status(i, free)
        self.events = dict(zip(EVENTS, (i["done_i"], int(go and not free)), strict=True))
        self.irq = int(any(registers.value[name] and registers.value[name.replace("status", "enable")]
                           for name in EVENTS))
        found = registers.found
        if found is not None and found.is_write:  # the data follow the address by two clocks
            strobes = sum(1 << byte for byte in range(4) if i["biten_i"] >> 8 * byte & 1)
            registers.found = replace(found, data=i["data_i"], strobes=strobes)
        request = Request(i["addr_i"], bool(i["is_wr_i"])) if i["req_i"] else None
        registers.take(i["rst_i"], request, shown, events)
        self.counts = [n + event & 0xFFFFFFFF for n, event in zip(self.counts, self.happened, strict=True)]
        self.happened = [i["row_i"], i["stall_i"]]
        self.start = int(bool(go) and free)
        self.unknown = max(self.unknown - 1, 0)
        if i["rst_i"]:
            self.counts, self.happened, self.events = [0, 0], [0, 0], dict.fromkeys(EVENTS, 0)
            self.start = self.irq = 0
            self.unknown = UNKNOWN

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.outputs()
        self.edge(i)
        return out
