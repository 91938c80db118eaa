# SPDX-License-Identifier: Apache-2.0
"""Cycle model of `slog_taps`."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from golden.cycle.bits import pack
from golden.cycle.model import Inputs, Values


@dataclass
class _Tap:
    """A pair of values in the delay line and its flags."""

    valid: int = 0
    first: int = 0
    last: int = 0
    a: int = 0
    b: int = 0


class TapsModel:
    """Windows of the horizontal filters; beyond an end of the centre's line its end value repeats."""

    FIELD = 32
    """Bits a value takes in a window."""

    INPUTS = ("rst_i", "valid_i", "first_i", "last_i", "a_i", "b_i")
    OUTPUTS = ("valid_o", "a_window_o", "b_window_o")

    def __init__(self, radius: int) -> None:
        self.radius = radius
        self.taps: deque[_Tap] = deque([_Tap() for _ in range(2 * radius + 2)], 2 * radius + 2)  # oldest first

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        r, taps = self.radius, self.taps
        out: Values = {"valid_o": taps[r].valid, "a_window_o": None, "b_window_o": None}
        if taps[r].valid:
            oldest = next((k for k in range(r, -1, -1) if taps[k].first), 0)
            newest = next((k for k in range(r, 2 * r + 1) if taps[k].last), 2 * r)
            window = [taps[min(max(k, oldest), newest)] for k in range(2 * r + 1)]
            out |= {"a_window_o": pack([t.a for t in window], self.FIELD),
                    "b_window_o": pack([t.b for t in window], self.FIELD)}
        v = i["valid_i"]
        taps.append(_Tap(v, i["first_i"], i["last_i"], i["a_i"], i["b_i"]))
        if i["rst_i"]:
            taps.extend([_Tap() for _ in taps])
        return out
