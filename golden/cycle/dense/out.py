# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_out`."""

from __future__ import annotations

from golden.cycle.bits import all_or_zero, or_zero
from golden.cycle.cells.ram_fifo import RamFifoModel
from golden.cycle.cells.stage import StageModel
from golden.cycle.dense.structs import CHECKED, MAP, NO_SUM, NOTHING
from golden.cycle.model import Inputs, Values


def map_word(pixel: int, most: int, margin: int, check: int) -> int:
    """The `map_t` of a packed `checked_t`."""
    p = CHECKED.unpack(pixel)
    clear = p["rest"] == NO_SUM or p["rest"] - p["best"] >= margin
    valid = p["found"] and p["best"] <= most and clear and (p["agrees"] or not check)
    return MAP.pack({**p, "zero": 0, "valid": int(valid)})


class DenseOutModel:
    """Pixels counted, thinned out, judged and queued; three stages before the queue."""

    INPUTS = ("rst_i", "clear_i", "tail_i", "valid_i", "pixel_i", "image_width_i", "image_height_i", "step_x_i",
              "step_y_i", "most_i", "margin_i", "check_i", "map_tready_i")
    OUTPUTS = ("map_tvalid_o", "map_tdata_o", "map_tuser_o", "map_tlast_o", "taken_o")

    def __init__(self, depth: int) -> None:
        self.fifo, self.stage = RamFifoModel(depth), StageModel()
        self.seen = 0
        """Pixels of the map so far."""
        self.begun = False
        self.came: Inputs | None = None
        """Inputs of the clock before."""
        self.judged: tuple[int, bool] | None = None
        self.queued: int | None = None
        self.taken = (0, 0)
        """Whether the sink took a word one and two clocks ago."""

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        free = self.stage.word is None or i["map_tready_i"]
        front = self.fifo.step(all_or_zero({
            "rst_i": i["rst_i"], "in_valid_i": int(self.queued is not None), "in_data_i": self.queued,
            "out_ready_i": int(bool(self.fifo.front) and bool(free))}))
        shown = self.stage.step({"rst_i": i["rst_i"], "in_valid_i": or_zero(front["out_valid_o"]),
                                 "in_data_i": or_zero(front["out_data_o"]), "out_ready_i": i["map_tready_i"]})
        word = shown["out_data_o"]
        out: Values = {"map_tvalid_o": shown["out_valid_o"], "taken_o": self.taken[1],
                       "map_tdata_o": None if word is None else word >> 2,
                       "map_tuser_o": None if word is None else word & 1,
                       "map_tlast_o": None if word is None else word >> 1 & 1}
        took = or_zero(shown["out_valid_o"]) & i["map_tready_i"]
        self.taken = (0, 0) if i["rst_i"] else (took, self.taken[0])
        if self.came is not None:
            self._judge(self.came)
        self.came = i
        if i["rst_i"]:
            self.judged = self.queued = None
            self.came = {**i, "valid_i": 0, "tail_i": 0}
        return out

    def _judge(self, i: Inputs) -> None:
        """The stages before the queue."""
        self.queued = None
        if self.judged is not None:
            pixel, last = self.judged
            word = map_word(pixel, i["most_i"], i["margin_i"], i["check_i"])
            self.queued = word << 2 | last << 1 | (not self.begun)
            self.begun = True
        self.judged = None
        if i["tail_i"]:
            self.judged = NOTHING, True
        if i["clear_i"]:
            self.seen, self.begun = 0, False
        elif i["valid_i"]:
            self._count(i)

    def _count(self, i: Inputs) -> None:
        """One pixel more."""
        y, x = divmod(self.seen, i["image_width_i"])
        self.seen += 1
        if x % i["step_x_i"] == 0 and y % i["step_y_i"] == 0:
            last = x + i["step_x_i"] >= i["image_width_i"] and y + i["step_y_i"] >= i["image_height_i"]
            self.judged = i["pixel_i"], last
