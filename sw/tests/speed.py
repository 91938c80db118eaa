# SPDX-License-Identifier: Apache-2.0
"""Speeds of the golden board on one core, held to bars; `make speed`.

    python -m tests.speed [--frames 300] [--snapshots 60]

Searches of a 64x64 window over +-32 by each variant of the kernel that the processor has, against OpenCV's
`matchTemplate`; then `signum flow`, `hold` and `mosaic` as a user calls them, start, report and pictures included.
Seconds are of processor time, so that other load counts little; the fastest of several runs counts. The status is 1
if a bar is missed.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from golden import log
from golden.compiled.calls import NUMPY, choose, pack, variants
from golden.correlate import Job
from golden.params import FULL
from golden.tables import jobs_table
from signum.common.arrays import Image
from signum.common.files import write_picture
from tests.endurance import floor

WINDOW, REACH, SIGMA = 64, 32, 2.0
SIZE = (640, 480)
OVER_OPENCV = {"avx2": 0.8, "avx512": 1.0}
"""Least searches a second over those of `matchTemplate`, TM_CCORR."""
FRAMES_A_SECOND = {"flow": 20.0, "hold": 25.0, "mosaic": 5.0}
ONE_CORE = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"), "1")


def processor() -> str:
    """The processor's name, as Linux has it."""
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "unknown processor"


def fastest(work: Callable[[], object], runs: int = 5) -> float:
    """Least processor time of `work` in seconds."""
    times = []
    for _ in range(runs + 1):
        begun = time.process_time()
        work()
        times.append(time.process_time() - begun)
    return min(times[1:])


def searches(rounds: int = 6, count: int = 100) -> dict[str, float]:
    """Searches a second of `matchTemplate`, as `opencv`, and of each variant of the kernel: the best of rounds in
    which all take turns."""
    cv2.setNumThreads(1)
    ground = floor(SIZE[1], SIZE[0])
    plane = log.sign(ground, SIGMA)
    x, y = (SIZE[0] - WINDOW) // 2, (SIZE[1] - WINDOW) // 2
    template = plane[y:y + WINDOW, x:x + WINDOW] * np.uint8(255)
    searched = plane[y - REACH:y + WINDOW + REACH, x - REACH:x + WINDOW + REACH] * np.uint8(255)
    side = 2 * REACH + 1
    jobs = jobs_table([Job(0, x, y, WINDOW, WINDOW, 0, x - REACH, y - REACH, side, side)] * count)
    packed = {0: pack(plane)}
    works: dict[str, tuple[Callable[[], object], int]] = {
        "opencv": (lambda: cv2.matchTemplate(searched, template, cv2.TM_CCORR), 1)}
    for name, kernel in variants().items():
        works[name] = (lambda kernel=kernel: kernel.search(jobs, packed)), count  # type: ignore[misc]
    found = dict.fromkeys(works, 0.0)
    for _ in range(rounds):
        for name, (work, number) in works.items():
            found[name] = max(found[name], number / fastest(work, runs=max(3, 100 // number)))
    return found


def filters() -> dict[str, float]:
    """Frames of 640x480 a second through the LoG: NumPy's, and each variant's."""
    ground = floor(SIZE[1], SIZE[0])
    found = {NUMPY: 1 / fastest(lambda: log.sign(ground, SIGMA))}
    for name, kernel in variants().items():
        found[name] = 1 / fastest(lambda: kernel.sign(ground, SIGMA, FULL.radius))  # noqa: B023
    return found


def video(path: Path, frames: int, swing: float) -> None:
    """A camera on a circle of `swing` pixels, turning by up to 3 degrees, with noise."""
    ground, rng = floor(1100, 1300), np.random.default_rng(2)
    film = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"mp4v"), 25, SIZE)  # type: ignore[attr-defined]
    for n in range(frames):
        angle = 2 * np.pi * n / 100
        turn = cv2.getRotationMatrix2D((SIZE[0] / 2, SIZE[1] / 2), 3 * np.sin(angle), 1)
        turn[:, 2] -= 320 + swing * np.cos(angle), 300 + swing * np.sin(angle)
        seen = cv2.warpAffine(ground, turn, SIZE, borderMode=cv2.BORDER_REFLECT) + rng.normal(0, 3, SIZE[::-1])
        film.write(cv2.cvtColor(np.clip(seen, 0, 255).astype(np.uint8), cv2.COLOR_GRAY2BGR))
    film.release()


def snapshots(folder: Path, count: int) -> None:
    """Pictures of a survey in lanes of ten, overlapping by 60 % along and 35 % across."""
    folder.mkdir()
    along, across = 256, 312
    ground = floor(SIZE[1] + across * (-(-count // 10) + 1), SIZE[0] + along * 10)
    for n in range(count):
        lane, step = divmod(n, 10)
        x, y = along * (step if lane % 2 == 0 else 9 - step), across * lane
        picture: Image = ground[y:y + SIZE[1], x:x + SIZE[0]]
        write_picture(folder / f"{n:04d}.png", picture)


def command(*words: str) -> float:
    """Processor time of a `signum` command from its start to its end, seconds.

    Raises:
        RuntimeError: if it fails.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, "-m", "signum.commands.cli", *words], env={**os.environ, **ONE_CORE},
                          capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise RuntimeError(f"signum {words[0]} fails: {done.stderr[-1000:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> int:
    """Measure, print, compare with the bars; returns the exit status."""
    parser = argparse.ArgumentParser(description="Speeds of the golden board on one core")
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--snapshots", type=int, default=60)
    args = parser.parse_args()
    print(f"{processor()}; the golden board is {choose()[1]}")
    missed = 0
    found = searches()
    for name, rate in found.items():
        ratio, bar = rate / found["opencv"], OVER_OPENCV.get(name)
        missed += bar is not None and ratio < bar
        print(f"64x64 over +-32, {name}: {rate:,.0f} searches/s, {ratio:.2f} times TM_CCORR"
              + (f" (bar {bar:g})" if bar else ""))
    for name, rate in filters().items():
        print(f"signs of 640x480, {name}: {rate:,.0f} frames/s")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        video(folder / "flow.mp4", args.frames, 250)
        video(folder / "hold.mp4", args.frames, 30)
        snapshots(folder / "survey", args.snapshots)
        calls = {"flow": (args.frames, [str(folder / "flow.mp4")]),
                 "hold": (args.frames, ["--source", str(folder / "hold.mp4")]),
                 "mosaic": (args.snapshots, [str(folder / "survey")])}
        for word, (frames, words) in calls.items():
            seconds = min(command(word, *words, "--out", str(folder / f"{word}{n}")) for n in range(2))
            rate, bar = frames / seconds, FRAMES_A_SECOND[word]
            missed += rate < bar
            print(f"signum {word}: {rate:.1f} frames/s (bar {bar:g}): {frames} of 640x480 in {seconds:.1f} s")
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
