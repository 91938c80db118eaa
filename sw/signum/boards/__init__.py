"""Boards by name: the one place that knows which back ends there are."""

from __future__ import annotations

from golden.params import FULL, Config
from signum.boards.board import Board
from signum.boards.golden import GoldenBoard

BOARDS = "golden", "verilated"


def open_board(name: str, config: Config = FULL) -> Board:
    """A board, to be closed after use (or used in a `with`).

    Args:
        name: one of BOARDS.
        config: the build.

    Raises:
        ValueError: for another name.
        BoardError: if the back end cannot be started.
    """
    if name == "golden":
        return GoldenBoard(config)
    if name == "verilated":
        from signum.boards.verilated import VerilatedBoard  # builds on first use: not needed for the golden board

        return VerilatedBoard(config)
    raise ValueError(f"board {name!r}: one of {', '.join(BOARDS)}")
