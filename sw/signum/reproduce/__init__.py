"""`make reproduce`: every figure and table of the paper that this project can have, on one page, judged by its bars.

A module a group of figures; each has a `make` of the type `Maker`. `sections.py` lists them in the page's order.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from signum.boards.board import Board
from signum.report.page import Section

OpenBoard = Callable[[], Board]
"""Opens a new board of the kind the page is made on; use it in a `with`."""
Progress = Callable[[str, int | None], AbstractContextManager[Callable[[str], None]]]
"""Makes a progress line: (what, total) -> a call for every step, with a word on how it went."""
Maker = Callable[[OpenBoard, Path, int, bool, Progress], list[Section]]
"""(open_board, folder for what else is written, seed, quick, progress) -> sections whose bars are judged.

`quick` asks for a version of a few seconds, for tests: what it shows is the same, its bars are judged on less.
"""
