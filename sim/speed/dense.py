# SPDX-License-Identifier: Apache-2.0
"""Passes of the dense engine: how long one takes on the Verilated board, and how many of its clocks yield a pixel."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from golden.dense import DensePass
from golden.dense_job import DenseJob, run_dense
from golden.log import kernels, sign
from golden.params import Config
from sim.board.dense import DenseEngine
from sim.board.device import Device
from sim.speed import workload

SECONDS = 3.0
"""A pass of all offsets over the largest image takes no longer on the Verilated board."""
SHARE = 0.95
"""Of a pass' clocks, at least, that yield a pixel."""


def dense_pass(config: Config) -> dict[str, Any]:
    """Seconds of processor time and clocks of a pass of all offsets over the largest image, results compared.

    Args:
        config: a build with a dense engine.

    Raises:
        SystemExit: if the golden model has another result, or a bar is missed.
    """
    size = config.max_width, config.max_height
    job = DenseJob(0, 1, DensePass(config.dense_window, config.dense_offsets, -config.dense_offsets // 2), check=True)
    frames = workload.pair(*size)
    planes = {slot: sign(frame, workload.SIGMA, config.radius) for slot, frame in enumerate(frames)}
    expected = run_dense(job, planes, config, size)[1]
    seconds = []
    with Device(config) as board:
        board.set_filter(*kernels(workload.SIGMA, config.radius), size)
        board.capture({0: 0, 1: 1}, dict(enumerate(frames)))
        for _ in range(3):
            before, begun = board.counters()["busy"], time.process_time()
            found = DenseEngine(board).run(job)[1]
            seconds.append(time.process_time() - begun)
            clocks = board.counters()["busy"] - before
    if not all(np.array_equal(values, getattr(found, name)) for name, values in vars(expected).items()):
        raise SystemExit("Verilated and golden passes of the dense engine differ")
    share = size[0] * size[1] / clocks
    if min(seconds) > SECONDS or share < SHARE:
        raise SystemExit(f"a pass of the dense engine takes {min(seconds):.2f} s (bar {SECONDS:g}), "
                         f"{share:.1%} of its clocks yield a pixel (bar {SHARE:.0%})")
    return {"offsets": config.dense_offsets, "window": config.dense_window, "clocks": clocks, "share": round(share, 4),
            "verilated_s_per_pass": round(min(seconds), 3), "verilated_clocks_per_s": round(clocks / min(seconds))}
