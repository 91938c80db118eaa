# SPDX-License-Identifier: Apache-2.0
"""Optical flow against known shifts, clean and under the paper's degradation."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from signum.boards.golden import GoldenBoard
from signum.measure.flow import measure_flow
from signum.measure.measurer import Measurer
from signum.report.draw import draw_flow
from signum.world.degrade import degrade
from signum.world.seafloor import photograph

SIZE = (384, 288)


@pytest.mark.parametrize("name", ["gravel", "grass"])
@pytest.mark.parametrize(("degraded", "bar"), [(False, 0.1), (True, 0.25)])
def test_shifts(name: str, degraded: bool, bar: float) -> None:
    rng = np.random.default_rng(4)
    photo = photograph(name).astype(np.float32)
    squares, shares = [], []
    for k in range(3):
        shift = rng.uniform(-8, 8, 2)
        a, b = (np.asarray(np.clip(cv2.warpAffine(photo, np.array([[1, 0, x - 60], [0, 1, y - 60]]), SIZE,
                                                  flags=cv2.INTER_CUBIC), 0, 255), np.uint8)
                for x, y in ((0.0, 0.0), shift))
        if degraded:
            a, b = degrade(a, seed=2 * k), degrade(b, seed=2 * k + 1)
        measurer = Measurer(GoldenBoard(), SIZE, 1.5)
        field = measure_flow(measurer, measurer.view(a), measurer.view(b), support=1)
        squares.append(((field.dx - shift[0]) ** 2 + (field.dy - shift[1]) ** 2)[field.valid])
        shares.append(field.valid.mean())
        assert field.dominant() == pytest.approx(tuple(shift), abs=bar)
    rms = float(np.sqrt(np.concatenate(squares).mean()))
    print(f"{name}, {'degraded' if degraded else 'clean'}: RMS {rms:.3f} px, {np.mean(shares):.0%} valid")
    assert np.mean(shares) > 0.6
    assert rms <= bar


def test_nothing_in_common_gives_no_flow() -> None:
    measurer = Measurer(GoldenBoard(), SIZE, 1.5)
    frames = [np.ascontiguousarray(photograph(n)[:SIZE[1], :SIZE[0]]) for n in ("gravel", "grass")]
    field = measure_flow(measurer, measurer.view(frames[0]), measurer.view(frames[1]))
    assert not field.valid.any() and field.dominant() == (0.0, 0.0)
    assert draw_flow(frames[0], field).shape == (*SIZE[::-1], 3)
