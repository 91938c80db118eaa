# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_capture`."""

from __future__ import annotations

from golden.cycle.model import Inputs, Values
from golden.cycle.store.capture_channel import HOPS, PROGRESS, CaptureChannelModel


class CaptureModel:
    """A channel per camera, the valid bits, and the store port, where camera 0 has priority.

    Vectors over cameras are packed, camera 0 lowest.
    """

    INPUTS = ("rst_i", "cmd_valid_i", "cmd_cancel_i", "cmd_camera_i", "cmd_slot_i", "clear_i", "slot_busy_i",
              "word_valid_i", "word_data_i", "word_last_i", "frame_start_i", "frame_done_i", "frame_abort_i")
    OUTPUTS = ("wr_valid_o", "wr_addr_o", "wr_data_o", "slot_valid_o", "armed_o", "writing_o", "refused_o", "done_o",
               "progress_o")

    def __init__(self, cameras: int, group_bits: int, slots: int, slot_words: int, words_per_row: int) -> None:
        self.cameras, self.group_bits, self.slots = cameras, group_bits, slots
        self.channels = [CaptureChannelModel(slot_words, words_per_row) for _ in range(cameras)]
        self.slot_valid, self.refused, self.done = 0, 0, 0
        self.write: tuple[int, int] | None = None
        self.chosen: list[tuple[int, int] | None] = [None] * (HOPS + 1)  # coming store writes, the latest first
        self.command: tuple[bool, int, int] | None = None  # cancel, camera, slot: the command of two clocks before
        self.coming: tuple[bool, int, int] | None = None  # cancel, camera, slot: the command of the clock before

    def outputs(self) -> Values:
        """Outputs of this clock: all are registers, or depend on the command of two clocks before."""
        arm, cancel, refused = self._decide()
        return {
            "wr_valid_o": int(self.write is not None),
            "wr_addr_o": self.write[0] if self.write else None,
            "wr_data_o": self.write[1] if self.write else None,
            "slot_valid_o": self.slot_valid,
            "armed_o": sum((arm == c or (ch.armed and cancel != c)) << c for c, ch in enumerate(self.channels)),
            "writing_o": sum(ch.writing << c for c, ch in enumerate(self.channels)),
            "refused_o": refused,
            "done_o": self.done,
            "progress_o": sum(ch.progress << PROGRESS.bits * c for c, ch in enumerate(self.channels)),
        }

    def _decide(self) -> tuple[int | None, int | None, int]:
        """The camera armed and the camera cancelled in this clock, if any; whether the last command was refused."""
        if self.command is None:
            return None, None, self.refused
        cancel, camera, slot = self.command
        if cancel:
            return None, camera, 0
        taken = any(ch.writing if c == camera else ch.armed and ch.slot == slot
                    for c, ch in enumerate(self.channels))
        accept = slot < self.slots and camera < self.cameras and not taken
        return (camera, None, 0) if accept else (None, None, 1)

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.outputs()
        arm, cancel, refused = self._decide()
        slot = self.command[2] if self.command else 0
        pops = next((c for c, ch in enumerate(self.channels) if ch.fifo), None)
        write = self.channels[pops].fifo[0] if pops is not None else None
        valid, any_done = self.slot_valid, False
        mask = (1 << self.group_bits) - 1
        for c, ch in enumerate(self.channels):
            held = ch.slot
            if ch.clears:
                valid &= ~(1 << held)
            if ch.restores or ch.finishes:
                valid |= 1 << held
            any_done |= ch.finishes
            ch.edge(
                rst=i["rst_i"], arm=arm == c, cancel=cancel == c, slot=slot, busy=i["slot_busy_i"] >> held & 1,
                valid=self.slot_valid >> held & 1,
                word=(i["word_data_i"] >> c * self.group_bits) & mask if i["word_valid_i"] >> c & 1 else None,
                last=i["word_last_i"] >> c & 1, start=i["frame_start_i"] >> c & 1, done=i["frame_done_i"] >> c & 1,
                abort=i["frame_abort_i"] >> c & 1, pop=pops == c)
        self.command, self.coming = self.coming, None
        if i["cmd_valid_i"]:
            self.coming = bool(i["cmd_cancel_i"]), i["cmd_camera_i"], i["cmd_slot_i"]
        if i["rst_i"]:
            self.command = self.coming = None
            self.slot_valid, self.refused, self.done, self.write = 0, 0, 0, None
            self.chosen = [None] * (HOPS + 1)
        else:
            self.slot_valid = 0 if i["clear_i"] else valid
            self.refused = refused
            self.done = int(any_done)
            *self.chosen, self.write = write, *self.chosen
        return out
