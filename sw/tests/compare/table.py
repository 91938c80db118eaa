# SPDX-License-Identifier: Apache-2.0
"""What is compared: a task's figures by method and water, with the best of each column marked."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from signum.common.arrays import Image
from signum.report.page import Section, paragraph, table
from signum.world.degrade import degrade

WATERS = "clear", "figure 8"
Tell = Callable[[str], None]
"""Called for every step, with a word on it."""


@dataclass(frozen=True)
class Column:
    """A figure: its name with the unit, how it is printed, and which of two is better; None if neither is."""

    name: str
    form: str
    better: Literal["less", "more"] | None = None


@dataclass
class Task:
    """A table in the making.

    Attributes:
        name: of the task.
        columns: its figures.
        rows: by (method, water), the figures, NaN where there are none.
        seconds: by method, processor time.
    """

    name: str
    columns: tuple[Column, ...]
    rows: dict[tuple[str, str], list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def timed(self, method: str) -> Iterator[None]:
        """Count the processor time of what is done within for a method."""
        begun = time.process_time()
        try:
            yield
        finally:
            self.seconds[method] = self.seconds.get(method, 0.0) + time.process_time() - begun

    def note(self, method: str, water: str, *figures: float) -> None:
        """Note a row."""
        self.rows[method, water] = [float(f) for f in figures]

    def best(self, water: str) -> list[set[str]]:
        """For each column, the methods that are best in it, as it is printed."""
        out = []
        for k, column in enumerate(self.columns):
            shown = {m: float(column.form.format(v[k]).rstrip("%")) for (m, w), v in self.rows.items()
                     if w == water and np.isfinite(v[k])}
            edge = (min if column.better == "less" else max)(shown.values(), default=float("nan"))
            out.append({m for m, v in shown.items() if v == edge} if column.better else set())
        return out

    def html(self) -> str:
        """The table; a star marks the best of each column in each water."""
        heads = ["method, water", *(c.name for c in self.columns), "processor s"]
        lines = []
        for water in WATERS:
            best = self.best(water)
            for (method, within), figures in self.rows.items():
                if within == water:
                    cells = ["" if np.isnan(v) else c.form.format(v) + (" *" if method in best[k] else "")
                             for k, (c, v) in enumerate(zip(self.columns, figures, strict=True))]
                    lines.append([f"{method}, {water}", *cells, f"{self.seconds.get(method, 0):.1f}"])
        return table(heads, lines)

    def section(self, text: str, pictures: str = "") -> Section:
        """The task on the page."""
        return Section(self.name, paragraph(text) + pictures + self.html())

    def lines(self) -> list[str]:
        """The table as text, a line a row."""
        return [f"{self.name}: {method}, {water}: " + "; ".join(
            f"{c.name} {'-' if np.isnan(v) else c.form.format(v)}" for c, v in zip(self.columns, figures, strict=True))
            for (method, water), figures in self.rows.items()]


def in_water(picture: Image, water: str, seed: int) -> Image:
    """A grey picture in clear water, or as figure 8 has it with snow of this seed."""
    return picture if water == WATERS[0] else degrade(picture, seed)


def rms(values: np.ndarray) -> float:
    """Root mean square; NaN without values."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")
