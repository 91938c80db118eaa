# SPDX-License-Identifier: Apache-2.0
"""Passes of the dense engine: how long one takes on the Verilated board, and how many of its clocks yield a pixel; and
how long one takes on the golden board, beside OpenCV's block matcher."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from golden.compiled.calls import choose, pack
from golden.dense import DensePass
from golden.dense_job import DenseJob, run_dense
from golden.log import kernels, sign
from golden.params import DENSE, Config
from sim.board.dense import DenseEngine
from sim.board.device import Device
from sim.speed import workload

SECONDS = 3.0
"""A pass of all offsets over the largest image takes no longer on the Verilated board."""
SHARE = 0.95
"""Of a pass' clocks, at least, that yield a pixel."""


RATIO = 1.5
"""The golden board's pass of 64 offsets is at least so many times as fast as the block matcher."""
ROUNDS = 25
"""Passes of either, in turn, so that other load on the machine meets both."""


def dense_against_opencv() -> dict[str, Any]:
    """A pass of 64 offsets and windows of 32x32 on the golden board, every field, beside StereoBM: 64 disparities,
    windows of 21x21; both of 640x480 pixels and on one thread.

    Raises:
        SystemExit: if the bar is missed.
    """
    cv2.setNumThreads(1)
    kernel, arithmetic = choose()
    frames = workload.pair(640, 480)
    planes = [sign(frame, workload.SIGMA, 16) for frame in frames]
    job = DenseJob(0, 1, DensePass(32, 64), check=True)
    matcher = cv2.StereoBM.create(64, 21)
    left, right = (pack(plane) for plane in planes)
    work: dict[str, Callable[[], object]] = {
        "golden": lambda: (kernel.dense(left, right, 640, job) if kernel else
                           run_dense(job, dict(enumerate(planes)), DENSE, (640, 480))),
        "StereoBM": lambda: matcher.compute(*frames)}
    seconds: dict[str, list[float]] = {name: [] for name in work}
    for _ in range(ROUNDS):
        for name, call in work.items():
            begun = time.process_time()
            call()
            seconds[name].append(time.process_time() - begun)
    ratio = float(np.median(np.array(seconds["StereoBM"]) / np.array(seconds["golden"])))
    if ratio < RATIO:
        raise SystemExit(f"the golden board's dense pass ({arithmetic}) is {ratio:.2f} times as fast as StereoBM (bar "
                         f"{RATIO:g})")
    return {"arithmetic": arithmetic, "ratio": round(ratio, 2),
            **{f"{name}_frames_per_s": round(1 / min(times), 1) for name, times in seconds.items()}}


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
