# SPDX-License-Identifier: Apache-2.0
"""Two frames into the Verilated board, a grid of jobs, and the results with sub-pixel offsets.

`python examples/grid.py` runs the RTL, `python examples/grid.py golden` the golden model: the same numbers.
"""

import sys

import cv2
import numpy as np

from signum import Job, Peak, grid, locate_peaks, open_board
from signum.world.seafloor import photograph

SIZE, SIGMA = (320, 240), 2.0
MOTION = 5.25, -3.5
"""True displacement of the picture from the first frame to the second, pixels right and down."""


def main(board_name: str = "verilated") -> list[Peak]:
    """Measure the displacement of twelve windows; returns their peaks."""
    photo = photograph("gravel")
    moved = cv2.warpAffine(photo, np.array([[1, 0, MOTION[0]], [0, 1, MOTION[1]]]), photo.shape[::-1])
    first, second = (picture[100:100 + SIZE[1], 100:100 + SIZE[0]] for picture in (photo, moved))

    # The template is 32x32 pixels at (16, 16) of slot 0. Offset (0, 0) lays it at (4, 4) of slot 1, so 25x25 offsets
    # search 12 pixels around its own place.
    job = Job(tpl_slot=0, tpl_x=16, tpl_y=16, width=32, height=32,
              search_slot=1, search_x=4, search_y=4, offsets_x=25, offsets_y=25)
    count, step = (4, 3), (84, 80)
    with open_board(board_name) as board:
        board.configure(SIZE, SIGMA)
        board.capture(0, np.ascontiguousarray(first))
        board.capture(1, np.ascontiguousarray(second))
        board.submit_grid(job, count, step)
        results = board.collect(count[0] * count[1])

    jobs = grid(job, count, step)
    peaks = locate_peaks(jobs, results, SIGMA)
    print("     x    y      dx     dy  score  runner-up  above chance   (true: dx, dy = 5.25, -3.50)")
    for one, peak in zip(jobs, peaks, strict=True):
        print(f"  {one.tpl_x:4d} {one.tpl_y:4d}  {peak.dx:6.2f} {peak.dy:6.2f}  {peak.score:5.3f}  "
              f"{peak.score - peak.margin:9.3f}  {peak.above_chance:12.1f}")
    return peaks


if __name__ == "__main__":
    main(*sys.argv[1:])
