# SPDX-License-Identifier: Apache-2.0
"""Passes of the dense engine through its registers, and the words of its maps."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np
import numpy.typing as npt

from golden.dense import ABSENT, Counts
from golden.dense_job import DenseJob, DenseResult, DenseStatus
from golden.log import Image
from sim.board.device import Device, DeviceError, DeviceTimeout

Words = npt.NDArray[np.uint64]
"""Words of a map: `map_t` of `rtl/dense/slog_dense_pkg.sv`."""
CANCELLED = 5
"""Status of a pass that was cancelled before its end."""
LOST = 6
"""Status of a live pass of which a frame did not become whole."""
NO_SUM = 2047
"""In a word: no offset counts there."""
_SUMS, _INDEX, _FLAGS = (33, 22, 11, 0), 44, (52, 53, 54)
"""Lowest bits of a word's fields: best, lower, upper and rest; index; found, agrees and valid."""


def map_shape(size: tuple[int, int], step: tuple[int, int]) -> tuple[int, int]:
    """Rows and columns of a map of images of `size` (width, height) with `step` (across, down)."""
    return -(-size[1] // step[1]), -(-size[0] // step[0])


def unpack_map(words: Words, shape: tuple[int, int]) -> DenseResult:
    """The result that a map's words hold.

    Args:
        words: one for each pixel, in raster order.
        shape: rows and columns of the map.

    Raises:
        ValueError: if there are not as many words as pixels, or a word's unused bits are not 0.
    """
    pixels = words.reshape(shape)
    if (pixels >> np.uint64(55)).any():
        raise ValueError("a word of the map has bits that are not used")

    def part(lsb: int, bits: int) -> Counts:
        return np.asarray(pixels >> np.uint64(lsb) & np.uint64((1 << bits) - 1)).astype(np.int16)

    found, agrees, valid = (part(lsb, 1).astype(np.bool_) for lsb in _FLAGS)
    best, lower, upper, rest = sums = [part(lsb, 11) for lsb in _SUMS]
    for counts in sums:
        counts[counts == NO_SUM] = ABSENT
    index = part(_INDEX, 8)
    index[~found] = ABSENT
    return DenseResult(index, best, lower, upper, rest, found, agrees, valid)


class DenseEngine:
    """The dense engine of a simulated board.

    Args:
        device: the board, of a configuration with an engine.
    """

    def __init__(self, device: Device) -> None:
        self.device = device

    def load(self, job: DenseJob) -> None:
        """Write the registers of a job; the pass under way, if there is one, keeps its own."""
        d, search = self.device, job.search
        d.write("dense.planes", left=job.left, right=job.right, window=search.window, check=int(job.check),
                live=int(job.live))
        d.write("dense.search", offsets=search.offsets, start=search.start)
        d.write("dense.vertical", down=search.down, step_x=job.step[0], step_y=job.step[1])
        d.write("dense.limits", most=job.most, margin=job.margin)

    def go(self) -> None:
        """Start a pass with the registers as they are."""
        self.device.write("dense.run", go=1)

    def cancel(self) -> None:
        """End the pass under way; its map ends early."""
        self.device.write("dense.run", cancel=1)

    @property
    def busy(self) -> bool:
        """Whether a pass is under way."""
        return bool(self.device.read("dense.run.busy"))

    @property
    def status(self) -> int:
        """Status of the last pass: a `DenseStatus`, CANCELLED or LOST."""
        return self.device.read("dense.run.status")

    def run(self, job: DenseJob) -> tuple[DenseStatus, DenseResult | None]:
        """Carry out a job; the result is None where it is refused.

        Raises:
            DeviceError: if a pass is under way or its map was not taken, or the map does not arrive whole; no pass is
                left then that this call began.
        """
        self._check_idle()
        try:
            self.load(job)
            self.go()
            return self.collect(job)
        except BaseException:
            self._stop(job)
            raise

    def collect(self, job: DenseJob) -> tuple[DenseStatus, DenseResult | None]:
        """Wait for the pass of `job`, which was started.

        Raises:
            DeviceError: if the map does not arrive whole, or a frame of a live pass was lost.
        """
        d = self.device
        self._wait(lambda: not self.busy or bool(d.stream_waiting))  # whether it is refused shows after some clocks
        if not d.stream_waiting:
            return DenseStatus(self.status), None
        shape = map_shape(d.size, job.step)
        words = d.map_words(shape[0] * shape[1], d.playing_clocks if job.live else None)
        self._wait(lambda: not self.busy)
        if self.status == LOST:
            raise DeviceError("a frame of the live pass was lost")
        if len(words) != shape[0] * shape[1]:
            raise DeviceError(f"map: {len(words)} of {shape[0] * shape[1]} words, status {self.status}")
        return DenseStatus(self.status), unpack_map(words, shape)

    def run_live(self, job: DenseJob, frames: tuple[Image, Image], pause: float = 0.0, seed: int = 1,
                 ) -> tuple[DenseStatus, DenseResult | None]:
        """Capture a frame of each camera, camera 0's into the job's left slot, and carry out the job as they arrive.

        The frames are captured also where the job is refused.

        Args:
            job: a live one, of two different slots.
            frames: uint8 (height, width), by camera.
            pause: probability that a pixel is held back in a clock.
            seed: of the pauses.

        Raises:
            DeviceError: if a pass is under way or its map was not taken, if the board refuses a capture or drops a
                frame, or if the map does not arrive whole. No request and no pass of this call is left then.
        """
        d, slots = self.device, (job.left, job.right)
        self._check_idle()
        drops = self._drops()
        try:
            self.load(job)
            for camera, slot in enumerate(slots):
                d.arm(slot, camera)
            self.go()
            for camera, frame in enumerate(frames):
                d.play(frame, camera, pause, seed + camera)
            # A pass would wait for a frame after one that is dropped before its first row is whole, but none comes.
            self._wait(lambda: not self.busy or bool(d.stream_waiting) or self._drops() != drops)
            lost = [str(camera) for camera, count in enumerate(self._drops()) if count != drops[camera]]
            if lost and self.busy and not d.stream_waiting:
                raise DeviceError(f"the board dropped the frame of camera {', '.join(lost)}")
            answer = self.collect(job)
            d.finish_playing()
            d.wait_captured(0, 1)
        except BaseException:
            for camera in (0, 1):
                with suppress(DeviceError):
                    d.disarm(camera)
            self._stop(job)
            raise
        return answer

    def _check_idle(self) -> None:
        if self.busy or self.device.stream_waiting:
            raise DeviceError("a dense pass is under way, or its map was not taken: collect it first")

    def _drops(self) -> list[int]:
        """Frames that each camera has dropped."""
        return [self.device.read(f"counter.drops[{camera}].value") for camera in (0, 1)]

    def _wait(self, done: Callable[[], bool]) -> None:
        """Run until `done`, within the clocks that frames may take.

        Raises:
            DeviceTimeout: if it does not come.
        """
        begun = self.device.clocks
        while not done():
            if self.device.clocks - begun > self.device.playing_clocks:
                raise DeviceTimeout("dense pass: no progress")

    def _stop(self, job: DenseJob) -> None:
        """End the pass of `job` if it is under way, and throw its map away."""
        with suppress(DeviceError):
            if self.busy:
                self.cancel()
            while self.busy or self.device.stream_waiting:
                if self.device.stream_waiting:
                    self.device.map_words(job_words(self.device.size, job))


def job_words(size: tuple[int, int], job: DenseJob) -> int:
    """Words of a whole map of `job` of images of `size` (width, height)."""
    rows, columns = map_shape(size, job.step)
    return rows * columns
