# SPDX-License-Identifier: Apache-2.0
"""A log of register accesses: recorded from the Verilated tiny board, kept in `accesses.log`, and replayed without it.

`python -m sim.board.tests.accesses` records it anew. The driver in it has nothing but `read` and `write`, as over UART.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from golden.correlate import Job, Result
from golden.log import Image, kernels, sign
from golden.params import TINY
from sim.board.callbacks import CallbackDriver
from sim.board.device import Device
from sim.board.driver import RegisterDriver
from sim.registers.map import fields

LOG = Path(__file__).with_name("accesses.log")
SIZE = (18, 18)
SIGMA = 1.0
JOBS = [Job(0, 1, 2, 9, 8, 1, 3, 4, 2, 3, tag=700 + k, surface=False) for k in range(10)]
"""More than the board's queue of eight holds, and than its four results."""
OTHER = Job(1, 5, 3, 8, 10, 0, 0, 1, 3, 2, tag=40000)
GRID = (Job(0, 0, 0, 8, 9, 1, 0, 0, 2, 1, tag=9), (2, 2), (8, 9))

Play = Callable[[int, Image], None]


def frames() -> list[Image]:
    """Two frames of noise of `SIZE`."""
    rng = np.random.default_rng(4)
    return [rng.integers(0, 256, SIZE[::-1], dtype=np.uint8) for _ in range(2)]


def planes() -> dict[int, Image]:
    """The sign planes of `frames`, by slot."""
    return {slot: sign(frame, SIGMA, TINY.radius) for slot, frame in enumerate(frames())}


def exercise(driver: RegisterDriver, play: Play) -> tuple[list[Result], list[Image], dict[str, int]]:
    """Use every function of the driver once; `play` sends a frame through a camera.

    Returns:
        Results, the planes of slots 0 and 1, and the counters.
    """
    driver.set_filter(*kernels(SIGMA, TINY.radius), SIZE)
    driver.arm(3, 1)
    driver.disarm(1)
    for camera, frame in enumerate(frames()):
        driver.arm(camera, camera)
        play(camera, frame)
    driver.wait_captured(0, 1)
    driver.submit([*JOBS, OTHER])
    results = driver.collect(len(JOBS) + 1)
    driver.submit_grid(*GRID)
    results += driver.collect(4)
    return results, [driver.plane(0), driver.plane(1)], driver.counters()


def record() -> list[str]:
    """The accesses of `exercise` on the Verilated tiny board: a line each, with the register and the word."""
    register = {field.address: name.rpartition(".")[0] for name, field in fields().items()}
    lines = []
    with Device("tiny") as board:
        def read(where: int) -> int:
            value = board.read_word(where)
            lines.append(f"read  {register[where]} {value:#010x}")
            return value

        def write(where: int, value: int) -> None:
            lines.append(f"write {register[where]} {value:#010x}")
            board.write_word(where, value)

        with CallbackDriver("tiny", read, write) as driver:
            exercise(driver, lambda camera, frame: board.play(frame, camera))
    return lines


class AccessReplay:
    """The board's side of a log: answers reads as recorded, and raises an error where an access differs."""

    def __init__(self, lines: list[str]) -> None:
        self._register = {field.address: name.rpartition(".")[0] for name, field in fields().items()}
        self._lines = lines
        self.at = 0

    def read(self, where: int) -> int:
        """The recorded word."""
        return int(self._next(f"read  {self._register[where]}").split()[-1], 16)

    def write(self, where: int, value: int) -> None:
        """Compare a write with the log."""
        self._next(f"write {self._register[where]} {value:#010x}")

    def _next(self, access: str) -> str:
        logged = self._lines[self.at] if self.at < len(self._lines) else "nothing"
        self.at += 1
        if logged != access and logged.rpartition(" ")[0] != access:
            raise AssertionError(f"access {self.at} is {access!r}, in the log it is {logged!r}")
        return logged


if __name__ == "__main__":
    LOG.write_text("\n".join(record()) + "\n")
    print(f"{LOG}: {len(LOG.read_text().splitlines())} accesses")
