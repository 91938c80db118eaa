# SPDX-License-Identifier: Apache-2.0
"""What a board with a dense engine answers: a pass over two slots' planes, thinned out and judged, bit for bit."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from golden.correlate import Plane
from golden.dense import ABSENT, Counts, DenseMap, DensePass, dense
from golden.numbers import whole
from golden.params import Config

Flags = npt.NDArray[np.bool_]
"""A flag for each pixel, bool (H, W)."""
MOST = 2047
"""Largest number of mismatches that a threshold's register holds: none is larger, so as `most` it accepts all."""
RANGES = {"left": 7, "right": 7, "most": MOST, "margin": MOST}
"""Largest number that the register of each of a job's fields holds."""
STEP_MAX = 255
"""Largest step that a register holds, pixels."""


class DenseStatus(IntEnum):
    """Outcome of a job's check: OK, or the first reason for refusal in this order."""

    OK = 0
    BAD_WINDOW = 1
    """The window is of no size that the engine has, or larger than the image."""
    BAD_OFFSETS = 2
    """No offsets, or more than the engine has."""
    BAD_SLOT = 3
    """A slot that the board has not, or without a frame and, in a live pass, without a request for one."""
    BAD_STEP = 4
    """A step of 0."""


@dataclass(frozen=True)
class DenseJob:
    """A pass for a board with a dense engine. Lengths in pixels. A job may be one the board refuses.

    A pixel is valid where an offset counts (`found`), `best` is `most` or less, `rest` is absent or exceeds `best` by
    `margin` or more, and, with `check`, the winners of both planes agree.

    Attributes:
        left: slot whose pixels the map has.
        right: slot that is searched.
        search: the pass.
        step: every step[0]-th column and step[1]-th row is answered, from the first on.
        most: most mismatches of a valid pixel, 0..2047.
        margin: least distance of a valid pixel's best from the rest, mismatches, 0..2047.
        check: whether the winners of both planes must agree.
        live: whether the slots may be those of captures that are armed or under way. Each row of the pass then waits
            for its rows of the frames that these captures get; the answer is that of a pass over the whole frames. If
            one of them does not become whole, the pass ends with a status of its own, and its map must not be used.

    Raises:
        ValueError: if a number is not whole or does not fit its register, `search` is no pass, or `step` is not two
            numbers.
    """

    left: int
    right: int
    search: DensePass
    step: tuple[int, int] = (1, 1)
    most: int = MOST
    margin: int = 0
    check: bool = False
    live: bool = False

    def __post_init__(self) -> None:
        for name, top in RANGES.items():
            object.__setattr__(self, name, whole(name, getattr(self, name), 0, top))
        for name in ("check", "live"):
            object.__setattr__(self, name, bool(getattr(self, name)))
        if not isinstance(self.search, DensePass):
            raise ValueError(f"search is {self.search!r}: must be a DensePass")
        if np.shape(self.step) != (2,):
            raise ValueError(f"step is {self.step}: must be two numbers, across and down")
        across, down = (whole("step", n, 0, STEP_MAX) for n in self.step)
        object.__setattr__(self, "step", (across, down))


@dataclass(frozen=True)
class DenseResult:
    """The winners at the pixels that a job's step leaves, arrays (ceil(H / step_y), ceil(W / step_x)).

    Attributes:
        index: the best offset's number k, int16 as all counts; ABSENT where no offset counts.
        best: mismatches there, 0..window**2, ABSENT where no offset counts.
        lower: mismatches at offset k - 1, ABSENT where it does not count.
        upper: the same at offset k + 1.
        rest: least mismatches of the offsets that are neither, ABSENT where there is none.
        found: whether an offset counts.
        agrees: whether the right plane's winner is this one, within AGREEMENT.
        valid: whether the job's conditions hold.
    """

    index: Counts
    best: Counts
    lower: Counts
    upper: Counts
    rest: Counts
    found: Flags
    agrees: Flags
    valid: Flags


def check_dense(window: int, offsets: int, slots: tuple[int, int], step: tuple[int, int], config: Config,
                size: tuple[int, int], held: Container[int]) -> DenseStatus:
    """Status of a job with these numbers, which may be any that the registers hold, before anything is computed.

    Args:
        window: side of the window, pixels.
        offsets: their number.
        slots: of the left and the right plane.
        step: across and down, pixels.
        config: the board; bounds window, offsets and slots.
        size: (width, height) of the image, pixels.
        held: the slots that hold a frame; of a live pass also those that armed captures will fill.
    """
    if window not in config.dense_windows or window > min(size):
        return DenseStatus.BAD_WINDOW
    if not 1 <= offsets <= config.dense_offsets:
        return DenseStatus.BAD_OFFSETS
    if not all(slot < config.slots and slot in held for slot in slots):
        return DenseStatus.BAD_SLOT
    return DenseStatus.OK if all(step) else DenseStatus.BAD_STEP


def check_job(job: DenseJob, config: Config, size: tuple[int, int], held: Container[int]) -> DenseStatus:
    """Status of `job`; arguments as of `check_dense`."""
    one = job.search
    return check_dense(one.window, one.offsets, (job.left, job.right), job.step, config, size, held)


def judge(found: DenseMap, job: DenseJob) -> DenseResult:
    """The answer of a job that is not refused, from the winners of its pass at every pixel."""
    thin = slice(None, None, job.step[1]), slice(None, None, job.step[0])
    index, best, lower, upper, rest, back = (np.ascontiguousarray(counts[thin]) for counts in (
        found.index, found.best, found.lower, found.upper, found.rest, found.back))
    agrees = DenseMap(index, best, lower, upper, rest, back).agrees
    counted = index != ABSENT
    valid = counted & (best <= job.most) & ((rest == ABSENT) | (rest - best >= job.margin))
    if job.check:
        valid &= agrees
    return DenseResult(index, best, lower, upper, rest, counted, agrees, valid)


def run_dense(job: DenseJob, planes: Mapping[int, Plane], config: Config, size: tuple[int, int],
              ) -> tuple[DenseStatus, DenseResult | None]:
    """The board's answer to `job`: its status, and the winners where that is OK.

    Args:
        job: the job, acceptable or not.
        planes: sign planes by slot, uint8 0/1, (height, width) of `size`; a slot without a frame has no key. Of a live
            pass they are the whole frames that come into the slots.
        config: the board.
        size: (width, height) of the image, pixels.
    """
    status = check_job(job, config, size, planes)
    if status is not DenseStatus.OK:
        return status, None
    return status, judge(dense(planes[job.left], planes[job.right], job.search), job)
