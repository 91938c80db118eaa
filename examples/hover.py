# SPDX-License-Identifier: Apache-2.0
"""Hover: frames in, metres out. The first frame is the station; every later one is measured against it.

`python examples/hover.py` flies a simulated camera; `python examples/hover.py dive.mp4 700 1.5` measures a video of a
camera that looks down, focal length 700 pixels, 1.5 m over the floor in the first frame.
"""

import sys
from itertools import chain

from signum import Fit, Measurer, Reading, open_board, open_source
from signum.applications.hold.watch import watch_station

WINDOW, SIGMA, RATE = 64, 2.0, 5.0


def main(source: str = "world:frames=8,water=coastal", focal: str = "400", range_m: str = "2.0",
         board_name: str = "golden") -> list[Reading]:
    """Print the offset of each frame from the first; returns the readings."""
    readings = []
    with open_board(board_name) as board:
        frames = iter(open_source(source))
        first = next(frames)
        fit = Fit.to(first.size, board.config, WINDOW)  # larger frames are scaled down for the board
        measurer = Measurer(board, fit.board, SIGMA)
        print("frame  ahead m  right m  heading deg  range m  confidence %")
        for seen in watch_station(measurer, chain([first], frames), fit, float(focal), float(range_m), RATE, WINDOW):
            r = seen.reading
            readings.append(r)
            if r.valid:
                print(f"{seen.name:>5}  {r.forward:7.3f}  {r.right:7.3f}  {r.heading * 57.2958:11.2f}  {r.range_m:7.3f}"
                      f"  {r.confidence:12d}")
            else:
                print(f"{seen.name:>5}  no reading: {r.agreed} of {r.tried} windows agree")
    return readings


if __name__ == "__main__":
    main(*sys.argv[1:])
