# SPDX-License-Identifier: Apache-2.0
"""The Verilated board `dense` against the golden one at 640x480: every field of random and real frames, and its speed.

`make dense` (`python -m tests.dense_board [--passes N] [--seed N]`) prints each pass; it exits with 1 if a bar is
missed.
"""

from __future__ import annotations

import argparse
import random
import time
from dataclasses import replace

import cv2
import numpy as np
import skimage.data

from golden.dense import DensePass
from golden.dense_job import DenseJob, DenseResult, DenseStatus
from golden.params import DENSE
from signum.boards.board import Board
from signum.boards.golden import GoldenBoard
from signum.boards.verilated import VerilatedBoard
from signum.common.arrays import Image
from sim.board.dense import DenseEngine
from sim.seeds import session_seed
from tests.boards.dense_scenes import MARGIN, random_pair, random_search

SIZE = DENSE.max_width, DENSE.max_height
SECONDS = 3.0
"""A pass of all offsets takes no longer on the Verilated board."""
SHARE = 0.95
"""Of a pass' clocks, at least, that yield a pixel."""
PAUSE = 0.2
"""Share of the clocks in which the cameras of a live pass hold a pixel back: their rows take longer than the pass'."""
ENDS = 1400
"""Clocks, at most, from whole frames to the end of a live pass of all offsets, register accesses included."""
PHOTOGRAPHS = "gravel", "brick", "grass", "coins", "camera", "moon"


def _photograph(name: str) -> Image:
    """A photograph as a scene for frames of SIZE."""
    grey = np.asarray(getattr(skimage.data, name)())
    return np.asarray(cv2.resize(grey, (SIZE[0] + 2 * MARGIN, SIZE[1] + 2 * MARGIN)), np.uint8)


def _differences(ours: DenseResult, theirs: DenseResult) -> int:
    """Values that differ, of all fields."""
    return sum(int(np.count_nonzero(values != getattr(theirs, name))) for name, values in vars(ours).items())


def compare(golden: Board, verilated: Board, job: DenseJob) -> tuple[int, int, float, int]:
    """Run a job on both boards: pixels, values that differ, and seconds and clocks on the Verilated one."""
    expected = golden.dense(job)
    before, begun = verilated.counters()["busy_clocks"], time.perf_counter()
    found = verilated.dense(job)
    seconds = time.perf_counter() - begun
    return (found.index.size, _differences(expected, found), seconds,
            verilated.counters()["busy_clocks"] - before)


def clocks_after(board: VerilatedBoard, job: DenseJob, frames: tuple[Image, Image]) -> tuple[int, int, DenseResult]:
    """Clocks from the last pixel of slow cameras to whole frames and to the end of a pass over them, and its result."""
    device, engine = board._device, DenseEngine(board._device)
    for camera, slot in enumerate((job.left, job.right)):
        device.arm(slot, camera)
    engine.load(job)
    if job.live:
        engine.go()
    for camera, frame in enumerate(frames):
        device.play(frame, camera, PAUSE, 1 + camera)
    device.finish_playing()
    begun = device.clocks
    device.wait_captured(0, 1)
    whole = device.clocks - begun
    if not job.live:
        engine.go()
    status, found = engine.collect(job)
    assert status is DenseStatus.OK and found is not None
    return whole, device.clocks - begun, found


def main(argv: list[str] | None = None) -> int:
    """Print every pass; returns the exit status."""
    parser = argparse.ArgumentParser(prog="make dense", description=__doc__)
    parser.add_argument("--passes", type=int, default=12)
    parser.add_argument("--seed", type=int, default=session_seed())
    args = parser.parse_args(argv)
    rng = random.Random(args.seed)
    pixels = wrong = 0
    fastest, share = float("inf"), 0.0
    with GoldenBoard(DENSE) as golden, VerilatedBoard(DENSE) as verilated:
        for number in range(args.passes):
            scene = _photograph(PHOTOGRAPHS[number // 2 % len(PHOTOGRAPHS)]) if number % 2 else None
            frames = random_pair(rng, SIZE, scene)
            for board in (golden, verilated):
                board.configure(SIZE, 1.5)
                board.capture_pair((0, 1), frames)
            whole = number < 3  # each window with all offsets first, which are timed
            search = (DensePass(DENSE.dense_windows[number], DENSE.dense_offsets, -DENSE.dense_offsets // 2)
                      if whole else random_search(rng, DENSE))
            job = DenseJob(0, 1, search, most=search.window**2 // 3, margin=search.window // 4, check=True)
            size, differ, seconds, clocks = compare(golden, verilated, job)
            pixels, wrong = pixels + size, wrong + differ
            if whole:
                fastest, share = min(fastest, seconds), max(share, size / clocks)
            print(f"  {search}: {size} pixels, {differ} values differ, {seconds:.2f} s, {clocks} clocks", flush=True)
        # Of the coarsest step the words come 255 rows apart.
        size, differ, _, _ = compare(golden, verilated, replace(job, step=(8, 255)))
        pixels, wrong = pixels + size, wrong + differ
        print(f"  step (8, 255): {size} pixels, {differ} values differ", flush=True)
        late = []
        for live in (False, True):
            job = DenseJob(0, 1, DensePass(DENSE.dense_windows[0], DENSE.dense_offsets), check=True, live=live)
            stored, taken, found = clocks_after(verilated, job, frames)
            golden.capture_pair((0, 1), frames)
            differ = _differences(golden.dense(job), found)
            late.append(taken - stored)
            pixels, wrong = pixels + found.index.size, wrong + differ
            print(f"  {'live' if live else 'not live'}: {differ} values differ; the frames are whole {stored} clocks "
                  f"after the cameras' last pixel, the map ends {taken} after it", flush=True)
    print(f"a live map ends {late[1]} clocks after its frames (bar {ENDS}), another one {late[0]}")
    print(f"{pixels} pixels compared, {wrong} values differ; a pass of {DENSE.dense_offsets} offsets: "
          f"{fastest:.2f} s (bar {SECONDS:g}), {share:.1%} of its clocks yield a pixel (bar {SHARE:.0%})")
    return int(wrong > 0 or late[1] > ENDS or fastest > SECONDS or share < SHARE)


if __name__ == "__main__":
    raise SystemExit(main())
