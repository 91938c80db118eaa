# SPDX-License-Identifier: Apache-2.0
"""Words through a queue, for the modules with the ports of `slog_fifo`."""

from __future__ import annotations

import random
from collections.abc import Callable

from golden.cycle.model import Stimulus
from golden.traffic.lasting import lasting
from golden.traffic.stalls import ready_pattern

MOST = 20
"""Longest run, in times of the one asked for."""


def queue_words(rng: random.Random, source: str, sink: str, width: int, clocks: int,
                enough: Callable[[], bool] = lambda: True) -> Stimulus:
    """`clocks` clocks of random words of `width` bits, and on until `enough()`, both ends stalled by shape, with one
    reset half-way through the `clocks`."""
    offer, take = ready_pattern(source, rng), ready_pattern(sink, rng)
    held: int | None = None
    for t in lasting(clocks, MOST * clocks, enough):
        if held is None and next(offer):
            held = rng.getrandbits(width)
        valid = held is not None
        out = yield {"rst_i": int(t == clocks // 2), "in_valid_i": int(valid),
                     "in_data_i": held if held is not None else rng.getrandbits(width), "out_ready_i": next(take)}
        if valid and out["in_ready_o"]:
            held = None
