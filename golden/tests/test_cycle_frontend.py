# SPDX-License-Identifier: Apache-2.0
"""The front end's cycle model against the frame-level LoG, on good and bad streams."""

from __future__ import annotations

import random

import pytest

from golden.cycle.frontend.frontend import FrontendModel
from golden.cycle.model import run_model
from golden.log import kernels
from golden.params import TINY
from golden.traffic.stalls import SHAPES, ready_pattern
from golden.traffic.video import BAD_KINDS, Item, VideoRecord, bad, good, play, settings_of, stray, texture

R = TINY.radius


def _run(items: list[Item], width: int, height: int, sigma: float, shape: str, seed: int) -> VideoRecord:
    g, g2 = kernels(sigma, R)
    rng = random.Random(seed)
    seen = VideoRecord(TINY.group_bits, width)
    model = FrontendModel(TINY.max_width, R, TINY.group_bits)
    run_model(model, play(items, settings_of(width, height, g, g2), ready_pattern(shape, rng), rng), seen.observe)
    seen.check(items, g, g2)
    return seen


@pytest.mark.parametrize(("width", "height", "sigma"), [(18, 18, 1.0), (19, 21, 2.5), (48, 18, 4.0), (37, 36, 1.5)])
def test_good_frames(width: int, height: int, sigma: float) -> None:
    rng = random.Random(width)
    items = [good(texture(rng, width, height)) for _ in range(3)]
    assert _run(items, width, height, sigma, "none", 1).stalled == 0


@pytest.mark.parametrize("shape", SHAPES)
def test_bad_frames(shape: str) -> None:
    rng = random.Random(7)
    width, height = 23, 19
    items = []
    for kind in BAD_KINDS:
        items += [good(texture(rng, width, height)), bad(kind, texture(rng, width, height), rng)]
    items += [good(texture(rng, width, height)), stray(rng, 40), good(texture(rng, width, height))]
    _run(items, width, height, 2.0, shape, 3)
