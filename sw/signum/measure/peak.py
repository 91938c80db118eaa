# SPDX-License-Identifier: Apache-2.0
"""Converts job results to displacements in pixels and scores 0..1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from golden.correlate import Job, Result, Status
from golden.tables import jobs_table, results_table
from signum.measure.batch import Peaks
from signum.measure.subpixel import PeakFit


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
    p = Peaks.of(jobs_table(jobs), results_table(results), sigma, fit)
    rows = zip(results, p.dx.tolist(), p.dy.tolist(), p.score.tolist(), p.margin.tolist(), p.inside.tolist(),
               p.above_chance.tolist(), strict=True)
    return [Peak(result.status, *values) for result, *values in rows]
