# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_dense_live`."""

from __future__ import annotations

from golden.cycle.bits import signed
from golden.cycle.model import Inputs, Values
from golden.cycle.store.capture_channel import PROGRESS

ABSENT, AWAITED, FOLLOWED, WHOLE, LOST = range(5)
"""States of a plane; without a live job ABSENT."""


class DenseLiveModel:
    """The states of both planes, and whether their frames have the rows of the next row.

    Attributes:
        out: outputs of this clock but `keep_o`, which depends on `live_i`.
    """

    INPUTS = ("rst_i", "begin_i", "reading_i", "live_i", "slots_i", "down_i", "row_i", "progress_i", "slot_valid_i",
              "clear_i")
    OUTPUTS = "here_o", "keep_o", "there_o", "whole_o", "lost_o"

    def __init__(self, cameras: int = 2, slots: int = 8) -> None:
        self.cameras, self.slots = cameras, slots
        self.came: tuple[int, int, int] = 0, 0, 0
        """Progress, valid slots and clear of the clock before."""
        self.states = [ABSENT, ABSENT]
        self.here = [0, 0]
        self.rows = [0, 0]
        """Rows that the cameras of the planes' slots have written."""
        self.next = [0, 0]
        """Numbers of the next rows: left, right; they do not matter before the first job."""
        self.has = [0, 0]
        self.out: Values = {"here_o": 0, "there_o": None, "whole_o": None, "lost_o": 0}

    def keep(self, live: int) -> int:
        """`keep_o` with this `live_i`."""
        return 3 if not live else sum((state in (FOLLOWED, WHOLE, LOST)) << p for p, state in enumerate(self.states))

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        live = i["live_i"]
        out = {**self.out, "keep_o": self.keep(live)}
        there, both = int(not live or all(self.has)), int(not live or self.states == [WHOLE, WHOLE])
        lost = int(LOST in self.states and not i["rst_i"])
        self.has = [int(state == WHOLE or (p == 1 and row < 0) or (state == FOLLOWED and rows > row))
                    for p, (state, rows, row) in enumerate(zip(self.states, self.rows, self.next, strict=True))]
        self._follow(i, *(i["slots_i"] >> self.slots * p & (1 << self.slots) - 1 for p in (0, 1)))
        if i["begin_i"]:
            self.next = [0, -signed(i["down_i"], 10)]
        elif i["row_i"]:
            self.next = [row + 1 for row in self.next]
        self.came = i["progress_i"], i["slot_valid_i"], i["clear_i"]
        self.out = {"here_o": self.here[0] | self.here[1] << 1, "there_o": there, "whole_o": both, "lost_o": lost}
        return out

    def _follow(self, i: Inputs, *slots: int) -> None:
        """Take over what the cameras did in the clock before; `slots`: one-hot, of the left and the right plane."""
        progress, valid, clear = self.came
        requests = [PROGRESS.unpack(progress >> PROGRESS.bits * c) for c in range(self.cameras)]
        active = i["reading_i"] and live_of(i)
        for p, slot in enumerate(slots):
            mine = [one for one in requests if one["held"] and slot >> one["slot"] & 1]
            writes, done = (any(one[name] for one in mine) for name in ("writing", "done"))
            self.rows[p] = 0
            for one in mine:
                self.rows[p] |= one["rows"]
            if not active:
                self.states[p], self.here[p] = ABSENT, 0
            elif i["begin_i"]:
                held = valid & slot
                self.here[p] = int(not clear and bool(mine or held))
                self.states[p] = (ABSENT if not self.here[p] else WHOLE if done or not mine
                                  else FOLLOWED if writes else AWAITED)
            elif self.states[p] in (AWAITED, FOLLOWED):
                broken = self.states[p] == FOLLOWED and not writes
                self.states[p] = (WHOLE if done else LOST if clear or not mine or broken
                                  else FOLLOWED if writes else AWAITED)


def live_of(i: Inputs) -> bool:
    """Whether a live job is led, and no reset comes."""
    return bool(i["live_i"]) and not i["rst_i"]
