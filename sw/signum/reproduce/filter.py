# SPDX-License-Identifier: Apache-2.0
"""Figures 3 and 8: the stages of the filter, and the share of signs that stay the same in bad water."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from signum.boards.board import Board
from signum.common.arrays import Image
from signum.measure.measurer import Measurer
from signum.report.draw import stages
from signum.report.page import Bar, Section, figure, paragraph, row, table
from signum.reproduce import OpenBoard, Progress, figure8
from signum.world.degrade import degrade

STAGES_SIGMA = 2.5
JUDGED = "gravel", "grass"
JUDGED_SIGMA = 1.5
SNOWS = 16
"""Falls of snow over which a bar is judged."""


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """The filter's stages on one photograph; figure 8 on all that are at hand."""
    pictures = list(figure8.photographs())[:2 if quick else None]
    sigmas = (JUDGED_SIGMA,) if quick else figure8.SIGMAS
    snows = 3 if quick else SNOWS
    with open_board() as board, progress("filter", len(pictures) + len(JUDGED) * snows) as tell:
        first = pictures[0][1]
        measurer = Measurer(board, figure8.SIZE, STAGES_SIGMA)
        shown = stages(first, measurer.signs(measurer.view(first)), STAGES_SIGMA)
        example = _example(board, first, seed)
        rows = []
        for name, picture in pictures:
            rows += figure8.measure(board, name, picture, sigmas, seed)
            tell(name)
        bars = []
        for name in JUDGED:
            picture = dict(pictures)[name]
            falls = []
            for snow in range(snows):
                falls += figure8.measure(board, name, picture, [JUDGED_SIGMA], seed + snow)
                tell(f"{name}, snow {snow}")
            for part, least in (("whole", 0.90), ("inner", 0.95)):
                mean = float(np.mean([getattr(f, part) for f in falls]))
                bars.append(Bar(f"{name}, {part}: signs equal, mean of {snows} falls of snow", mean, ">=", least))
    values = {(r.picture, r.sigma): f"{r.whole:.3f} / {r.inner:.3f}" for r in rows}
    lines = [[name, *(values[name, s] for s in sigmas)] for name, _ in pictures]
    return [
        Section("Figure 3: the filter's stages", paragraph(
            f"Original, smoothed with sigma {STAGES_SIGMA:g}, Laplacian (mid grey is 0), sign. The board gives "
            "out only the sign.")
            + row([figure(picture, name) for name, picture in shown])),
        Section("Figure 8: signs in bad water", paragraph(
            "Contrast divided by 4, light that falls off with the radius, 250 white squares of snow. Share of signs "
            "that stay, all pixels / inner quarter, by sigma in pixels.")
            + row([figure(p, name) for name, p in example])
            + table(["picture", *(f"{s:g}" for s in sigmas)], lines), tuple(bars))]


def _example(board: Board, picture: Image, seed: int) -> list[tuple[str, Image]]:
    measurer = Measurer(board, figure8.SIZE, JUDGED_SIGMA)
    degraded = degrade(picture, seed)
    signs = [measurer.signs(measurer.view(p)) * np.uint8(255) for p in (picture, degraded)]
    return [("original", picture), ("its signs", signs[0]), ("degraded", degraded), ("its signs", signs[1])]
