# SPDX-License-Identifier: Apache-2.0
"""Converts job results to displacements in pixels and scores 0..1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from golden.correlate import Job, Result, Status, above_chance
from golden.params import NO_SCORE
from signum.measure.subpixel import CONE_FROM, PeakFit, line_offset, peak_offsets


@dataclass(frozen=True)
class Peak:
    """A job's peak.

    Attributes:
        status: of the job; where it is not OK, the rest is 0.
        dx: displacement of the template at the peak, pixels right.
        dy: the same, pixels down.
        score: matching fraction at the peak, 0..1.
        margin: its difference from the best match outside the peak's 3x3 neighbourhood.
        inside: whether the peak has neighbours on all sides in each dimension that was searched.
        above_chance: by how many standard deviations of a chance score the peak exceeds a chance match: the best place
            of a search that saw nothing but chance reaches 2 to 4, see `golden.correlate.above_chance`.
    """

    status: Status
    dx: float = 0.0
    dy: float = 0.0
    score: float = 0.0
    margin: float = 0.0
    inside: bool = False
    above_chance: float = 0.0


def locate_peaks(jobs: Sequence[Job], results: Sequence[Result], sigma: float, fit: PeakFit = "auto") -> list[Peak]:
    """The peaks of jobs from their results, in order, refined to sub-pixels.

    Args:
        jobs: the jobs.
        results: their results, in the same order.
        sigma: of the LoG through which the frames were captured, pixels (`Board.sigma`).
        fit: the surface fitted to the nine scores round a peak: `cone`, `parabola`, or `auto`, which chooses by score.
    """
    out = []
    whole = [i for i, r in enumerate(results) if r.status is Status.OK and NO_SCORE not in r.neighbours]
    patches = np.array([[*results[i].neighbours[:4], results[i].score, *results[i].neighbours[4:]] for i in whole])
    areas = np.array([jobs[i].width * jobs[i].height for i in whole], np.float64)
    offsets = dict(zip(whole, peak_offsets(patches.reshape(-1, 3, 3), areas, fit), strict=True))
    for i, (job, r) in enumerate(zip(jobs, results, strict=True)):
        if r.status is not Status.OK:
            out.append(Peak(r.status))
            continue
        area = job.width * job.height
        score = r.score / area
        runner_up = 0.5 if r.runner_up == NO_SCORE else r.runner_up / area
        offset = offsets.get(i)
        if offset is None:
            offset = _along_lines(r, area, sharp=fit == "cone" or (fit == "auto" and score >= CONE_FROM))
        inside = ((0 < r.best_x < job.offsets_x - 1 or job.offsets_x == 1)
                  and (0 < r.best_y < job.offsets_y - 1 or job.offsets_y == 1))
        out.append(Peak(r.status, job.search_x + r.best_x - job.tpl_x + float(offset[0]),
                        job.search_y + r.best_y - job.tpl_y + float(offset[1]), score, score - runner_up, inside,
                        above_chance(score, area, sigma)))
    return out


def _along_lines(r: Result, area: int, sharp: bool) -> tuple[float, float]:
    """Sub-pixel offset (x, y) from the scores left and right, above and below; 0 where one of the two is absent."""
    def along(before: int, after: int) -> float:
        if NO_SCORE in (before, after):
            return 0.0
        return line_offset(before / area, r.score / area, after / area, "cone" if sharp else "parabola")

    return along(r.neighbours[3], r.neighbours[4]), along(r.neighbours[1], r.neighbours[6])
