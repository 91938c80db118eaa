# SPDX-License-Identifier: Apache-2.0
"""Boards by name; the back ends are listed here and nowhere else."""

from __future__ import annotations

from golden.params import FULL, Config
from signum.boards.board import Board
from signum.boards.golden import GoldenBoard
from signum.common.errors import lacking

BOARDS = "golden", "verilated"


def open_board(name: str, config: Config = FULL) -> Board:
    """A board, to be closed after use (or used in a `with`).

    Args:
        name: `golden`, the model, or `verilated`, the RTL.
        config: the build: FULL, DENSE with the dense engine, or TINY and TINY_DENSE for quick tests.

    Raises:
        ValueError: for an unknown name.
        BoardError: if the back end cannot be started.
        SignumError: if the extra that the back end needs is not installed.
    """
    if name == "golden":
        return GoldenBoard(config)
    if name == "verilated":
        try:
            from signum.boards.verilated import VerilatedBoard  # loads the simulation, which the golden board needs not

            return VerilatedBoard(config)
        except ModuleNotFoundError as error:
            raise lacking("rtl", error) from error
    raise ValueError(f"board {name!r}: one of {', '.join(BOARDS)}")
