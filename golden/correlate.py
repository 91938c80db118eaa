# SPDX-License-Identifier: Apache-2.0
"""Frame-level correlation: the result of a job, bit for bit.

The score of an offset is the number of matching bits of template and search window, `width * height` minus their
Hamming distance. Of equal scores the first in raster order is the best. Field widths are those of `slog_pkg`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import cv2
import numpy as np
import numpy.typing as npt

from golden.numbers import whole
from golden.params import NO_SCORE, TAG_BITS, Config

Plane = npt.NDArray[np.uint8]
"""Sign bits 0/1, shape (H, W)."""
Surface = npt.NDArray[np.int32]
"""Scores 0..width*height, shape (offsets_y, offsets_x)."""
Neighbours = tuple[int, int, int, int, int, int, int, int]
"""Scores around the best in raster order: NW N NE W E SW S SE; NO_SCORE where there is no offset."""

CHANCE_DEVIATION = 1.1
"""Standard deviation of a chance score, as 2 * score / area - 1, is this times sigma / sqrt(area): signs are correlated
over about this many sigmas. Measured on white noise: 0.92 to 1.2 where the window's side is 6 sigma or more."""
COORDINATE_MAX = (1 << 10) - 1
"""Largest position, offset count and step; no image is this large, so a saturated position is always outside."""
FIELD_MAX = {
    "tag": (1 << TAG_BITS) - 1, "tpl_slot": 7, "search_slot": 7, "width": 255, "height": 255,
    **dict.fromkeys(("tpl_x", "tpl_y", "search_x", "search_y", "offsets_x", "offsets_y"), COORDINATE_MAX),
}
"""Largest number that the register of each of a job's fields holds."""


class Status(IntEnum):
    """Outcome of a job's check (`slog_pkg::status_e`): OK, or the first reason for refusal in this order."""

    OK = 0
    BAD_WINDOW = 1
    NO_OFFSETS = 2
    BAD_SLOT = 3
    OUTSIDE = 4


@dataclass(frozen=True)
class Job:
    """A correlation job (`slog_pkg::job_t`). Positions and sizes in pixels of the plane.

    The template is the `width` x `height` window at (`tpl_x`, `tpl_y`) of `tpl_slot`; offset (0, 0) lays it at
    (`search_x`, `search_y`) of `search_slot`. A job may be one the board refuses.

    Raises:
        ValueError: if a number is not whole or does not fit its register.
    """

    tpl_slot: int
    tpl_x: int
    tpl_y: int
    width: int
    height: int
    search_slot: int
    search_x: int
    search_y: int
    offsets_x: int
    offsets_y: int
    tag: int = 0
    surface: bool = False

    def __post_init__(self) -> None:
        for name, top in FIELD_MAX.items():
            object.__setattr__(self, name, whole(name, getattr(self, name), 0, top))
        object.__setattr__(self, "surface", bool(self.surface))


@dataclass(frozen=True)
class Result:
    """The result of a job (`slog_pkg::result_t`). A refused job has best (0, 0) and no scores.

    `best_x`, `best_y` are offsets in pixels, `score` the matching bits there, `runner_up` the best score outside the
    3x3 neighbourhood; scores are 0..16384, or NO_SCORE where absent.
    """

    tag: int
    status: Status
    best_x: int = 0
    best_y: int = 0
    score: int = NO_SCORE
    neighbours: Neighbours = (NO_SCORE,) * 8
    runner_up: int = NO_SCORE

    @property
    def patch(self) -> Surface:
        """The 3x3 scores with the best in the middle, int32: `patch[1 + dy, 1 + dx]` is the score dx right of the best
        and dy below it, pixels; NO_SCORE where there is no offset."""
        n = self.neighbours
        return np.array([n[:3], (n[3], self.score, n[4]), n[5:]], np.int32)

    def above_chance(self, job: Job, sigma: float) -> float:
        """By how many standard deviations the best score exceeds that of two windows that have nothing in common; see
        `above_chance`. 0 where the job was refused.

        Args:
            job: the job of this result.
            sigma: of the LoG through which both frames were captured, pixels.
        """
        area = job.width * job.height
        return above_chance(self.score / area, area, sigma) if self.status is Status.OK else 0.0


def above_chance(score: float, area: int, sigma: float) -> float:
    """By how many standard deviations a score exceeds that of two windows that have nothing in common.

    The best of many offsets is above 0 even if all of them are chance: 2 to 4 for searches of 33x33 offsets. On real
    seabed wrong places also match far above chance, so that a high value alone does not prove a match.

    Args:
        score: matching fraction, 0..1.
        area: pixels of the window.
        sigma: of the LoG through which both frames were captured, pixels.
    """
    return (2 * score - 1) * math.sqrt(area) / (CHANCE_DEVIATION * sigma)


def check(job: Job, config: Config, image_size: tuple[int, int], slot_valid: Sequence[bool] | Mapping[int, object],
          ) -> Status:
    """Status of `job`, before any correlation.

    Args:
        job: the job.
        config: the board; bounds the window and the slots.
        image_size: (width, height) in pixels.
        slot_valid: whether each slot holds a frame; or a mapping with a key for each slot that does.
    """
    def holds(slot: int) -> bool:
        if slot >= config.slots:
            return False
        return slot in slot_valid if isinstance(slot_valid, Mapping) else bool(slot_valid[slot])

    if not all(config.min_window <= n <= config.max_window for n in (job.width, job.height)):
        return Status.BAD_WINDOW
    if not (job.offsets_x and job.offsets_y):
        return Status.NO_OFFSETS
    if not (holds(job.tpl_slot) and holds(job.search_slot)):
        return Status.BAD_SLOT
    if (max(job.tpl_x, job.search_x + job.offsets_x - 1) + job.width > image_size[0]
            or max(job.tpl_y, job.search_y + job.offsets_y - 1) + job.height > image_size[1]):
        return Status.OUTSIDE
    return Status.OK


def surface(template_plane: Plane, search_plane: Plane, job: Job) -> Surface:
    """Every score of an accepted job, exact.

    The squared difference of 0/1 images is their Hamming distance; OpenCV's float32 result is an integer to within
    far less than one half (asserted in `test_correlate.py`), so rounding makes it exact.

    Args:
        template_plane: plane of the template slot, uint8 0/1, (H, W).
        search_plane: plane of the search slot, uint8 of the same size.
        job: a job that lies inside both planes.

    Returns:
        int32 scores 0..width*height, shape (offsets_y, offsets_x).

    Raises:
        ValueError: if the job reaches outside a plane.
    """
    template = template_plane[job.tpl_y:job.tpl_y + job.height, job.tpl_x:job.tpl_x + job.width]
    search = search_plane[job.search_y:job.search_y + job.offsets_y + job.height - 1,
                          job.search_x:job.search_x + job.offsets_x + job.width - 1]
    if (template.shape != (job.height, job.width)
            or search.shape != (job.offsets_y + job.height - 1, job.offsets_x + job.width - 1)):
        raise ValueError("the job reaches outside the plane")
    mismatch = cv2.matchTemplate(search, template, cv2.TM_SQDIFF)
    return np.asarray(job.width * job.height - np.rint(mismatch).astype(np.int32), dtype=np.int32)


def peak(scores: Surface) -> tuple[int, int, int, Neighbours, int]:
    """Best of a surface: (best_x, best_y, score, its eight neighbours, best score outside its 3x3 neighbourhood).

    `scores` is int32, (offsets_y, offsets_x), not empty. Of equal scores the first in raster order is the best. A
    neighbour outside the surface is NO_SCORE, as is the runner-up where nothing is outside the neighbourhood.
    """
    y, x = divmod(int(np.argmax(scores)), scores.shape[1])
    best = int(scores[y, x])
    top, left = max(y - 1, 0), max(x - 1, 0)
    around = np.full((3, 3), NO_SCORE, dtype=np.int32)
    patch = scores[top:y + 2, left:x + 2]
    around[top - y + 1:top - y + 1 + patch.shape[0], left - x + 1:left - x + 1 + patch.shape[1]] = patch
    n = [int(v) for v in around.flat]
    strips = (scores[:top], scores[y + 2:], scores[top:y + 2, :left], scores[top:y + 2, x + 2:])
    runner_up = max((int(s.max()) for s in strips if s.size), default=NO_SCORE)
    return x, y, best, (n[0], n[1], n[2], n[3], n[5], n[6], n[7], n[8]), runner_up


def run(job: Job, planes: Mapping[int, Plane], config: Config, image_size: tuple[int, int]) -> Result:
    """The board's result of `job`.

    Args:
        job: the job, acceptable or not.
        planes: sign planes by slot, uint8 0/1, (height, width) of `image_size`; a slot without a frame has no key.
        config: the board.
        image_size: (width, height) in pixels.
    """
    status = check(job, config, image_size, planes)
    if status is not Status.OK:
        return Result(job.tag, status)
    x, y, score, neighbours, runner_up = peak(surface(planes[job.tpl_slot], planes[job.search_slot], job))
    return Result(job.tag, status, x, y, score, neighbours, runner_up)


def grid(job: Job, count: tuple[int, int], step: tuple[int, int]) -> list[Job]:
    """Jobs of a grid command in raster order: template and search move together, the tag counts up (modulo 2**16).

    Positions saturate at COORDINATE_MAX, which is outside every image: such a job is refused, never wrapped around.

    Args:
        job: the first job.
        count: jobs (across, down), 1..1023 each.
        step: pixels (across, down) from one job to the next, 0..1023.

    Raises:
        ValueError: if a count or a step does not fit its register, or a count is zero.
    """
    if not all(1 <= n <= COORDINATE_MAX for n in count) or not all(0 <= n <= COORDINATE_MAX for n in step):
        raise ValueError(f"counts must lie in 1..{COORDINATE_MAX} and steps in 0..{COORDINATE_MAX}")

    def moved(start: int, distance: int) -> int:
        return min(start + distance, COORDINATE_MAX)

    return [replace(job, tag=(job.tag + j * count[0] + i) % (1 << TAG_BITS),
                    tpl_x=moved(job.tpl_x, i * step[0]), search_x=moved(job.search_x, i * step[0]),
                    tpl_y=moved(job.tpl_y, j * step[1]), search_y=moved(job.search_y, j * step[1]))
            for j in range(count[1]) for i in range(count[0])]
