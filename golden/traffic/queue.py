# SPDX-License-Identifier: Apache-2.0
"""Words through a queue, for the modules with the ports of `slog_fifo`."""

from __future__ import annotations

import random

from golden.cycle.model import Stimulus
from golden.traffic.stalls import ready_pattern


def queue_words(rng: random.Random, source: str, sink: str, width: int, clocks: int) -> Stimulus:
    """`clocks` clocks of random words of `width` bits, both ends stalled by shape, with one reset half-way."""
    offer, take = ready_pattern(source, rng), ready_pattern(sink, rng)
    held: int | None = None
    for t in range(clocks):
        if held is None and next(offer):
            held = rng.getrandbits(width)
        valid = held is not None
        out = yield {"rst_i": int(t == clocks // 2), "in_valid_i": int(valid),
                     "in_data_i": held if held is not None else rng.getrandbits(width), "out_ready_i": next(take)}
        if valid and out["in_ready_o"]:
            held = None
