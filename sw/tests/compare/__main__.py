# SPDX-License-Identifier: Apache-2.0
"""`make compare`: Signum beside OpenCV's methods on the same frames, on one page.

    python -m tests.compare [--seed 1] [--out out/compare] [--quick] [--only flow]

Flow, tracks, registration, mosaics and stereo, on rendered frames and photographs with their truth, and on real surveys
where they lie beside the project; in clear water, and as the paper's figure 8 has them. No bars: the best of each
column is marked, whoever it is. Frames and snow depend on the seed alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import cv2

from signum.common.console import out, progress
from signum.report.page import Section, paragraph, table, write_page
from signum.tables.table import csv_line
from tests.compare.flows import compare_flow
from tests.compare.mosaics import compare_mosaics, compare_real_mosaics
from tests.compare.ranges import compare_stereo
from tests.compare.registers import compare_pairs, compare_real
from tests.compare.table import Task, Tell
from tests.compare.walks import compare_tracks
from tests.speed import processor

Parts = list[tuple[Task | None, Section]]


def _pairs(seed: int, quick: bool, tell: Tell) -> Parts:
    return [compare_pairs(seed, quick, tell), *compare_real(seed, quick, tell)]


def _mosaics(seed: int, quick: bool, tell: Tell) -> Parts:
    real = compare_real_mosaics(seed, quick, tell)
    return [compare_mosaics(seed, quick, tell), *([(None, real)] if real else [])]


TASKS: dict[str, Callable[[int, bool, Tell], Parts]] = {
    "flow": lambda *given: [compare_flow(*given)], "tracks": lambda *given: [compare_tracks(*given)], "pairs": _pairs,
    "mosaics": _mosaics, "stereo": lambda *given: [*compare_stereo(*given)]}
"""By name, in the order of the page."""


def make_page(chosen: list[str], folder: Path, seed: int, quick: bool) -> list[Task]:
    """Make the page and `results.csv`; returns the tables."""
    folder.mkdir(parents=True, exist_ok=True)
    sections: list[Section] = []
    tasks: list[Task] = []
    begun = time.monotonic()
    for name in chosen:
        with progress(name, None) as tell:
            for task, section in TASKS[name](seed, quick, tell):
                sections.append(section)
                if task is not None:
                    tasks.append(task)
                    for line in task.lines():
                        out.print(line, markup=False)
        _write(folder, sections, tasks, seed, quick, time.monotonic() - begun)
    return tasks


def _write(folder: Path, sections: list[Section], tasks: list[Task], seed: int, quick: bool, seconds: float) -> None:
    part = "PYTHONPATH=sw python -m tests.compare"
    command = f"{part} --quick --seed {seed}" if quick else f"make compare SEED={seed}"
    about = ("Signum's golden board (its RTL gives the same bits) beside OpenCV's methods, on the same frames, in "
             "clear water and as the paper's figure 8 degrades them: contrast divided by 4, light that falls off from "
             "the middle, 250 flakes of snow. A star marks the best of each column in each water. SIFT is a rival "
             "here, and a reference for real surveys; Signum does not use it.")
    head = table(("", ""), [
        ("command", command), ("one part of it", f"{part} --only flow --seed {seed}"),
        ("seed", str(seed)), ("OpenCV", cv2.__version__), ("processor", processor()),
        ("duration", f"{seconds / 60:.1f} min")])
    write_page(folder / "index.html", "Signum beside other methods", sections, paragraph(about) + head)
    rows = [csv_line(["task", "method", "water", "figure", "value"])]
    rows += [csv_line([task.name, method, water, column.name, f"{value:.6g}"]) for task in tasks
             for (method, water), figures in task.rows.items()
             for column, value in zip(task.columns, figures, strict=True)]
    (folder / "results.csv").write_text("".join(rows), encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Make the page; returns the exit status."""
    parser = argparse.ArgumentParser(prog="make compare", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out/compare"), help="folder; made if missing")
    parser.add_argument("--quick", action="store_true", help="a short version of some seconds, for the tests")
    parser.add_argument("--only", action="append", choices=tuple(TASKS), help="make only this part; may be repeated")
    given = parser.parse_args(arguments)
    out.print(f"seed {given.seed}")
    make_page([name for name in TASKS if name in (given.only or TASKS)], given.out, given.seed, given.quick)
    out.print(f"{given.out / 'index.html'}", markup=False)
    return 0


if __name__ == "__main__":
    sys.exit(main())
