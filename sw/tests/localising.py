# SPDX-License-Identifier: Apache-2.0
"""Small views localised in a mosaic without a prior, clear and as the paper's figure 8 degrades them, held to bars;
`make navigate-bars`.

    python -m tests.localising [--views 200] [--seed 1]

Each mosaic is of 1600x1200 pixels, of a photograph enlarged, one of them out of focus; it is blurred, as overlapping
frames make it, and has noise of its own. A view of 384x256 lies anywhere in it, turned by up to 10 degrees, scaled by
0.9 to 1.1, with other noise. Views of the mirrored floor, a tenth as many, must not be found.
The bars: 95 % found in clear water, 75 % in murk, none wrong (by more than 8 pixels). The status is 1 if one is missed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

import cv2
import numpy as np

from signum.applications.navigate.chart import Chart
from signum.applications.navigate.localise import Localiser
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.world.degrade import degrade
from signum.world.seafloor import photograph

SIZE = (384, 256)
MOSAIC = (1600, 1200)
LARGEST = (640, 480)
WRONG_PX = 8.0
FLOORS = {"gravel": ("gravel", 3.3, 0.0), "grass": ("grass", 3.3, 0.0), "brick": ("brick", 3.3, 0.0),
          "soft gravel": ("gravel", 3.3, 1.5)}
"""Photograph, enlargement, and blur in pixels, by name. A smaller photograph would have to be shown several times."""
BARS = {False: 0.95, True: 0.75}
"""Least share found, clear and murky."""


def floor(name: str, seed: int) -> Image:
    """A floor, uint8 (1200, 1600): a part of the photograph."""
    photo, scale, blur = FLOORS[name]
    whole = photograph(photo, scale)
    if blur:
        whole = np.asarray(cv2.GaussianBlur(whole, (0, 0), blur), np.uint8)
    rng = np.random.default_rng([seed, list(FLOORS).index(name)])
    y, x = (int(rng.integers(0, n - m + 1)) for n, m in zip(whole.shape, MOSAIC[::-1], strict=True))
    return np.clip(whole[y:y + MOSAIC[1], x:x + MOSAIC[0]], 1, 255)


def mosaic(ground: Image, seed: int) -> Chart:
    """What a survey makes of a floor."""
    soft = cv2.GaussianBlur(ground, (0, 0), 0.8) + np.random.default_rng([seed, 5]).normal(0, 1.5, ground.shape)
    return Chart.of(np.asarray(np.clip(np.rint(soft), 1, 255), np.uint8))


def view(ground: Image, place: Similarity, murky: bool, seed: int) -> Image:
    """What a camera sees at a place: pixels of the view -> of the mosaic."""
    seen = cv2.warpAffine(ground, place.matrix, SIZE, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
    noisy = seen + np.random.default_rng(seed).normal(0, 2.0, seen.shape)
    image = np.asarray(np.clip(np.rint(noisy), 0, 255), np.uint8)
    return degrade(image, seed) if murky else image


def anywhere(rng: np.random.Generator) -> Similarity:
    """A place of a view that lies in the mosaic."""
    turn = Similarity.of(rng.uniform(-10, 10), rng.uniform(0.9, 1.1))
    room = 0.5 * 1.1 * np.hypot(*SIZE)
    at = complex(rng.uniform(room, MOSAIC[0] - room), rng.uniform(room, MOSAIC[1] - room))
    middle = complex((SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2)
    return Similarity(turn.factor, at - turn.factor * middle)


def judge(name: str, seed: int, views: int, murky: bool) -> tuple[int, int, Counter[str], float]:
    """Found rightly, found wrongly, why the others were not, and processor seconds a view; of views of the floor and a
    tenth as many of another."""
    ground = floor(name, seed)
    strange = np.ascontiguousarray(ground[:, ::-1])
    rng = np.random.default_rng([seed, 7])
    right = wrong = 0
    why: Counter[str] = Counter()
    middle = (np.array(SIZE) - 1) / 2
    with GoldenBoard() as board:
        localiser = Localiser(lambda s, sigma: Measurer(board, s, sigma), LARGEST, Fit(SIZE, SIZE),
                              mosaic(ground, seed))
        begun = time.process_time()
        for k in range(views + views // 10):
            place = anywhere(rng)
            found = localiser.locate(view(ground if k < views else strange, place, murky, 1000 * seed + k))
            if found.similarity is None:
                why[found.reason if k < views else "another floor"] += 1
            elif k < views and np.hypot(*(np.array(found.centre) - place(middle))) <= WRONG_PX:
                right += 1
            else:
                wrong += 1
        took = (time.process_time() - begun) / (views + views // 10)
    return right, wrong, why, took


def main(arguments: list[str] | None = None) -> int:
    """Localise, print and judge; 1 if a bar is missed."""
    parser = argparse.ArgumentParser(prog="make navigate-bars", description=__doc__)
    parser.add_argument("--views", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    kept = True
    for murky in (False, True):
        whole = false = count = 0
        for n, name in enumerate(FLOORS):
            views = given.views // len(FLOORS) + (n < given.views % len(FLOORS))
            right, wrong, why, took = judge(name, given.seed, views, murky)
            whole, false, count = whole + right, false + wrong, count + views
            print(f"{name}, {'figure 8' if murky else 'clear'}: {right} of {views} found, {wrong} wrong; "
                  f"{took:.2f} s a view; {dict(why)}", flush=True)
        good = whole >= BARS[murky] * count and not false
        kept &= good
        print(f"{'kept' if good else 'MISSED'}: {'figure 8' if murky else 'clear'}: {whole / count:.1%} found (bar "
              f"{BARS[murky]:.0%}), {false} wrong (bar 0)", flush=True)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
