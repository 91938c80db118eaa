# SPDX-License-Identifier: Apache-2.0
"""The golden board: the frame-level golden model behind the Board interface.

Results are those of the RTL, bit for bit. Clocks are an estimate of what the RTL needs for the same call:

- capture: one clock a pixel and `radius` rows of flush, for one or two cameras alike;
- job: rows of offsets x passes a row x clocks a pass. A pass scores `pitch` offsets (the last one up to `lanes`) and
  lasts max(steps, offsets of the pass) clocks; a step takes two window rows, or one of a window wider than a group.
  Operands load at one store word a clock while the previous job is scored, so a job lasts at least as long as its words
  take to load;
- pass of the dense engine: the rows up to the last one that is answered, see `dense_clocks`; one that is live with its
  capture: these and the `radius` rows before a camera's first one is in the store;
- register accesses are not counted.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict, deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from golden import correlate, log
from golden.compiled.calls import Kernel, Packed, choose, unpack
from golden.correlate import Job, Result, Status
from golden.dense_job import DenseJob, DenseResult, DenseStatus, check_job, run_dense
from golden.params import FULL, Config
from golden.tables import (
    JOB_FIELDS,
    IntTable,
    check_table,
    jobs_table,
    refused_table,
    results_table,
    table_jobs,
    table_results,
)
from signum.boards.board import Board, BoardError, Identification, Surface
from signum.common.arrays import Image

PIPELINE_CLOCKS = 64
"""Clocks from the last pixel of a flushed frame to a valid slot: about the depth of the LoG pipeline."""
SEEN = 64
"""Planes of the latest frames that are kept, 40 kB each."""
REGISTER_VERSION = "1.1"
"""Version of the register block whose board this model computes (`rtl/control/slog_csr.rdl`)."""


def job_clocks(jobs: IntTable, config: Config) -> NDArray[np.int64]:
    """Estimated clocks that each accepted job of a table occupies the array, with a full queue; (n,)."""
    width, height, nx, ny = (jobs[:, JOB_FIELDS.index(name)].astype(np.int64)
                             for name in ("width", "height", "offsets_x", "offsets_y"))
    steps = np.where(width > config.group_bits, height, -(-height // 2))
    passes = np.maximum(1, -(-(nx - 1) // config.pitch))
    last = nx - (passes - 1) * config.pitch
    row = (passes - 1) * np.maximum(steps, config.pitch) + np.maximum(steps, last)
    words = -(-(width + nx - 1) // config.group_bits) + 1
    load = words * (height + ny - 1) + (-(-width // config.group_bits) + 1) * height
    return np.asarray(np.maximum(row * ny, load), np.int64)


def dense_clocks(job: DenseJob, config: Config, size: tuple[int, int]) -> int:
    """Estimated clocks of an accepted pass over planes of `size` (width, height): its rows, and the engine's depth."""
    (width, height), step = size, job.step[1]
    rows = (-(-height // step) - 1) * step + 1
    pitch = max(width + 2 * config.dense_lanes + 1, config.dense_offsets + config.group_bits + 8)
    return rows * pitch + 4 * config.dense_offsets + PIPELINE_CLOCKS


class GoldenBoard(Board):
    """A board computed on this machine, by the compiled kernel or, where it cannot be had, with NumPy and OpenCV; the
    bits are the same. `config` is the build whose results it gives.

    Raises:
        BoardError: if the environment's `SIGNUM_KERNEL` asks for a kernel that there is not.
    """

    name = "golden"

    def __init__(self, config: Config = FULL) -> None:
        super().__init__(config)
        try:
            kernel, arithmetic = choose()
        except ValueError as error:
            raise BoardError(str(error)) from error
        self._kernel = kernel
        self.arithmetic = arithmetic
        """What computes: the compiled kernel's variant, or NumPy and why."""
        self._planes: dict[int, Image] = {}
        self._packed: dict[int, Packed] = {}
        self._seen: OrderedDict[tuple[bytes, tuple[int, ...], float], Packed] = OrderedDict()
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
            self._planes.clear()
            self._packed.clear()

    def _capture(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        for camera, slot, frame in frames:
            if self._kernel:
                self._packed[slot] = self._signs(self._kernel, frame)
            else:
                self._planes[slot] = log.sign(frame, self.sigma, self.config.radius)
            self._counts[f"frames_{camera}"] += 1
        width, height = self.image_size
        self._clocks += width * (height + self.config.radius) + PIPELINE_CLOCKS

    def _signs(self, kernel: Kernel, frame: Image) -> Packed:
        """The packed signs of a frame: a survey shows the same frames again and again."""
        key = hashlib.sha256(np.ascontiguousarray(frame).data).digest(), frame.shape, self.sigma
        plane = self._seen.pop(key, None)
        if plane is None:
            plane = kernel.sign(frame, self.sigma, self.config.radius)
        self._seen[key] = plane
        if len(self._seen) > SEEN:
            self._seen.popitem(last=False)
        return plane

    def _read_plane(self, slot: int) -> Image:
        return unpack(self._packed[slot], self.image_size[0]) if self._kernel else self._planes[slot].copy()

    def _submit(self, jobs: Sequence[Job]) -> None:
        self._results += table_results(self._run_table(jobs_table(jobs)), [job.tag for job in jobs])

    def _submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        self._submit(correlate.grid(job, count, step))

    def _collect(self, count: int) -> list[Result]:
        return [self._results.popleft() for _ in range(count)]

    def _surface(self, job: Job) -> tuple[Result, Surface | None]:
        table = jobs_table([job])
        status = self._check(table)[0]
        if status != Status.OK:
            return Result(job.tag, Status(status)), None
        if not self._kernel:
            surface = correlate.surface(self._planes[job.tpl_slot], self._planes[job.search_slot], job)
            return Result(job.tag, Status.OK, *correlate.peak(surface)), surface
        found, surface = self._kernel.surface(table, self._packed)
        return table_results(found, [job.tag])[0], surface

    def _dense(self, job: DenseJob) -> tuple[DenseStatus, DenseResult | None]:
        status = check_job(job, self.config, self.image_size, self._packed if self._kernel else self._planes)
        if status is not DenseStatus.OK:
            return status, None
        clocks = dense_clocks(job, self.config, self.image_size)
        self._clocks += clocks
        self._counts["busy_clocks"] += clocks
        if not self._kernel:
            return run_dense(job, self._planes, self.config, self.image_size)
        return status, self._kernel.dense(self._packed[job.left], self._packed[job.right], self.image_size[0], job)

    def _capture_dense(self, job: DenseJob, frames: tuple[Image, Image]) -> tuple[DenseStatus, DenseResult | None]:
        before = self._clocks
        self._capture([(0, job.left, frames[0]), (1, job.right, frames[1])])
        captured = self._clocks
        answer = self._dense(job)
        if answer[1] is not None:
            ahead = self.image_size[0] * self.config.radius
            self._clocks += ahead + before - captured
            self._counts["busy_clocks"] += ahead
        return answer

    def _run_table(self, jobs: IntTable) -> IntTable:
        status = self._check(jobs)
        good = status == Status.OK
        table = refused_table(len(jobs))
        table[:, 0] = status
        if self._kernel:
            table[good] = self._kernel.search(jobs[good], self._packed)
        else:
            table[good] = results_table([correlate.run(job, self._planes, self.config, self.image_size)
                                         for job in table_jobs(jobs[good])])
        return table

    def _check(self, jobs: IntTable) -> NDArray[np.int64]:
        """Statuses of jobs, which are counted with the clocks that they take."""
        held = self._packed if self._kernel else self._planes
        status = check_table(jobs, self.config, self.image_size, [slot in held for slot in range(self.config.slots)])
        good = jobs[status == Status.OK]
        clocks = int(job_clocks(good, self.config).sum())
        self._clocks += clocks
        self._counts["jobs"] += len(good)
        self._counts["refused"] += len(jobs) - len(good)
        self._counts["busy_clocks"] += clocks
        self._counts["scores"] += int((good[:, -2:].astype(np.int64).prod(axis=1)).sum())
        return status
