"""The Board interface: the one door through which measurements reach a sign-of-LoG board.

A back end (golden model, Verilated RTL, later a real board) implements `Board`; given the same calls, every back end
returns the same bits. `BoardBase` holds what all of them share: the checks of what a caller hands over, so that bad
calls fail alike everywhere.

Units: pixels of the board's image, x to the right, y down, (0, 0) the top left pixel; clocks are clocks of the board.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from types import TracebackType
from typing import Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from golden.correlate import Job, Result
from golden.params import Config
from signum.common.arrays import Image

Surface = NDArray[np.int32]

MIN_SIGMA, MAX_SIGMA = 1.0, 4.0
"""Pixels: the range every board's LoG is specified for."""


class BoardError(Exception):
    """The board was asked for something it cannot do, or a capture or read-back failed."""


@runtime_checkable
class Board(Protocol):
    """A sign-of-LoG vision board.

    A new board has no filter and no image size: call `set_image_size` and `set_filter` before the first capture.
    """

    @property
    def name(self) -> str:
        """Back end: `golden` or `verilated`."""

    @property
    def config(self) -> Config:
        """The build: largest image and window, slots, cameras."""

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height, pixels; (0, 0) before `set_image_size`."""

    @property
    def sigma(self) -> float:
        """Width of the LoG's Gaussian, pixels; 0 before `set_filter`."""

    @property
    def clocks(self) -> int:
        """Clocks the board has been at work since it was made: exact on RTL, an estimate on the golden board."""

    def set_image_size(self, width: int, height: int) -> None:
        """Choose the size of all further frames. Slots captured at another size cannot be used until captured again.

        Raises:
            BoardError: if the size is outside the build's smallest and largest image, or results are outstanding.
        """

    def set_filter(self, sigma: float) -> None:
        """Choose the LoG's sigma for all further captures, pixels, MIN_SIGMA..MAX_SIGMA. Captured slots stay as they
        are.

        Raises:
            BoardError: if sigma is outside the range, or so large that the kernel does not fit the build's radius.
        """

    def capture(self, slot: int, frame: Image, camera: int = 0) -> None:
        """Send one frame through a camera's LoG and keep its signs in a slot; returns when the slot is valid.

        Args:
            slot: 0..config.slots-1.
            frame: uint8 (height, width) of the image size.
            camera: 0..config.cameras-1.

        Raises:
            BoardError: for a wrong slot, camera, shape or dtype, before filter and size are set, or if the frame was
            dropped.
        """

    def capture_pair(self, slots: tuple[int, int], frames: tuple[Image, Image]) -> None:
        """Send two frames through cameras 0 and 1 at the same time into two different slots; otherwise as `capture`."""

    def read_plane(self, slot: int) -> Image:
        """The sign plane of a slot, uint8 (height, width) of 0 and 1, 1 where the LoG response is > 0.

        Raises:
            BoardError: if the slot holds no frame of the present image size.
        """

    def submit(self, jobs: Sequence[Job]) -> None:
        """Queue correlation jobs. Any number: the host side holds what the board's FIFO has no room for.

        Jobs the board refuses yield a result with their status; nothing is raised for them.

        Raises:
            BoardError: if a job asks for the surface (use `surface`), or names a slot captured at another image size.
        """

    def submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        """Queue a grid of jobs by one command: count (across, down) copies of `job`, in raster order, the template and
        search positions advanced by `step` (across, down) pixels, the tag counting up by one. Otherwise as `submit`."""

    def collect(self, count: int) -> list[Result]:
        """The next `count` results, in the order of their jobs; waits for them.

        Raises:
            BoardError: if fewer than `count` results are outstanding.
        """

    @property
    def outstanding(self) -> int:
        """Results submitted for and not yet collected."""

    def surface(self, job: Job) -> tuple[Result, Surface]:
        """Run one job at once and stream its whole surface: matching bits, int32 (offsets_y, offsets_x).

        Raises:
            BoardError: if the job is refused, or results are outstanding.
        """

    def counters(self) -> dict[str, int]:
        """Counts since the board was made: `frames_0`, `drops_0` (one pair a camera: good and dropped frames), `jobs`
        (done, without the refused), `refused`, `scores` (of windows), `busy_clocks` (with a job in work), `clocks`.

        Clocks are an estimate on the golden board; hardware counts modulo 2**32; the rest is the same on every board.
        """

    def close(self) -> None:
        """Release the back end; the board is of no use afterwards."""


def run_jobs(board: Board, jobs: Sequence[Job]) -> list[Result]:
    """Submit jobs and collect their results, in order."""
    board.submit(jobs)
    return board.collect(len(jobs))


class BoardBase(ABC):
    """Checks and bookkeeping common to the back ends, which implement the underscored methods."""

    name: str = ""

    def __init__(self, config: Config) -> None:
        self._config = config
        self._size = (0, 0)
        self._sigma = 0.0
        self._slot_size: dict[int, tuple[int, int]] = {}
        self._outstanding = 0

    @property
    def config(self) -> Config:
        """The build."""
        return self._config

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height; (0, 0) before `set_image_size`."""
        return self._size

    @property
    def sigma(self) -> float:
        """Sigma, pixels; 0 before `set_filter`."""
        return self._sigma

    @property
    def outstanding(self) -> int:
        """Results submitted for and not yet collected."""
        return self._outstanding

    def set_image_size(self, width: int, height: int) -> None:
        """See `Board.set_image_size`."""
        c = self._config
        if not (c.min_image <= width <= c.max_width and c.min_image <= height <= c.max_height):
            raise BoardError(f"image size {width}x{height}: this board takes {c.min_image}x{c.min_image} to "
                             f"{c.max_width}x{c.max_height}")
        if self._outstanding:
            raise BoardError("collect the outstanding results before changing the image size")
        if (width, height) != self._size:
            self._apply_size(width, height)
            self._size = (width, height)

    def set_filter(self, sigma: float) -> None:
        """See `Board.set_filter`."""
        if not MIN_SIGMA <= sigma <= MAX_SIGMA:
            raise BoardError(f"sigma {sigma:g}: this board takes {MIN_SIGMA:g} to {MAX_SIGMA:g} pixels")
        if sigma != self._sigma:
            try:
                self._apply_sigma(float(sigma))
            except ValueError as error:
                raise BoardError(f"sigma {sigma:g}: {error}") from error
            self._sigma = float(sigma)

    def capture(self, slot: int, frame: Image, camera: int = 0) -> None:
        """See `Board.capture`."""
        self._check_capture(slot, frame, camera)
        self._slot_size.pop(slot, None)
        self._capture([(camera, slot, frame)])
        self._slot_size[slot] = self._size

    def capture_pair(self, slots: tuple[int, int], frames: tuple[Image, Image]) -> None:
        """See `Board.capture_pair`."""
        if slots[0] == slots[1]:
            raise BoardError("a pair needs two different slots")
        for camera in (0, 1):
            self._check_capture(slots[camera], frames[camera], camera)
        for slot in slots:
            self._slot_size.pop(slot, None)
        self._capture([(camera, slots[camera], frames[camera]) for camera in (0, 1)])
        for slot in slots:
            self._slot_size[slot] = self._size

    def read_plane(self, slot: int) -> Image:
        """See `Board.read_plane`."""
        if self._slot_size.get(slot) != self._size:
            raise BoardError(f"slot {slot} holds no frame of {self._size[0]}x{self._size[1]}")
        return self._read_plane(slot)

    def submit(self, jobs: Sequence[Job]) -> None:
        """See `Board.submit`."""
        for job in jobs:
            self._check_job(job)
        self._submit(jobs)
        self._outstanding += len(jobs)

    def submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        """See `Board.submit_grid`."""
        self._check_job(job)
        if min(count) < 1 or max(count) > 1023 or min(step) < 0 or max(step) > 1023:
            raise BoardError(f"grid of {count} with steps {step}: counts are 1..1023 and steps 0..1023")
        self._submit_grid(job, count, step)
        self._outstanding += count[0] * count[1]

    def collect(self, count: int) -> list[Result]:
        """See `Board.collect`."""
        if count > self._outstanding:
            raise BoardError(f"{count} results wanted, {self._outstanding} outstanding")
        results = self._collect(count)
        self._outstanding -= count
        return results

    def surface(self, job: Job) -> tuple[Result, Surface]:
        """See `Board.surface`."""
        if self._outstanding:
            raise BoardError("collect the outstanding results before asking for a surface")
        self._check_slots(job)
        result, surface = self._surface(job)
        if surface is None:
            raise BoardError(f"job refused: {result.status.name}")
        return result, surface

    def close(self) -> None:
        """See `Board.close`."""
        self._slot_size.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _check_capture(self, slot: int, frame: Image, camera: int) -> None:
        if self._size == (0, 0) or not self._sigma:
            raise BoardError("set the image size and the filter before the first capture")
        if not 0 <= slot < self._config.slots:
            raise BoardError(f"slot {slot}: this board has slots 0 to {self._config.slots - 1}")
        if not 0 <= camera < self._config.cameras:
            raise BoardError(f"camera {camera}: this board has {self._config.cameras}")
        if frame.dtype != np.uint8 or frame.shape != self._size[::-1]:
            raise BoardError(f"frame is {frame.dtype} {frame.shape}: expected uint8 {self._size[::-1]}")

    def _check_job(self, job: Job) -> None:
        if job.surface:
            raise BoardError("surface jobs go through surface()")
        self._check_slots(job)

    def _check_slots(self, job: Job) -> None:
        for slot in (job.tpl_slot, job.search_slot):
            if self._slot_size.get(slot, self._size) != self._size:
                raise BoardError(f"slot {slot} was captured at another image size")

    @property
    @abstractmethod
    def clocks(self) -> int:
        """Clocks at work."""

    @abstractmethod
    def counters(self) -> dict[str, int]:
        """See `Board.counters`."""

    @abstractmethod
    def _apply_size(self, width: int, height: int) -> None: ...

    @abstractmethod
    def _apply_sigma(self, sigma: float) -> None: ...

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
    def _surface(self, job: Job) -> tuple[Result, Surface | None]: ...
