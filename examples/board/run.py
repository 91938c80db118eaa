# SPDX-License-Identifier: Apache-2.0
"""Simulates the `tiny` board with `test_whole_board`: `python examples/board/run.py`."""

from sim.testbench.runner import AXI_PORTS, simulate


def main() -> None:
    """Build the board, once, and run the test."""
    simulate("slog_board", "examples.board.test_whole_board", ports=AXI_PORTS)


if __name__ == "__main__":
    main()
