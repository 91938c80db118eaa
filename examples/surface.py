# SPDX-License-Identifier: Apache-2.0
"""A correlation surface drawn: the score of every offset of one window, with its peak marked.

`python examples/surface.py surface.png` writes the picture. Chance is 0.5: a window of unrelated signs matches half.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from signum import Job, open_board
from signum.world.seafloor import photograph

SIZE = 256, 192


def main(path: str = "surface.png", board_name: str = "golden") -> tuple[int, int]:
    """Draw the surface into `path`; returns the displacement (dx, dy) at its peak, whole pixels."""
    photo = photograph("gravel")
    before, after = photo[100:292, 100:356], photo[107:299, 89:345]  # the picture moves by (+11, -7)
    job = Job(tpl_slot=0, tpl_x=104, tpl_y=72, width=48, height=48,
              search_slot=1, search_x=72, search_y=40, offsets_x=65, offsets_y=65)
    with open_board(board_name) as board:
        board.configure(SIZE, sigma=2.0)
        board.capture(0, np.ascontiguousarray(before))
        board.capture(1, np.ascontiguousarray(after))
        result, surface = board.surface(job)

    score = surface / (job.width * job.height)
    left, top = job.search_x - job.tpl_x, job.search_y - job.tpl_y
    dx, dy = left + result.best_x, top + result.best_y
    figure, axes = plt.subplots(figsize=(5.2, 4.2), layout="constrained")
    shown = axes.imshow(score, vmin=0.4, vmax=1, extent=(left - 0.5, left + 64.5, top + 64.5, top - 0.5))
    axes.plot(dx, dy, "o", mfc="none", mec="red", ms=14)
    axes.set(xlabel="displacement right, pixels", ylabel="displacement down, pixels",
             title=f"Best {score.max():.2f} at ({dx}, {dy}); runner-up "
                   f"{result.runner_up / (job.width * job.height):.2f}")
    figure.colorbar(shown, label="matching fraction")
    figure.savefig(Path(path), dpi=80)
    plt.close(figure)
    print(f"{path}: peak at ({dx}, {dy})")
    return dx, dy


if __name__ == "__main__":
    main(*sys.argv[1:])
