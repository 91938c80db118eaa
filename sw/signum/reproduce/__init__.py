# SPDX-License-Identifier: Apache-2.0
"""`make reproduce`: every figure and table of the paper that this project can have, on one page, judged by its bars.

Each module has a group of figures and a function `make` of the type `Maker`, which `makers.py` lists in the order of
the page.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from signum.boards.board import Board
from signum.report.page import Section

CONTROL_SIGMA = 2.0
"""Width of the LoG's Gaussian in the closed loops, pixels."""
OpenBoard = Callable[[], Board]
"""Opens a new board of the kind with which the page is made; use it in a `with`."""
Progress = Callable[[str, int | None], AbstractContextManager[Callable[[str], None]]]
"""Makes a progress line: (what, total) -> a call for every step, with a word on how it went."""
Maker = Callable[[OpenBoard, Path, int, bool, Progress], list[Section]]
"""(open_board, folder for further files, seed, quick, progress) -> sections with bars.

`quick` selects a version of a few seconds, for tests: it shows the same, and its bars are judged on less data.
"""
