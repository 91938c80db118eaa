# SPDX-License-Identifier: Apache-2.0
"""A chase as a report: the fish's position in the picture, the follower's state, frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from signum.applications.follow.follower import State
from signum.applications.follow.judge import ChaseFigures, ChaseRow
from signum.applications.follow.pilot import Where
from signum.applications.follow.record import FollowRecord
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table

SHARE = {Where.MIDWATER: 95.0, Where.TERRAIN: 90.0}
"""Least share of the time, per cent, with the fish in the centre quarter."""


def follow_bars(where: Where, f: ChaseFigures) -> tuple[Bar, ...]:
    """The figures of a chase with their bounds."""
    return (Bar(f"{where}: time with the fish in the centre quarter, %", 100 * f.centred, ">=", SHARE[where]),
            Bar(f"{where}: longest time out of view without being reported lost, s", f.silent_s, "<=", 3.0))


def draw_chase(rows: Sequence[ChaseRow], size: tuple[int, int]) -> Figure:
    """The fish's true position in a picture of `size` (width, height) over time, and the states."""
    time = np.array([r.time for r in rows])
    drawn, axes = plt.subplots(3, 1, figsize=(9, 6), sharex=True, height_ratios=(3, 3, 1.4))
    for ax, values, length, label in zip(axes, ([r.true_x for r in rows], [r.true_y for r in rows]), size, "xy",
                                         strict=False):
        ax.axhspan(length / 4, 3 * length / 4, color="tab:green", alpha=0.12)
        ax.plot(time, values, lw=0.8)
        ax.set_ylim(0, length)
        ax.set_ylabel(f"{label} of the fish, px")
        ax.grid(alpha=0.3)
    _draw_states(axes[2], [(r.time, r.state) for r in rows])
    return drawn


def draw_states(states: Sequence[tuple[float, State]]) -> Figure:
    """The follower's state over time."""
    drawn, ax = plt.subplots(figsize=(9, 1.8))
    _draw_states(ax, states)
    return drawn


def _draw_states(ax: Axes, states: Sequence[tuple[float, State]]) -> None:
    order = list(reversed(State))
    ax.plot([t for t, _ in states], [order.index(s) for _, s in states], "|", ms=7, color="tab:blue")
    ax.set_yticks(range(len(order)), [str(s) for s in order])
    ax.set_ylim(-0.6, len(order) - 0.4)
    ax.set_xlabel("time, s")


def follow_section(title: str, about: str, record: FollowRecord, plotted: Figure, caption: str,
                   facts: Sequence[tuple[str, str]] = (), bars: tuple[Bar, ...] = ()) -> Section:
    """The section of a chase."""
    shares = [(f"of them {state}", f"{record.share(state):.1%}") for state in State]
    lines = [("frames", str(len(record.states))), *shares, *facts]
    key = "Windows: green not fish, red fish, orange changed, grey not measured; white: the centre quarter."
    return Section(title, paragraph(about) + plot(plotted, caption)
                   + row([figure(picture, words) for words, picture in record.shots]) + paragraph(key)
                   + table(("", ""), lines), bars)
