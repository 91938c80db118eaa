# SPDX-License-Identifier: Apache-2.0
"""The abstract class every back end implements; all measurements use it.

A back end (golden model, Verilated RTL, later a real board) implements the underscored methods of `Board`; given the
same calls, every back end returns the same bits. What a caller hands over is checked here, before it reaches a back
end, so that bad calls fail alike on all of them.

Over 400 lines: one class, of which a caller and a back end each read the half that is theirs.

Units: pixels of the board's image, x to the right, y down, (0, 0) the top left pixel; clocks are clocks of the board.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Job, Result
from golden.dense_job import DenseJob, DenseResult, DenseStatus
from golden.params import MAX_SIGMA, MIN_SIGMA, Config
from golden.tables import SLOT_FIELDS, IntTable, check_fields, results_table, table_jobs
from signum.common.arrays import Image

Surface = NDArray[np.int32]
"""Matching bits of every offset of a job, (offsets_y, offsets_x)."""


class BoardError(Exception):
    """The board was asked for something it cannot do, or a capture or read-back failed."""


@dataclass(frozen=True)
class Identification:
    """What a board is; two boards of one configuration differ in `board` alone.

    Attributes:
        board: the back end, `golden` or `verilated`.
        configuration: name of the build.
        version: of the register block, major.minor.
        cameras: their number.
        slots: their number.
        max_image: largest width and height of an image, pixels.
        max_window: largest width and height of a window, pixels.
    """

    board: str
    configuration: str
    version: str
    cameras: int
    slots: int
    max_image: tuple[int, int]
    max_window: int


class Board(ABC):
    """A sign-of-LoG vision board, to be closed after use (or used in a `with`).

    A new board has no image size and no filter: call `configure` before the first capture.
    """

    name: str = ""
    """Back end: `golden` or `verilated`."""

    def __init__(self, config: Config) -> None:
        self._config = config
        self._size = (0, 0)
        self._sigma = 0.0
        self._configurations = 0
        self._usable: dict[int, bool] = {}
        """Whether each slot captured so far holds a frame of the present image size."""
        self._named: deque[tuple[int, frozenset[int]]] = deque()
        """Outstanding results in order: for each run of jobs that name the same slots, their number and those slots."""

    @property
    def config(self) -> Config:
        """The build: largest image and window, slots, cameras."""
        return self._config

    @property
    @abstractmethod
    def identification(self) -> Identification:
        """What the board is.

        Raises:
            BoardError: if it does not answer.
        """

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height, pixels; (0, 0) before `configure`."""
        return self._size

    @property
    def sigma(self) -> float:
        """Width of the LoG's Gaussian, pixels; 0 before `configure`."""
        return self._sigma

    @property
    def configurations(self) -> int:
        """Number of `configure` calls so far: while it stays the same, nobody else has taken over the board."""
        return self._configurations

    @property
    def outstanding(self) -> int:
        """Results submitted for and not yet collected."""
        return sum(count for count, _ in self._named)

    @property
    @abstractmethod
    def clocks(self) -> int:
        """Clocks the board has been at work since it was made: exact on RTL, an estimate on the golden board."""

    def configure(self, size: tuple[int, int], sigma: float) -> None:
        """Choose the image size and the filter of all further captures.

        Slots captured at another size cannot be used until they are captured again; those captured with another sigma
        stay as they are.

        Args:
            size: width and height of a frame, pixels.
            sigma: width of the LoG's Gaussian, pixels, 1 to 4.

        Raises:
            BoardError: if the size is outside the build's smallest and largest image or changes while results are
                outstanding, or if sigma is outside the range or its kernel does not fit the build's radius. The board
                is then as before.
        """
        c = self._config
        width, height = size
        if not (c.min_image <= width <= c.max_width and c.min_image <= height <= c.max_height):
            raise BoardError(f"image size {width}x{height}: this board takes {c.min_image}x{c.min_image} to "
                             f"{c.max_width}x{c.max_height}")
        if not MIN_SIGMA <= sigma <= MAX_SIGMA:
            raise BoardError(f"sigma {sigma:g}: this board takes {MIN_SIGMA:g} to {MAX_SIGMA:g} pixels")
        resized = (width, height) != self._size
        if resized and self._named:
            raise BoardError("collect the outstanding results before changing the image size")
        if resized or sigma != self._sigma:
            try:
                self._configure((width, height), float(sigma))
            except ValueError as error:
                raise BoardError(f"sigma {sigma:g}: {error}") from error
        if resized:
            self._usable = dict.fromkeys(self._usable, False)
        self._size, self._sigma = (width, height), float(sigma)
        self._configurations += 1

    def capture(self, slot: int, frame: Image, camera: int = 0) -> None:
        """Send one frame through a camera's LoG and keep its signs in a slot; returns when the slot is valid.

        A slot that outstanding jobs name keeps its frame: their results must be collected first, also
        those of jobs that the board will refuse. After a failed capture the slot holds no frame and no request is left
        on the board.

        Args:
            slot: 0..config.slots-1.
            frame: uint8 (height, width) of the image size.
            camera: 0..config.cameras-1.

        Raises:
            BoardError: for a wrong slot, camera, shape or dtype, before `configure`, if results of jobs that name the
                slot are outstanding (nothing is sent then), or if the frame was dropped.
        """
        self._capture_all([(camera, slot, frame)])

    def capture_pair(self, slots: tuple[int, int], frames: tuple[Image, Image]) -> None:
        """Send two frames through cameras 0 and 1 at the same time into two different slots; otherwise as `capture`."""
        self._capture_all(self._pair(slots, frames))

    def read_plane(self, slot: int) -> Image:
        """The sign plane of a slot, uint8 (height, width) of 0 and 1, 1 where the LoG response is > 0.

        Raises:
            BoardError: if the slot holds no frame of the present image size.
        """
        if not self._usable.get(slot, False):
            raise BoardError(f"slot {slot} holds no frame of {self._size[0]}x{self._size[1]}")
        return self._read_plane(slot)

    def submit(self, jobs: Sequence[Job]) -> None:
        """Queue correlation jobs. Any number: the host side holds what the board's FIFO has no room for.

        Jobs the board refuses yield a result with their status; nothing is raised for them.

        Raises:
            BoardError: if a job asks for the surface (use `surface`), or names a slot captured at another image size.
        """
        self._check_array()
        for job in jobs:
            self._check_job(job)
        self._submit(jobs)
        for job in jobs:
            self._note(job, 1)

    def submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        """Queue a grid of jobs by one command; `grid(job, count, step)` lists them. Otherwise as `submit`.

        Args:
            job: the first job. The others, in raster order, are its copies with the template and search positions
                advanced and the tag counting up by one.
            count: number of jobs (across, down), 1..1023 each.
            step: pixels (across, down) from one job to the next, 0..1023.

        Raises:
            BoardError: as `submit`, or if a count or a step is outside its range.
        """
        self._check_array()
        self._check_job(job)
        if min(count) < 1 or max(count) > 1023 or min(step) < 0 or max(step) > 1023:
            raise BoardError(f"grid of {count} with steps {step}: counts are 1..1023 and steps 0..1023")
        self._submit_grid(job, count, step)
        self._note(job, count[0] * count[1])

    def collect(self, count: int) -> list[Result]:
        """The next `count` results, in the order of their jobs; waits for them.

        Raises:
            BoardError: if fewer than `count` results are outstanding.
        """
        if count > self.outstanding:
            raise BoardError(f"{count} results wanted, {self.outstanding} outstanding")
        results = self._collect(count)
        while count > 0:
            jobs, slots = self._named.popleft()
            if jobs > count:
                self._named.appendleft((jobs - count, slots))
            count -= jobs
        return results

    def surface(self, job: Job) -> tuple[Result, Surface]:
        """Run one job at once and stream its whole surface.

        Raises:
            BoardError: if the job is refused, or results are outstanding.
        """
        if self._named:
            raise BoardError("collect the outstanding results before asking for a surface")
        self._check_array()
        self._check_slots(job)
        result, surface = self._surface(job)
        if surface is None:
            raise BoardError(f"job refused: {result.status.name}")
        return result, surface

    def dense(self, job: DenseJob) -> DenseResult:
        """Run a pass of the dense engine at once: the winner of its offsets around every pixel that the step leaves.

        Args:
            job: what is searched for, and what counts as valid; see `golden.dense` for the windows' places.

        Returns:
            Arrays (ceil(height / step_y), ceil(width / step_x)), counts in mismatches.

        Raises:
            BoardError: if this build has no dense engine, nothing was configured, a slot was captured at another image
                size, or the board refuses the job.
        """
        self._check_engine()
        self._check_configured()
        for slot in (job.left, job.right):
            self._check_slot(slot)
        return self._answer(*self._dense(job))

    def capture_dense(self, job: DenseJob, frames: tuple[Image, Image]) -> DenseResult:
        """Capture a pair and run a pass over it at once: as `capture_pair` and `dense`, but the pass is live.

        Camera 0 captures into the job's left slot and camera 1 into its right one, and each row is searched when both
        cameras' rows that it needs have arrived. So the map ends little after the frames, not a pass later.

        Args:
            job: as of `dense`, with two different slots; it is run as a live one, whatever its `live` says.
            frames: of cameras 0 and 1, uint8 (height, width) of the image size.

        Returns:
            As `dense`.

        Raises:
            BoardError: as `capture_pair` and `dense`. Where the board refuses the job, the frames are captured.
        """
        self._check_engine()
        self._check_captures(self._pair((job.left, job.right), frames))
        answer = self._capture_dense(replace(job, live=True), frames)
        for slot in (job.left, job.right):
            self._usable[slot] = True
        return self._answer(*answer)

    @abstractmethod
    def counters(self) -> dict[str, int]:
        """Counts since the board was made: `frames_0`, `drops_0` (one pair a camera: good and dropped frames), `jobs`
        (done, without the refused), `refused`, `scores` (of windows), `busy_clocks` (with a job in work), `clocks`.

        Clocks are an estimate on the golden board; hardware counts modulo 2**32; the rest is the same on every board.
        """

    def close(self) -> None:
        """Release the back end; the board is of no use afterwards."""
        self._usable.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    # ------------------------------------------------------------------------------------------------------ checks
    def _check_engine(self) -> None:
        if not self._config.dense_offsets:
            raise BoardError("this board has no dense engine: use the configuration dense")

    def _check_configured(self) -> None:
        if not self._configurations:
            raise BoardError("choose image size and filter with configure() before the first capture")

    @staticmethod
    def _answer(status: DenseStatus, result: DenseResult | None) -> DenseResult:
        if result is None:
            raise BoardError(f"dense job refused: {status.name}")
        return result

    @staticmethod
    def _pair(slots: Sequence[int], frames: Sequence[Image]) -> list[tuple[int, int, Image]]:
        """A capture (camera, slot, frame) of each of two cameras."""
        if len(slots) != 2 or len(frames) != 2:
            raise BoardError(f"a pair is two slots and two frames: {len(slots)} and {len(frames)} given")
        if slots[0] == slots[1]:
            raise BoardError("a pair needs two different slots")
        return list(zip((0, 1), slots, frames, strict=True))

    def _capture_all(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        self._check_captures(frames)
        self._capture(frames)
        for _, slot, _ in frames:
            self._usable[slot] = True

    def _check_captures(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        """Check captures (camera, slot, frame) before they begin; their slots hold nothing from now on."""
        for camera, slot, frame in frames:
            self._check_capture(slot, frame, camera)
        for slot in sorted(slot for _, slot, _ in frames):
            if any(slot in slots for _, slots in self._named):
                raise BoardError(f"slot {slot} is named by jobs whose results are not collected: collect them first")
        for _, slot, _ in frames:
            self._usable.pop(slot, None)

    def _check_capture(self, slot: int, frame: Image, camera: int) -> None:
        self._check_configured()
        if not all(isinstance(number, (int, np.integer)) for number in (slot, camera)):
            raise BoardError(f"slot {slot!r} of camera {camera!r}: both must be whole numbers")
        if not 0 <= slot < self._config.slots:
            raise BoardError(f"slot {slot}: this board has slots 0 to {self._config.slots - 1}")
        if not 0 <= camera < self._config.cameras:
            raise BoardError(f"camera {camera}: this board has {self._config.cameras}")
        if frame.dtype != np.uint8 or frame.shape != self._size[::-1]:
            raise BoardError(f"frame is {frame.dtype} {frame.shape}: expected uint8 {self._size[::-1]}")

    def _check_array(self) -> None:
        if not self._config.array:
            raise BoardError("this board has no array for single windows: use the configuration full")

    def _note(self, job: Job, count: int) -> None:
        """Add `count` jobs with the slots of `job` to the outstanding ones."""
        slots = frozenset((job.tpl_slot, job.search_slot))
        if self._named and self._named[-1][1] == slots:
            count += self._named.pop()[0]
        self._named.append((count, slots))

    def _check_job(self, job: Job) -> None:
        if job.surface:
            raise BoardError("surface jobs go through surface()")
        self._check_slots(job)

    def _check_slots(self, job: Job) -> None:
        for slot in (job.tpl_slot, job.search_slot):
            self._check_slot(slot)

    def _check_slot(self, slot: int) -> None:
        if not self._usable.get(slot, True):
            raise BoardError(f"slot {slot} was captured at another image size")

    # ------------------------------------------------------------------------------------ what a back end implements
    @abstractmethod
    def _configure(self, size: tuple[int, int], sigma: float) -> None:
        """Change size and filter; a changed size makes every slot invalid.

        Raises:
            ValueError: if the kernel of sigma does not fit the build; nothing is changed then.
        """

    @abstractmethod
    def _capture(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        """Capture (camera, slot, frame) at the same time."""

    @abstractmethod
    def _read_plane(self, slot: int) -> Image: ...

    @abstractmethod
    def _submit(self, jobs: Sequence[Job]) -> None: ...

    @abstractmethod
    def _submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None: ...

    @abstractmethod
    def _collect(self, count: int) -> list[Result]: ...

    @abstractmethod
    def _surface(self, job: Job) -> tuple[Result, Surface | None]:
        """A job's result and surface; no surface where the job is refused."""

    @abstractmethod
    def _dense(self, job: DenseJob) -> tuple[DenseStatus, DenseResult | None]:
        """The status of a job of the dense engine, which the build has, and its winners where that is OK."""

    def _capture_dense(self, job: DenseJob, frames: tuple[Image, Image]) -> tuple[DenseStatus, DenseResult | None]:
        """Capture the frames of cameras 0 and 1 into the live job's slots, and answer as `_dense`."""
        self._capture([(0, job.left, frames[0]), (1, job.right, frames[1])])
        return self._dense(job)

    def _run_table(self, jobs: IntTable) -> IntTable:
        """Results of a table of jobs, while no others are outstanding."""
        self._submit(table_jobs(jobs))
        return results_table(self._collect(len(jobs)))


def run_table(board: Board, jobs: IntTable) -> IntTable:
    """Results of a table of jobs (columns `golden.tables.JOB_FIELDS`), columns `golden.tables.RESULT_FIELDS`: as
    `run_jobs`, without an object for each of many jobs.

    Raises:
        ValueError: if a number does not fit its register.
        BoardError: if a job names a slot captured at another image size, or results are outstanding.
    """
    if board.outstanding:
        raise BoardError("collect the outstanding results before running a table of jobs")
    board._check_array()
    check_fields(jobs)
    for slot in np.unique(jobs[:, SLOT_FIELDS]).tolist():
        board._check_slot(slot)
    return board._run_table(jobs)


def run_jobs(board: Board, jobs: Sequence[Job]) -> list[Result]:
    """Submit jobs and collect their results, in order."""
    board.submit(jobs)
    return board.collect(len(jobs))
