# SPDX-License-Identifier: Apache-2.0
"""Station keeping (equations 2 to 7): ten minutes in a current with surge, a blocked view, a push out of view."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from signum.applications.hold.body_pid import Axes
from signum.applications.hold.judge import judge_hold_rows
from signum.applications.hold.page import hold_bars, hold_section
from signum.applications.hold.record import HoldRecord
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.applications.hold.tuning import PEAK, peaks
from signum.measure.measurer import Measurer
from signum.report.page import Bar, Section, paragraph, table
from signum.reproduce import CONTROL_SIGMA, OpenBoard, Progress


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """Station keeping under the paper's conditions, and the tuning of its controller."""
    seconds = 30.0 if quick else 600.0
    scenario = Scenario(seconds, occluded=(0.3 * seconds, 0.3 * seconds + 3), seed=seed,
                        shoved=None if quick else (400.0, 403.0))
    folder = out / "hold"
    folder.mkdir(parents=True, exist_ok=True)
    record, rows = HoldRecord(folder, True, often=seconds / 5), []
    try:
        with open_board() as board, progress("holding", round(seconds * scenario.rate)) as tell:
            for k, m in enumerate(simulate_hold(lambda size: Measurer(board, size, CONTROL_SIGMA), scenario)):
                record.add(str(k), m.time, m.reading, m.frame, m.features,
                           truth=(m.truth[0], m.truth[1], m.truth[3], m.range_m))
                rows.append(m.row)
                tell(f"confidence {m.reading.confidence}")
    finally:
        record.close()
    table_rows = np.array(rows)
    figures = judge_hold_rows(table_rows, 8.0 if quick else 10.0, scenario.apart)
    assert scenario.occluded is not None
    begin, end = scenario.occluded
    blind = table_rows[(table_rows[:, 0] > begin + 0.05) & (table_rows[:, 0] < end - 0.05)]
    away = np.hypot(blind[:, 1], blind[:, 2])
    last = table_rows[-50:]
    bars = (*hold_bars(figures), Bar("confidence while the view is blocked", float(blind[:, 9].max()), "<=", 0),
            Bar("farthest from the station in those 3 s, m", float(away.max()), "<=", 0.3),
            Bar("last 5 s: readings with confidence, share", float((last[:, 9] > 0).mean()), ">=", 1))
    about = (f"{seconds / 60:g} minutes 2 m above a floor with relief, current 0.2 m/s with surge, figure 8's loss of "
             f"contrast and light, 250 snow flakes in view, range by stereo once. From {begin:g} s the view is "
             "blocked for 3 s"
             + (f"; from {scenario.shoved[0]:g} s the vehicle is pushed with 36 N for 3 s, until its station is "
                "nearly or wholly out of sight" if scenario.shoved else "")
             + ". Position, heading and range are judged outside the 13 s that begin with each, wrong readings always.")
    return [hold_section("Station keeping", about, record.series, record.shots, bars), _tuning()]


def _tuning() -> Section:
    axes = Axes()
    lines, worst = [], 0.0
    for name, axis, gains in zip(("surge", "sway", "heave", "yaw"), axes.axes, axes.tuned, strict=True):
        found = peaks(axis, gains)
        worst = max(worst, *found)
        lines.append((name, *(f"{g:g}" for g in gains), *(f"{p:.2f}" for p in found)))
    heads = ("axis", "proportional", "integral", "rate", "peak of |1/(1+L)|", "peak of |L/(1+L)|")
    about = (f"One PID per axis, its integral gain as large as the peaks of sensitivity and complementary sensitivity "
             f"allow ({PEAK:g}), for the hull's inertia and drag, a thruster lag of 0.15 s and ten frames a second.")
    return Section("Station keeping: the controller's tuning", paragraph(about) + table(heads, lines),
                   (Bar("largest peak of the sensitivities", worst, "<=", PEAK + 0.02),))
