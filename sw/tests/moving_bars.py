# SPDX-License-Identifier: Apache-2.0
"""How well `segment_moving` finds what moves by itself, clean and as figure 8 degrades it; `make moving-bars`.

    python -m tests.moving_bars [--seed 1] [--scenes 24]

Photographs turn by up to 2 degrees, zoom by up to 2 % and shift by up to 6 px; a square or an ellipse cut from another
one moves by 4 to 9 px otherwise, and turns by up to 1.5 degrees. Of things of 96, 128 and 160 px at least 95 % are
found with an intersection over union of 0.7 or more, their own motion within 1 px, and nothing else. Where nothing
moves by itself nothing is found. Things of 48 and 64 px are without a bar, and under figure 8 those of which it leaves
most without a grey level of texture: bricks, a cup. The status is 1 if a bar is missed.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from tests.measure.movers import moving_figures, scene, segmented

HELD, OTHERS = (96, 128, 160), (48, 64)
SHARE, OVERLAP, OFF_PX = 0.95, 0.7, 1.0


def judge_things(first: int, scenes: int, side: int, murky: bool) -> tuple[bool, str]:
    """Whether things of a side meet the bar, and the figures of all in words."""
    seen = [scene(seed, side, murky) for seed in range(first, first + scenes)]
    held = [not (murky and one.plain) for one in seen]
    figures = [moving_figures(one) for one in seen]
    good = [f.overlap >= OVERLAP and f.off_px <= OFF_PX for f in figures]
    false = [one.label for one, f in zip(seen, figures, strict=True) if f.false]
    found = [f for f in figures if f.overlap > 0]
    under = [well for well, counts in zip(good, held, strict=True) if counts]
    words = f"{sum(under)} of {len(under)} good"
    words += f", and {sum(good) - sum(under)} of {scenes - len(under)} plain ones" if len(under) < scenes else ""
    words += f"; {len(found)} found"
    if found:
        overlap, off, edge = ([getattr(f, name) for f in found] for name in ("overlap", "off_px", "edge_px"))
        words += (f"; overlap: median {np.median(overlap):.2f}, least {min(overlap):.2f}; own motion off by "
                  f"{np.median(off):.2f} px, at most {max(off):.2f}; outline off by {np.median(edge):.1f} px, at most "
                  f"{max(edge):.1f}")
    poor = [one.label for one, well in zip(seen, good, strict=True) if not well]
    for what, which in (("not good", poor), ("false", false)):
        words += f"\n    {what}: {', '.join(which)}" if which else ""
    return sum(under) >= SHARE * len(under) and not false, words


def judge_none(first: int, scenes: int, murky: bool) -> tuple[bool, str]:
    """Whether nothing is found where nothing moves by itself, and what was found, in words."""
    wrong = []
    for seed in range(first, first + scenes):
        seen = scene(seed, None, murky)
        objects = segmented(seen.before, seen.after).objects
        if objects:
            wrong.append(f"{seen.label} ({', '.join(str(one.area) for one in objects)} px)")
    return not wrong, f"{len(wrong)} of {scenes} scenes with a false object {', '.join(wrong)}".strip()


def main(arguments: list[str] | None = None) -> int:
    """Measure, print and judge; 1 if a bar is missed."""
    parser = argparse.ArgumentParser(prog="make moving-bars", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=24)
    given = parser.parse_args(arguments)
    first, missed = 1000 * given.seed, 0
    for murky in (False, True):
        water = "figure 8" if murky else "clean"
        met, words = judge_none(first, 2 * given.scenes, murky)
        missed += not met
        print(f"{'met' if met else 'MISSED'}: nothing moves, {water}: {words}", flush=True)
        for side in (*HELD, *OTHERS):
            met, words = judge_things(first, given.scenes, side, murky)
            held = side in HELD
            missed += held and not met
            print(f"{('met' if met else 'MISSED') if held else 'no bar'}: {side} px, {water}: {words}", flush=True)
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
