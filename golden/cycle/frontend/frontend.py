"""Cycle models of `slog_video_in`, `slog_packer` and of the whole front end."""

from __future__ import annotations

from collections import deque

from golden.cycle.bits import Bits
from golden.cycle.frontend.log import LogModel
from golden.cycle.frontend.packer import PackerModel
from golden.cycle.frontend.video_in import VideoInModel


class FrontendModel:
    """The three models one behind the other: each sees the others' outputs of the same clock."""

    INPUTS = (*VideoInModel.INPUTS, "g_i", "g2_i")
    OUTPUTS = ("tready_o", "busy_o", *PackerModel.OUTPUTS, "accepted_o", "dropped_o")

    def __init__(self, max_width: int, radius: int, group_bits: int) -> None:
        self.video = VideoInModel(radius)
        self.log = LogModel(max_width, radius)
        self.packer = PackerModel(group_bits)
        self.video_busy: deque[int | None] = deque([0] * 4, 4)
        self.log_busy: deque[int | None] = deque([0] * 6, 6)
        self.hold = 0  # of the clock before

    def step(self, i: dict[str, int]) -> Bits:
        """Outputs of this clock, then the edge."""
        video = self.video.step({**i, "hold_i": self.hold})
        self.hold = i["hold_i"] | i["rst_i"]
        # Fields that are undefined here are not looked at behind.
        px = {f"{k[:-2]}_i": v or 0 for k, v in video.items() if k.startswith("px_")}
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
