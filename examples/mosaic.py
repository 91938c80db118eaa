# SPDX-License-Identifier: Apache-2.0
"""A mosaic from a folder of overlapping pictures: `python examples/mosaic.py survey/ out/mosaic`.

Writes mosaic.png, poses.csv and edges.csv into the output folder.
"""

import sys
from pathlib import Path

from signum import Fit, Measurer, Registrar, Survey, open_board, open_source

WINDOW, SIGMA = 32, 2.0


def main(folder: str, out: str = "out/mosaic", board_name: str = "golden") -> int:
    """Build the mosaic; returns the number of frames in its largest component."""
    source = open_source(folder)
    Path(out).mkdir(parents=True, exist_ok=True)
    with open_board(board_name) as board:
        first = next(iter(source))
        fit = Fit.to(first.size, board.config, WINDOW)
        registrar = Registrar.on(lambda size, sigma: Measurer(board, size, sigma), fit, WINDOW, SIGMA)
        with Survey(registrar, Path(out), stream=not source.snapshots, source=source.label) as survey:
            for frame in source:
                print(frame.name, survey.add(frame))  # against the frame before, and placed
            survey.settle()
            for step in survey.finish():  # against every neighbour that the poses predict
                print(step)
        largest = len(survey.ranked()[0].stored)
    accepted = sum(edge.accepted for edge in survey.edges)
    print(f"{out}/mosaic.png: {largest} frames, {accepted} of {len(survey.edges)} edges accepted")
    return largest


if __name__ == "__main__":
    main(*sys.argv[1:])
