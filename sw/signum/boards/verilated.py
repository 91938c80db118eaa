# SPDX-License-Identifier: Apache-2.0
"""The Verilated board behind the Board interface: the RTL itself, simulated, bit for bit what the hardware computes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from golden import log
from golden.correlate import Job, Result, Status
from golden.dense_job import DenseJob, DenseResult, DenseStatus
from golden.params import FULL, Config
from signum.boards.board import Board, BoardError, Identification, Surface
from signum.common.arrays import Image
from sim.board.build import BuildError
from sim.board.dense import DenseEngine
from sim.board.device import Device, DeviceError


class VerilatedBoard(Board):
    """A board made of the project's RTL; the first one of a configuration builds it, which takes a minute.

    Args:
        config: the build.
        trace: file for a wave dump (a slower build); None for none.
        checked: take the build with the RTL's assertions live (slower).
        power_up: seed of the registers' values at power-up, for a checked build; 0 for all registers 0.

    Raises:
        BoardError: if the RTL cannot be built.
    """

    name = "verilated"

    def __init__(self, config: Config = FULL, trace: Path | None = None, checked: bool = False,
                 power_up: int = 0) -> None:
        super().__init__(config)
        try:
            self._device = Device(config, trace, checked, power_up)
        except (BuildError, DeviceError) as error:
            raise BoardError(f"the Verilated board does not start: {error}") from error

    @property
    def identification(self) -> Identification:
        read = self._device.read
        try:
            return Identification(
                self.name, self.config.name, f"{read('version.major')}.{read('version.minor')}",
                read("build_board.cameras"), read("build_board.slots"),
                (read("build_image.max_width"), read("build_image.max_height")), read("build_window.max_window"))
        except DeviceError as error:
            raise BoardError(str(error)) from error

    @property
    def asserted(self) -> bool:
        """Whether an assertion of the RTL has failed, in a checked build; its message is on the standard output."""
        return self._device.asserted

    @property
    def clocks(self) -> int:
        """Clocks since the simulation began, register accesses included."""
        return self._device.clocks

    def counters(self) -> dict[str, int]:
        raw = self._device.counters()
        counts = {f"{kind}_{camera}": raw[f"{kind}[{camera}]"]
                  for camera in range(self.config.cameras) for kind in ("frames", "drops")}
        return counts | {"jobs": raw["jobs"], "refused": raw["refused"], "scores": raw["scores"],
                         "busy_clocks": raw["busy"], "clocks": raw["clocks"]}

    def close(self) -> None:
        """Free the simulation and finish its wave dump."""
        super().close()
        self._device.close()

    def _configure(self, size: tuple[int, int], sigma: float) -> None:
        kernels = log.kernels(sigma, self.config.radius)
        try:
            self._device.set_filter(*kernels, size)
        except DeviceError as error:
            raise BoardError(str(error)) from error

    def _capture(self, frames: Sequence[tuple[int, int, Image]]) -> None:
        try:
            self._device.capture({camera: slot for camera, slot, _ in frames},
                                 {camera: frame for camera, _, frame in frames})
        except DeviceError as error:
            raise BoardError(str(error)) from error

    def _read_plane(self, slot: int) -> Image:
        return self._device.plane(slot)

    def _submit(self, jobs: Sequence[Job]) -> None:
        if jobs:
            self._device.submit(jobs)

    def _submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        self._device.submit_grid(job, count, step)

    def _collect(self, count: int) -> list[Result]:
        if not count:
            return []
        try:
            return self._device.collect(count)
        except DeviceError as error:
            raise BoardError(str(error)) from error

    def _surface(self, job: Job) -> tuple[Result, Surface | None]:
        self._device.submit([replace(job, surface=True)])
        (result,) = self._collect(1)
        if result.status is not Status.OK:
            return result, None
        return result, self._device.surface(job.offsets_x * job.offsets_y).reshape(job.offsets_y, job.offsets_x)

    def _dense(self, job: DenseJob) -> tuple[DenseStatus, DenseResult | None]:
        try:
            return DenseEngine(self._device).run(job)
        except DeviceError as error:
            raise BoardError(str(error)) from error

    def _capture_dense(self, job: DenseJob, frames: tuple[Image, Image]) -> tuple[DenseStatus, DenseResult | None]:
        try:
            return DenseEngine(self._device).run_live(job, frames)
        except DeviceError as error:
            raise BoardError(str(error)) from error
