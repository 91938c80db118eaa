# SPDX-License-Identifier: Apache-2.0
"""What the vehicle's own sensors do to readings: a turn is expected, a range scales, from the first frame or later."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest

from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Reading
from signum.applications.hold.watch import Sensors, watch_station
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.measure.measurer import Measurer

SIZE, FOCAL = (640, 480), 500.0
SMALL, SMALL_FOCAL = (192, 144), 200.0


def _texture(size: tuple[int, int]) -> Image:
    noise = np.random.default_rng(4).normal(128, 120, (size[1] + 80, size[0] + 80))
    return np.clip(cv2.GaussianBlur(noise, (0, 0), 2.5), 0, 255).astype(np.uint8)


@pytest.fixture
def board() -> Iterator[GoldenBoard]:
    with GoldenBoard() as one:
        yield one


@pytest.mark.parametrize(("rate", "in_step", "valid"), [(None, True, True), (1.2, False, True), (1.2, True, True),
                                                        (1.05, True, False), (1.05, False, True)])
def test_a_turn_is_searched_for_where_the_yaw_rate_expects_it(board: GoldenBoard, rate: float | None, in_step: bool,
                                                              valid: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """0.12 rad in 0.1 s, by which windows at the edge move by more than the search's reach: without a rate, the whole
    view is searched. A rate that is in step also judges the reading, one that is not does not."""
    floor = _texture(SIZE)
    first = floor[40:-40, 40:-40]
    meter = StationMeter(Measurer(board, SIZE, 2.0), FOCAL, 2.0, window=48, reach=5)
    meter.anchor(meter.measurer.view(np.ascontiguousarray(first)))
    keeper = StationKeeper(meter)
    sought: list[object] = []

    def seek(*view: Any) -> Reading:
        sought.append(view)
        return StationMeter.seek(meter, *view)

    monkeypatch.setattr(meter, "seek", seek)
    middle = ((floor.shape[1] - 1) / 2, (floor.shape[0] - 1) / 2)
    turned = cv2.warpAffine(floor, cv2.getRotationMatrix2D(middle, math.degrees(0.12), 1.0), floor.shape[::-1])
    live = meter.measurer.view(np.ascontiguousarray(turned[40:-40, 40:-40], np.uint8))
    reading, _ = keeper.step(live, Sensed(yaw_rate=rate, in_step=in_step), 0.1)
    assert reading.valid == valid and bool(sought) == (rate is None)
    if valid:
        assert reading.heading == pytest.approx(0.12, abs=0.003) and reading.agreed >= 8
        assert math.hypot(reading.forward, reading.right) < 0.005


@pytest.mark.parametrize("late", [0, 3])
def test_the_vehicles_range_scales_readings_from_the_first_on_or_from_when_it_comes(board: GoldenBoard, late: int
                                                                                   ) -> None:
    """A view that moves by 4 px a frame, 2 m away by guess, 3 m by the range finder."""
    floor = _texture(SMALL)
    frames = (Frame(str(k), np.ascontiguousarray(floor[40 - 4 * k:40 - 4 * k + 144, 40:232]), k / 10) for k in range(6))
    sensors = Sensors(lambda time: Sensed(range_m=3.0 if round(10 * time) >= late else None, in_step=False), True)
    fit = Fit.to(SMALL, board.config, 32, "film")
    seen = [s.reading for s in watch_station(Measurer(board, SMALL, 2.0), frames, fit, SMALL_FOCAL, 2.0, 10.0, 32,
                                             sensors=sensors)]
    assert all(r.valid for r in seen)
    ranges = [2.0 if k < late else 3.0 for k in range(6)]
    assert [r.range_m for r in seen] == pytest.approx(ranges, rel=0.01)
    assert [r.forward for r in seen] == pytest.approx([0.02 * k * z for k, z in enumerate(ranges)], abs=0.003)
    assert [r.reference for r in seen] == [int(0 < late <= k) for k in range(6)]
