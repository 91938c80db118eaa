# SPDX-License-Identifier: Apache-2.0
"""Holds merged coverage to its bars."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from sim.coverage.functional import Functional
from sim.coverage.points import KINDS, Point

BARS = {"toggle": 98.0, "branch": 100.0, "line": 100.0, "functional": 100.0}
"""Least share of the points hit, percent, exclusions apart."""
MOST_EXCLUDED = 3.0
"""Largest share of all points that may be excluded, percent; generated sources apart."""


@dataclass
class Verdict:
    """Coverage of the sources that are not generated, and whatever is wrong with it.

    Attributes:
        hit, total: points hit and points that count, by kind.
        excluded: points excluded with a reason, by kind.
        missing: points not hit.
        unmet: what the regression did not meet, as (group, what).
        faults: sentences; none if every bar is reached.
    """

    hit: Counter[str] = field(default_factory=Counter)
    total: Counter[str] = field(default_factory=Counter)
    excluded: Counter[str] = field(default_factory=Counter)
    missing: list[Point] = field(default_factory=list)
    unmet: list[tuple[str, str]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def share(self, kind: str) -> float:
        """Percent of the points of a kind that were hit; 100 if there are none."""
        return 100.0 * self.hit[kind] / self.total[kind] if self.total[kind] else 100.0


def judge(hits: Mapping[Point, int], reasons: Mapping[Point, str], functional: Functional,
          plan: Mapping[tuple[str, str], str]) -> Verdict:
    """Compare hits with the bars.

    Args:
        hits: of all points.
        reasons: of the excluded points.
        functional: what the tests counted.
        plan: what they must have met, with the reason of what cannot be met.
    """
    verdict = Verdict()
    for point, count in sorted(hits.items()):
        if point.generated:
            continue
        if point in reasons:
            verdict.excluded[point.kind] += 1
            if count:
                verdict.faults.append(f"{point.file.name}:{point.line}: {point.name} is excluded, but was hit")
            continue
        verdict.total[point.kind] += 1
        verdict.hit[point.kind] += bool(count)
        if not count:
            verdict.missing.append(point)
    _judge_functional(verdict, functional, plan)
    everything = sum(verdict.total[kind] + verdict.excluded[kind] for kind in KINDS)
    excluded = sum(verdict.excluded[kind] for kind in KINDS)
    if 100.0 * excluded > MOST_EXCLUDED * everything:
        verdict.faults.append(f"{excluded} of {everything} points are excluded: at most {MOST_EXCLUDED:g} % may be")
    if not everything or not functional.clocks:
        verdict.faults.append("nothing was recorded")
    for kind, bar in BARS.items():
        if verdict.share(kind) < bar:
            verdict.faults.append(f"{kind}: {verdict.share(kind):.2f} % of {verdict.total[kind]} points, at least "
                                  f"{bar:g} % needed")
    return verdict


def _judge_functional(verdict: Verdict, functional: Functional, plan: Mapping[tuple[str, str], str]) -> None:
    for key, reason in plan.items():
        if reason:
            verdict.excluded["functional"] += 1
            if functional.counts[key]:
                verdict.faults.append(f"{': '.join(key)}: was met, but cannot be for the reason given")
            continue
        verdict.total["functional"] += 1
        verdict.hit["functional"] += bool(functional.counts[key])
        if not functional.counts[key]:
            verdict.unmet.append(key)
    groups = {group for group, _ in plan}
    for group, what in functional.counts:
        if (group in groups or group.startswith("stalls of ")) and (group, what) not in plan:
            verdict.faults.append(f"{group}: {what}: is counted, but not in the plan")
