# SPDX-License-Identifier: Apache-2.0
"""Object following (figure 9's task): a fish in midwater by range, and over terrain by motion; lost and found again."""

from __future__ import annotations

from math import degrees
from pathlib import Path

from signum.applications.follow.follower import State
from signum.applications.follow.judge import ChaseRow, judge_chase
from signum.applications.follow.page import draw_chase, follow_bars, follow_section
from signum.applications.follow.pilot import Where
from signum.applications.follow.record import FollowRecord
from signum.applications.follow.simulate import Chase, simulate_chase
from signum.measure.measurer import Measurer
from signum.report.page import Bar, Section
from signum.reproduce import CONTROL_SIGMA, OpenBoard, Progress
from signum.world.camera import Pinhole

HOW = {Where.MIDWATER: "segmented by stereo range: nearer than 4 m is fish",
       Where.TERRAIN: "segmented by motion: what departs from the dominant motion of the picture is fish"}


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """A long chase in midwater and over terrain, and a short one of each in which the fish darts out of view."""
    sections = []
    for where in Where:
        sections.append(_chase(open_board, out, Chase(where, 12.0 if quick else 300.0, seed=seed), progress))
        if not quick:
            dart = (0.0, 3.0, 0.0) if where is Where.MIDWATER else (2.0, 2.0, 0.0)
            sections.append(_chase(open_board, out, Chase(where, 45.0, darts=(10.0,), dart=dart, seed=seed), progress))
    return sections


def _chase(open_board: OpenBoard, out: Path, chase: Chase, progress: Progress) -> Section:
    camera, rows = Pinhole(), []
    folder = out / f"follow_{chase.where}{'_dart' if chase.darts else ''}"
    folder.mkdir(parents=True, exist_ok=True)
    record = FollowRecord(folder, True, chase.rate, often=chase.seconds / 7)
    try:
        with open_board() as board, progress(f"following, {chase.where}", round(chase.seconds * chase.rate)) as tell:
            for k, g in enumerate(simulate_chase(lambda size: Measurer(board, size, CONTROL_SIGMA), chase, camera)):
                record.add(str(k), g.time, g.target, g.frame,
                           truth=(*g.truth, g.range_m, *(degrees(a) for a in g.head)))
                rows.append(g.row(camera))
                tell(str(g.target.state))
    finally:
        record.close()
    f = judge_chase(rows, chase.rate)
    facts = [("in view", f"{f.in_view:.1%}"), ("found again", str(f.finds)),
             ("longest time lost, s", f"{f.longest_lost_s:.1f}"), ("target off the fish", f"{f.wrong:.1%}")]
    about = f"A fish that swims, turns and stops, in turbid water with snow; {HOW[chase.where]}. "
    drawn, caption = draw_chase(rows, camera.size), "True position of the fish; green: the centre quarter."
    if not chase.darts:
        about += f"{chase.seconds:g} s; a pan/tilt follows the fish, the vehicle follows the pan/tilt."
        return follow_section(f"Following, {chase.where}", about, record, drawn, caption, facts,
                              follow_bars(chase.where, f))
    about += f"At {chase.darts[0]:g} s it darts out of view."
    return follow_section(f"Following, {chase.where}: lost and found", about, record, drawn, caption, facts,
                          dart_bars(chase, rows))


def dart_bars(chase: Chase, rows: list[ChaseRow]) -> tuple[Bar, ...]:
    """The target is reported as lost after the fish darted, and followed again at the end."""
    after = [r for r in rows if r.time >= chase.darts[0]]
    last = [r for r in rows if r.time >= chase.seconds - 5]
    return (Bar(f"{chase.where}: reported as lost after it darted, frames", sum(r.state is State.LOST for r in after),
                ">=", 1),
            Bar(f"{chase.where}: last 5 s, fish in the centre quarter, share", sum(r.centred for r in last) / len(last),
                ">=", 0.9))
