# SPDX-License-Identifier: Apache-2.0
"""A hold as a report: plots of position, heading, range and confidence, frames, figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from signum.applications.hold.judge import HoldFigures
from signum.common.arrays import Floats, Image
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table


def draw_series(series: Floats) -> Figure:
    """Position, heading, range and confidence over time.

    Args:
        series: as `HoldRecord.series`: (n, 6), or (n, 10) with the truth, which is drawn grey beneath.
    """
    time, ok = series[:, 0], series[:, 5] > 0
    shown = np.where(ok[:, None], series[:, 1:5], np.nan)
    drawn, axes = plt.subplots(4, 1, figsize=(9, 8), sharex=True, height_ratios=(3, 2, 2, 1))
    labels = ((100, ("ahead", "right"), (0, 1), "position, cm"), (180 / np.pi, ("heading",), (2,), "heading, degrees"),
              (1, ("range",), (3,), "range, m"))
    for ax, (scale, names, columns, label) in zip(axes, labels, strict=False):
        for name, column in zip(names, columns, strict=True):
            if series.shape[1] > 6:
                ax.plot(time, scale * series[:, 6 + column], color="0.7", lw=2.2)
            ax.plot(time, scale * shown[:, column], lw=0.8, label=name)
        ax.set_ylabel(label)
        ax.legend(loc="upper right", fontsize=8)
        ax.grid(alpha=0.3)
    axes[3].plot(time, series[:, 5], color="tab:green", lw=0.8)
    axes[3].set_ylabel("confidence")
    axes[3].set_ylim(-5, 105)
    axes[3].set_xlabel("time, s")
    return drawn


def hold_bars(f: HoldFigures) -> tuple[Bar, ...]:
    """The figures of a hold with their bounds."""
    return (Bar("position RMS, cm", 100 * f.rms_m, "<=", 2.0),
            Bar("heading RMS, degrees", float(np.degrees(f.heading_rms)), "<=", 0.5),
            Bar("range kept, RMS, %", 100 * f.range_rms, "<=", 1.0),
            Bar("range measured, RMS error, %", 100 * f.range_miss, "<=", 1.0),
            Bar("drift, mean of the last minute less that of the first, mm", 1000 * f.drift_m, "<=", 5.0),
            Bar("wrong readings called valid", f.wrong, "<=", 0))


def hold_section(title: str, about: str, series: Floats, shots: Sequence[tuple[str, Image]],
                 bars: tuple[Bar, ...] = (), counts: tuple[int, int] | None = None) -> Section:
    """The section of a hold.

    Args:
        series: as `HoldRecord.series`; shots: as `HoldRecord.shots`.
        counts: frames, and those with a reading, where the series has not all of them.
    """
    ok = series[:, 5] > 0
    frames, valid = counts or (len(series), int(ok.sum()))
    facts = [("frames", str(frames)), ("with a reading", f"{valid / frames:.1%}"),
             ("median confidence of those", f"{np.median(series[ok, 5]):.0f}" if ok.any() else "-")]
    grey = ", the truth in grey" if series.shape[1] > 6 else ""
    return Section(title, paragraph(about) + plot(draw_series(series), f"Readings{grey}.")
                   + row([figure(picture, caption) for caption, picture in shots]) + table(("", ""), facts), bars)
