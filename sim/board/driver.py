# SPDX-License-Identifier: Apache-2.0
"""The board's registers from Python: what `driver.hpp` does on any bus, with errors raised as exceptions."""

from __future__ import annotations

import ctypes
import warnings
from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from golden.correlate import Job, Result
from golden.log import Image
from golden.params import Config
from sim.board.library import TIMEOUT
from sim.board.structs import RESULT_DTYPE, pack_jobs, unpack_results
from sim.registers.map import address, field, fields, word

FRAME_CLOCKS = 8
"""Clocks allowed per pixel of a frame before a capture counts as lost."""
SLACK = 100_000
"""Clocks allowed for anything besides."""


class DeviceError(RuntimeError):
    """The board did not do what it was asked to."""


class DeviceTimeout(DeviceError):
    """The board did not finish within the clocks allowed."""


class UnfinishedFrame(UserWarning):
    """A frame did not end in time, and the board dropped it."""


class RegisterDriver:
    """A board of a configuration, by its registers. `size` is the present image size (width, height).

    Timeouts are in clocks where the bus counts them, else in accesses while waiting.

    Args:
        config: configuration of the board.
        library: a library of this folder.
        driver: the driver in it, from `slog_driver`.
    """

    def __init__(self, config: Config, library: ctypes.CDLL, driver: int) -> None:
        self.config = config
        self.size = (config.max_width, config.max_height)
        self._lib = library
        self._driver = driver

    def close(self) -> None:
        """Free what the driver holds."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    # ------------------------------------------------------------------------------------------------------ registers
    def read_word(self, where: int) -> int:
        """The register at a byte address."""
        value: int = self._lib.slog_read(self._driver, where)
        self._check("register read")
        return value

    def write_word(self, where: int, value: int) -> None:
        """Write the register at a byte address."""
        self._lib.slog_write(self._driver, where, value)
        self._check("register write")

    def read(self, path: str) -> int:
        """A register field by path, such as `slot_status.valid`."""
        place = field(path)
        return place.unpack(self.read_word(place.address))

    def write(self, register: str, **values: int) -> None:
        """Write a register; fields not named become 0."""
        self.write_word(address(register), word(register, **values))

    def counters(self) -> dict[str, int]:
        """The board's counters, each modulo 2**32, by register name."""
        where = {place.address: name for name, place in fields().items() if name.startswith("counter.")}
        values = np.zeros(len(where), np.uint32)
        count = self._lib.slog_counters(self._driver, values.ctypes.data)
        self._check("reading the counters")
        assert count == len(where)
        names = [where[at].removeprefix("counter.").removesuffix(".value") for at in sorted(where)]
        return dict(zip(names, values.tolist(), strict=True))

    # --------------------------------------------------------------------------------------------------------- frames
    def set_filter(self, g: Sequence[int] | npt.NDArray[np.integer], g2: Sequence[int] | npt.NDArray[np.integer],
                   size: tuple[int, int] | None = None) -> None:
        """Change coefficients and, if given, the image size (width, height); waits until frames under way are through.

        A frame that does not end in time is dropped, with a warning: its camera may have been unplugged.

        Args:
            g: smoothing kernel, centre first: `config.coefs` signed integers of 18 bits.
            g2: its second derivative.
            size: a changed size makes every slot invalid.

        Raises:
            DeviceError: if the size is outside the board's limits.
            DeviceTimeout: if the board stays busy without a frame.
        """
        kernels = [np.ascontiguousarray(k, np.int32) for k in (g, g2)]
        if any(len(k) != self.config.coefs for k in kernels):
            raise ValueError(f"kernels need {self.config.coefs} coefficients")
        width, height = size or self.size
        code = self._lib.slog_set_filter(self._driver, kernels[0].ctypes.data, kernels[1].ctypes.data,
                                         self.config.coefs, width, height, self._frame_clocks())
        if code == TIMEOUT and not self._lib.slog_failed(self._driver):
            unfinished = self.abort_frames()
            code = self._lib.slog_wait_filter(self._driver, self._frame_clocks())
            if code != TIMEOUT and unfinished:
                named = " and ".join(map(str, unfinished))
                warnings.warn(f"a frame of camera {named} did not end: dropped, so that the filter could change",
                              UnfinishedFrame, stacklevel=2)
        self._check("filter change", code)
        if self.read("filter.size_error"):
            raise DeviceError(f"the board refuses images of {width}x{height}")
        self.size = (width, height)

    def abort_frames(self) -> list[int]:
        """Drop the frames that the board is receiving; returns the cameras that had a frame in progress.

        A dropped frame is counted as such; a capture of it waits for the camera's next frame. Slots stay as they are.
        """
        mask = self._lib.slog_abort_frames(self._driver)
        self._check("abort")
        return [camera for camera in range(self.config.cameras) if mask >> camera & 1]

    def arm(self, slot: int, camera: int = 0) -> None:
        """Request the camera's next frame for the slot.

        Raises:
            DeviceError: if the board refuses.
        """
        taken = self._lib.slog_arm(self._driver, camera, slot)
        self._check("capture request")
        if not taken:
            raise DeviceError(f"the board refuses to capture camera {camera} into slot {slot}")

    def disarm(self, camera: int = 0) -> None:
        """Withdraw the camera's request."""
        self._lib.slog_disarm(self._driver, camera)
        self._check("withdrawal of a capture request")

    def wait_captured(self, *cameras: int) -> None:
        """Wait until the cameras' requests are fulfilled.

        Raises:
            DeviceTimeout: if a request stays: no good frame arrived.
        """
        mask = sum(1 << c for c in set(cameras))
        self._check("capture", self._lib.slog_wait_captured(self._driver, mask, self._frame_clocks()))

    def plane(self, slot: int) -> Image:
        """The slot's sign bits, uint8 0/1 (height, width) of the present size."""
        c = self.config
        width, height = self.size
        pieces = -(-c.group_bits // 32)
        data = np.zeros(height * c.words_per_row * pieces, np.uint32)
        self._lib.slog_peek(self._driver, slot * c.slot_words, data.ctypes.data, len(data))
        self._check("plane read-back")
        bits = np.unpackbits(data.view(np.uint8).reshape(-1, 4), axis=1, bitorder="little")
        bits = bits.reshape(height, c.words_per_row, pieces * 32)[:, :, :c.group_bits]
        return np.ascontiguousarray(bits.reshape(height, -1)[:, :width])

    # ----------------------------------------------------------------------------------------------------------- jobs
    def submit(self, jobs: Iterable[Job]) -> None:
        """Queue jobs; those that the board has no room for wait on this side."""
        self._submit(pack_jobs(jobs))

    def submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        """Queue a grid of jobs by one command: counts and steps (across, down)."""
        self._submit(pack_jobs([job], count, step))

    def _submit(self, jobs: npt.NDArray[Any]) -> None:
        self._lib.slog_submit(self._driver, jobs.ctypes.data, len(jobs))
        self._check("job submission")

    @property
    def outstanding(self) -> int:
        """Results not yet collected."""
        return int(self._lib.slog_outstanding(self._driver))

    def collect(self, count: int) -> list[Result]:
        """Wait for the next `count` results, in job order.

        Raises:
            DeviceTimeout: if they do not arrive.
        """
        results = np.zeros(count, RESULT_DTYPE)
        # The longest job: a pass of max_window steps for every pitch offsets.
        c = self.config
        longest = c.max_width * c.max_height * c.max_window // c.pitch
        self._check(f"collecting {count} results",
                    self._lib.slog_collect(self._driver, results.ctypes.data, count, 2 * longest + SLACK))
        return unpack_results(results)

    def run(self, jobs: Sequence[Job]) -> list[Result]:
        """Submit jobs and collect their results."""
        self.submit(jobs)
        return self.collect(len(jobs))

    # --------------------------------------------------------------------------------------------------------- checks
    def _frame_clocks(self) -> int:
        return FRAME_CLOCKS * self.size[0] * self.size[1] + SLACK

    def _bus_error(self, what: str) -> DeviceError:
        """The error to raise when an access of the operation `what` failed."""
        return DeviceTimeout(f"{what}: the register bus does not answer")

    def _check(self, what: str, code: int = 0) -> None:
        if self._lib.slog_failed(self._driver):
            raise self._bus_error(what)
        if code == TIMEOUT:
            raise DeviceTimeout(f"{what}: no progress{self._when()}; {self._state()}")

    def _when(self) -> str:
        """Time of a message, where the board's clocks are counted."""
        return ""

    def _state(self) -> str:
        names = ("filter.busy", "slot_status.valid", "slot_status.armed", "slot_status.writing", "job.status.waiting",
                 "job.status.busy", "result.pop.waiting")
        return ", ".join(f"{name} {self.read(name):#x}" for name in names)

    def _check_build(self) -> None:
        """Raise an error unless the board's registers describe the configuration."""
        c = self.config
        want = {"id.value": int.from_bytes(b"SLOG"), "build_image.max_width": c.max_width,
                "build_image.max_height": c.max_height, "build_window.group_bits": c.group_bits,
                "build_window.words_per_row": c.words_per_row, "build_board.slots": c.slots,
                "build_board.cameras": c.cameras, "build_filter.radius": c.radius}
        if c.dense_offsets:
            want |= {"dense.build.offsets": c.dense_offsets, "dense.build.max_window": c.dense_window,
                     "dense.build.sizes": c.dense_sizes, "dense.build.lanes": c.dense_lanes}
        wrong = [name for name, value in want.items() if self.read(name) != value]
        if wrong:
            raise DeviceError(f"the board is not {c.name!r}: {', '.join(wrong)} differ")
