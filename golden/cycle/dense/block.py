# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense`."""

from __future__ import annotations

from golden.cycle.bits import all_or_zero
from golden.cycle.dense.check import DenseCheckModel
from golden.cycle.dense.dense_pass import DensePassModel
from golden.cycle.dense.engine import DenseEngineModel, flush_clocks
from golden.cycle.dense.feed import DenseFeedModel
from golden.cycle.dense.live import DenseLiveModel
from golden.cycle.dense.out import DenseOutModel
from golden.cycle.dense.plan import DenseBuild, DensePlanModel, unpack_job
from golden.cycle.dense.room import DenseRoomModel
from golden.cycle.dense.structs import PLAN
from golden.cycle.model import Inputs, Values

SENT = ("left_valid", "first", "left_incoming", "left_leaving", "left_ok", "right_valid", "right_incoming",
        "right_leaving", "right_ok")
LIMITS = "step_x", "step_y", "most", "margin", "check"


class DenseBlockModel:
    """Pass, plan, live, room, feed, engine, check and output wired together.

    Every wire between them comes from a register, so each part takes what the others showed in this clock.
    """

    INPUTS = ("rst_i", "start_i", "job_i", "cancel_i", "image_width_i", "image_height_i", "slot_valid_i",
              "progress_i", "clear_i", "rd_data_i", "map_tready_i")
    OUTPUTS = ("slot_busy_o", "rd_valid_o", "rd_addr_o", "map_tvalid_o", "map_tdata_o", "map_tuser_o", "map_tlast_o",
               "busy_o", "done_o", "status_o", "row_o", "stall_o")

    def __init__(self, build: DenseBuild) -> None:
        self.sequence = DensePassModel(flush_clocks(build.offsets, build.max_window))
        self.plan, self.room, self.feed = DensePlanModel(build), DenseRoomModel(build.out_depth), DenseFeedModel(build)
        self.live, self.slots = DenseLiveModel(slots=build.slots), build.slots
        self.engine = DenseEngineModel(build.offsets, build.lanes, build.max_window)
        self.check, self.output = DenseCheckModel(build.offsets), DenseOutModel(build.out_depth)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rst = {"rst_i": i["rst_i"]}
        led, sent, room, seen = self.sequence.out, self.feed.out, self.room.out, self.live.out
        now = all_or_zero(led)
        job, size = unpack_job(now["job_o"]), {name: now[f"{name[:-2]}_o"] for name in ("image_width_i",
                                                                                         "image_height_i")}
        planned = self.plan.step({**rst, **size, "start_i": now["plan_o"], "job_i": now["job_o"],
                                  "slot_valid_i": i["slot_valid_i"], "here_i": seen["here_o"] or 0})
        planned_now = all_or_zero(planned)
        plan = PLAN.unpack(planned_now["plan_o"])
        columns = all_or_zero({f"{name}_i": sent[f"{name}_o"] for name in SENT})
        won = all_or_zero(self.engine.step({**rst, **columns, "flush_i": now["flush_o"], "shrink_i": plan["shrink"],
                                            "offsets_i": job["offsets"]}))
        checked = all_or_zero(self.check.step({**rst, "winner_valid_i": won["winner_valid_o"],
                                               "winner_i": won["winner_o"], "back_i": won["back_o"]}))
        shown = self.output.step({**rst, **size, "clear_i": now["clear_o"], "tail_i": now["tail_o"],
                                  "valid_i": checked["valid_o"], "pixel_i": checked["checked_o"],
                                  **{f"{name}_i": job[name] for name in LIMITS},
                                  "map_tready_i": i["map_tready_i"]})
        self.room.step({**rst, "words_i": now["words_o"], "reserve_i": now["reserve_o"],
                        "taken_i": shown["taken_o"] or 0})
        self.feed.step({**rst, "begin_i": now["begin_o"], "row_i": now["row_o"], "plan_i": planned_now["plan_o"],
                        "down_i": job["down"] & 0x3FF, "width_i": size["image_width_i"],
                        "height_i": size["image_height_i"], "rd_data_i": i["rd_data_i"]})
        keep = self.live.keep(job["live"])
        known = all_or_zero({**room, **seen, "busy_o": sent["busy_o"]})
        self.live.step({**rst, "begin_i": now["plan_o"], "reading_i": now["reading_o"], "live_i": job["live"],
                        "slots_i": self._slots(now["slots_o"]), "down_i": job["down"] & 0x3FF, "row_i": now["row_o"],
                        **{name: i[name] for name in ("progress_i", "slot_valid_i", "clear_i")}})
        self.sequence.step({**rst, **{name: i[name] for name in ("start_i", "job_i", "cancel_i", "image_width_i",
                                                                 "image_height_i")},
                            "planned_i": planned_now["done_o"], "status_i": planned_now["status_o"],
                            "pitch_i": plan["pitch"], "row_words_i": plan["words"], "feed_busy_i": known["busy_o"],
                            "keep_i": keep, "there_i": known["there_o"], "whole_i": known["whole_o"],
                            "lost_i": known["lost_o"], "room_i": known["room_o"], "empty_i": known["empty_o"]})
        return {**{name: led[name] for name in ("slot_busy_o", "busy_o", "done_o", "status_o", "row_o", "stall_o")},
                **{name: sent[name] for name in ("rd_valid_o", "rd_addr_o")},
                **{name: shown[name] for name in ("map_tvalid_o", "map_tdata_o", "map_tuser_o", "map_tlast_o")}}

    def _slots(self, both: int) -> int:
        """A bit for each slot of the store, the left plane's and the right one's, from a bit for each of eight."""
        mask = (1 << self.slots) - 1
        return both & mask | (both >> 8 & mask) << self.slots
