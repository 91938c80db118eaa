# SPDX-License-Identifier: Apache-2.0
"""One-clock resets of the Verilated `tiny` board at any clock of its work: `python -m sim.board.tests.resets` for all.

The work is a frame on each camera, captured, and jobs with a surface. After the reset a new filter, a capture on both
cameras and a job must complete with the frame level's results, while the rest of the interrupted frames still arrives.
"""

from __future__ import annotations

import time
from collections.abc import Iterable

import numpy as np

from golden import log
from golden.correlate import Job, run, surface
from golden.params import TINY
from sim.board.device import Device

SIZE = 18, 19
"""Width and height of the frames."""
WORK = SIZE[0] * (SIZE[1] + TINY.radius) + 260
"""Clocks from the first pixel until the frames are captured and the jobs done."""
FIRST_ROW = SIZE[0] * (TINY.radius + 1)
"""Clocks from the first pixel until a frame's first output row starts, nearly."""
JOBS = [Job(0, 1, 2, 6, 5, 1, 0, 1, 9, 7, tag, surface=tag == 1) for tag in range(3)]
SIGMAS = 1.5, 2.0


def sweep(device: Device, moments: Iterable[int], clocks: int = 1) -> int:
    """Reset for `clocks` clocks at each of the moments, in clocks from the frames' start; returns their number.

    Raises:
        AssertionError: naming the moment after which a plane, result or surface is wrong.
        DeviceTimeout: if the board hangs.
    """
    source = np.random.default_rng(15)
    frames = {camera: source.integers(0, 256, SIZE[::-1], dtype=np.uint8) for camera in range(TINY.cameras)}
    planes = {sigma: {camera: log.sign(frame, sigma, TINY.radius) for camera, frame in frames.items()}
              for sigma in SIGMAS}
    device.reset()
    _check(device, frames, planes[SIGMAS[0]], SIGMAS[0], "before the first reset")
    count = 0
    for count, moment in enumerate(moments, 1):
        for camera in frames:
            device.arm(2 + camera, camera)
        device.submit(JOBS)
        for camera, frame in frames.items():
            device.play(frame, camera)
        device.tick(moment)
        device.restart(clocks)
        sigma = SIGMAS[count % 2]
        _check(device, frames, planes[sigma], sigma, f"after a reset in clock {moment}")
    return count


def _check(device: Device, frames: dict[int, log.Image], planes: dict[int, log.Image], sigma: float, when: str) -> None:
    """A filter change, captures on both cameras, and a job with its surface."""
    device.finish_playing()
    device.set_filter(*log.kernels(sigma, TINY.radius), SIZE)
    device.capture({camera: camera for camera in frames}, frames)
    job = JOBS[1]
    (result,) = device.run([job])
    want = surface(planes[job.tpl_slot], planes[job.search_slot], job)
    assert result == run(job, planes, TINY, SIZE), f"result {when}"
    assert np.array_equal(device.surface(want.size), want.flatten()), f"surface {when}"
    for camera, plane in planes.items():
        assert np.array_equal(device.plane(camera), plane), f"plane of camera {camera} {when}"
    assert device.stream_waiting == 0 and device.outstanding == 0, when


def main() -> int:
    """Sweep every clock, with one-clock and two-clock resets; returns the exit status."""
    with Device("tiny") as device:
        for clocks in (1, 2):
            begun = time.monotonic()
            print(f"{sweep(device, range(WORK), clocks)} resets of {clocks} clock(s): "
                  f"{time.monotonic() - begun:.0f} s")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
