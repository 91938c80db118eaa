# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_frontend`."""

from __future__ import annotations

from collections import deque

from golden.cycle.frontend.log import LogModel, pixel_inputs
from golden.cycle.frontend.packer import PackerModel
from golden.cycle.frontend.video_in import VideoInModel
from golden.cycle.model import Inputs, Values


class FrontendModel:
    """Video in, LoG and packer in series: each gets the outputs of the one before it in the same clock."""

    INPUTS = (*VideoInModel.INPUTS, "g_i", "g2_i")
    OUTPUTS = ("tready_o", "busy_o", *PackerModel.OUTPUTS, "accepted_o", "dropped_o")

    def __init__(self, max_width: int, radius: int, group_bits: int) -> None:
        self.video = VideoInModel(radius)
        self.log = LogModel(max_width, radius)
        self.packer = PackerModel(group_bits)
        self.video_busy: deque[int | None] = deque([0] * 4, 4)
        self.log_busy: deque[int | None] = deque([0] * 6, 6)
        self.hold, self.abort = 0, 0  # hold_i and abort_i of the clock before

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        video = self.video.step({**i, "hold_i": self.hold, "abort_i": self.abort})
        self.hold = i["hold_i"] | i["rst_i"]
        self.abort = i["abort_i"] & ~i["rst_i"]
        px = pixel_inputs(video)
        bit = self.log.step({"rst_i": i["rst_i"], "g_i": i["g_i"], "g2_i": i["g2_i"], **px})
        word = self.packer.step({"rst_i": i["rst_i"], **{f"{k[:-2]}_i": v for k, v in bit.items()}})
        busy = int(any(self.video_busy) or any([*self.log_busy][:5]))
        self.video_busy.append(video["busy_o"])
        self.log_busy.append(bit["busy_o"])
        if i["rst_i"]:
            self.video_busy.extend([0] * 4)
            self.log_busy.extend([0] * 6)
        return {"tready_o": video["tready_o"], "busy_o": busy, **word,
                "accepted_o": video["accepted_o"], "dropped_o": video["dropped_o"]}
