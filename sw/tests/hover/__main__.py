# SPDX-License-Identifier: Apache-2.0
"""A hover that holds and recovers, held to its bars on rendered clips; `make hover`.

    python -m tests.hover [--seeds 60,61,62] [--floors gravel,world:grass] [--frames 150] [--blind 60,90]

Every floor with every event and seed, in murky water; the status is 1 if a bar is missed. Times are of processor time a
frame, the rendering of the clip included.
"""

from __future__ import annotations

import argparse
import itertools

import numpy as np

from signum.boards.golden import GoldenBoard
from tests.hover.bars import Figures, measure
from tests.hover.clips import BLIND, EVENTS, FLOORS, Clip


def main() -> int:
    """Measure and print; returns the exit status."""
    parser = argparse.ArgumentParser(description="Hover clips against their bars.")
    parser.add_argument("--seeds", default="60,61,62",
                        help="of the clips; 0 to 9, 20, 21, 50 and 51 were used for development")
    parser.add_argument("--floors", default=",".join(FLOORS))
    parser.add_argument("--events", default=",".join(EVENTS))
    parser.add_argument("--frames", type=int, default=150)
    parser.add_argument("--blind", default=",".join(map(str, BLIND)), help="first frame of the disturbance, and the "
                        "first after it")
    options = parser.parse_args()
    begin, end = map(int, options.blind.split(","))
    seeds, floors, events = (getattr(options, name).split(",") for name in ("seeds", "floors", "events"))
    total = Figures()
    with GoldenBoard() as board:
        for floor, event, seed in itertools.product(floors, events, map(int, seeds)):
            clip = Clip(floor, event, seed, options.frames, blind=(begin, end))
            found = measure(board, clip)
            total += found
            metres, turn, scale = found.worst
            print(f"{clip.name}: {found.read} of {found.due} frames due read, {found.good} good, {found.valid} valid, "
                  f"{found.wrong} wrong, back after {found.returns or '-'}; worst {100 * metres:.1f} cm, "
                  f"{np.degrees(turn):.2f} degrees, {100 * scale:.2f} %" + ("" if found.met else "  MISSED"),
                  flush=True)
    for name, value, relation, bound in total.bars:
        print(f"{name}: {value:.2f} (bar {relation} {bound:g})")
    print(f"processor time a frame: {np.median(total.calm_ms):.0f} ms with a reading"
          + (f", {np.median(total.lost_ms):.0f} ms without" if total.lost_ms else ""))
    return 0 if total.met else 1


if __name__ == "__main__":
    raise SystemExit(main())
