# SPDX-License-Identifier: Apache-2.0
"""The golden board: the frame-level golden model behind the Board interface.

Results are those of the RTL, bit for bit. Clocks are an estimate of what the RTL needs for the same call:

- capture: one clock a pixel and `radius` rows of flush, for one or two cameras alike;
- job: rows of offsets x passes a row x clocks a pass. A pass scores `pitch` offsets (the last one up to `lanes`) and
  lasts max(steps, offsets of the pass) clocks; a step takes two window rows, or one of a window wider than a group.
  Operands load at one store word a clock while the previous job is scored, so a job lasts at least as long as its words
  take to load;
- register accesses are not counted.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from golden import correlate, log
from golden.correlate import Job, Result, Status
from golden.params import FULL, Config
from signum.boards.board import Board, Identification, Surface
from signum.common.arrays import Image

PIPELINE_CLOCKS = 64
"""Clocks from the last pixel of a flushed frame to a valid slot: about the depth of the LoG pipeline."""
REGISTER_VERSION = "1.1"
"""Version of the register block whose board this model computes (`rtl/control/slog_csr.rdl`)."""


def job_clocks(job: Job, config: Config) -> int:
    """Estimated clocks one accepted job occupies the array, with a full queue."""
    steps = job.height if job.width > config.group_bits else -(-job.height // 2)
    passes = max(1, -(-(job.offsets_x - 1) // config.pitch))
    last = job.offsets_x - (passes - 1) * config.pitch
    row = (passes - 1) * max(steps, config.pitch) + max(steps, last)
    words = -(-(job.width + job.offsets_x - 1) // config.group_bits) + 1
    load = words * (job.height + job.offsets_y - 1) + (-(-job.width // config.group_bits) + 1) * job.height
    return max(row * job.offsets_y, load)


class GoldenBoard(Board):
    """A board computed with NumPy and OpenCV integers; `config` is the build whose results it gives."""

    name = "golden"

    def __init__(self, config: Config = FULL) -> None:
        super().__init__(config)
        self._planes: list[Image | None] = [None] * config.slots
        self._results: deque[Result] = deque()
        self._clocks = 0
        self._counts = {key: 0 for camera in range(config.cameras) for key in (f"frames_{camera}", f"drops_{camera}")}
        self._counts |= {"jobs": 0, "refused": 0, "scores": 0, "busy_clocks": 0}

    @property
    def identification(self) -> Identification:
        c = self.config
        return Identification(self.name, c.name, REGISTER_VERSION, c.cameras, c.slots, (c.max_width, c.max_height),
                              c.max_window)

    @property
    def clocks(self) -> int:
        return self._clocks

    def counters(self) -> dict[str, int]:
        return self._counts | {"clocks": self._clocks}

    def _configure(self, size: tuple[int, int], sigma: float) -> None:
        log.kernels(sigma, self.config.radius)  # raises where the kernel does not fit
        if size != self.image_size:
            self._planes = [None] * self.config.slots

    def _capture(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        for camera, slot, frame in frames:
            self._planes[slot] = log.sign(frame, self.sigma, self.config.radius)
            self._counts[f"frames_{camera}"] += 1
        width, height = self.image_size
        self._clocks += width * (height + self.config.radius) + PIPELINE_CLOCKS

    def _read_plane(self, slot: int) -> Image:
        plane = self._planes[slot]
        assert plane is not None
        return plane.copy()

    def _submit(self, jobs: Sequence[Job]) -> None:
        for job in jobs:
            self._results.append(self._run(job)[0])

    def _submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        self._submit(correlate.grid(job, count, step))

    def _collect(self, count: int) -> list[Result]:
        return [self._results.popleft() for _ in range(count)]

    def _surface(self, job: Job) -> tuple[Result, Surface | None]:
        return self._run(job)

    def _run(self, job: Job) -> tuple[Result, Surface | None]:
        status = correlate.check(job, self.config, self.image_size, [plane is not None for plane in self._planes])
        if status is not Status.OK:
            self._counts["refused"] += 1
            return Result(job.tag, status), None
        template, search = self._planes[job.tpl_slot], self._planes[job.search_slot]
        assert template is not None and search is not None
        surface = correlate.surface(template, search, job)
        clocks = job_clocks(job, self.config)
        self._clocks += clocks
        self._counts["jobs"] += 1
        self._counts["busy_clocks"] += clocks
        self._counts["scores"] += surface.size
        return Result(job.tag, status, *correlate.peak(surface)), surface
