# SPDX-License-Identifier: Apache-2.0
"""Readings through jumps, drift, large turns, other seabeds and a way: the right values, or none."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import cv2
import numpy as np
import pytest
from skimage import data

from signum.applications.hold.evidence import log_false_alarms
from signum.applications.hold.ground_fit import fit_ground
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Reading
from signum.applications.hold.watch import StationFrame, watch_station
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer

SIZE, FOCAL, RANGE_M = (320, 240), 350.0, 2.0


@pytest.fixture
def board() -> Iterator[GoldenBoard]:
    with GoldenBoard() as one:
        yield one


@pytest.fixture(scope="module")
def floor() -> Image:
    return np.asarray(cv2.resize(data.gravel(), (1280, 1280), interpolation=cv2.INTER_CUBIC), np.uint8)


def _seen(floor: Image, x: float, y: float, turn_deg: float = 0.0, scale: float = 1.0, seed: int = 0) -> Image:
    """The view centred at pixel (x, y) of the floor, turned and enlarged, with noise."""
    matrix = np.asarray(cv2.getRotationMatrix2D((x, y), turn_deg, scale), np.float64)
    matrix[:, 2] += np.array([(SIZE[0] - 1) / 2 - x, (SIZE[1] - 1) / 2 - y])
    seen = cv2.warpAffine(floor, matrix, SIZE, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    return np.asarray(np.clip(seen + np.random.default_rng(seed).normal(0, 3, SIZE[::-1]), 0, 255), np.uint8)


def _watched(board: GoldenBoard, pictures: Sequence[Image], follow_ground: bool = False) -> list[StationFrame]:
    frames = (Frame(str(k), picture, k / 10) for k, picture in enumerate(pictures))
    fit = Fit.to(SIZE, board.config, 48)
    return list(watch_station(Measurer(board, SIZE, 2.0), frames, fit, FOCAL, RANGE_M, 10.0, 48,
                              follow_ground=follow_ground))


def _metres(px: float) -> float:
    return px * RANGE_M / FOCAL


@pytest.mark.parametrize("jump", [80, 150])
def test_the_frame_after_a_jump_has_its_right_value(board: GoldenBoard, floor: Image, jump: int) -> None:
    places = [500.0] * 4 + [500.0 + jump] * 4
    seen = _watched(board, [_seen(floor, x, 500, seed=k) for k, x in enumerate(places)])
    assert all(s.reading.valid for s in seen)
    assert [s.reading.right for s in seen] == pytest.approx([_metres(x - 500) for x in places], abs=0.003)
    assert [s.reading.forward for s in seen] == pytest.approx([0.0] * 8, abs=0.003)


def test_a_steady_drift_and_its_return_are_followed(board: GoldenBoard, floor: Image) -> None:
    """14 px a frame, with a sudden turn back."""
    places = [500.0 + 14 * min(k, 16 - k) for k in range(17)]
    seen = _watched(board, [_seen(floor, x, 500, seed=k) for k, x in enumerate(places)])
    assert all(s.reading.valid for s in seen)
    assert [s.reading.right for s in seen] == pytest.approx([_metres(x - 500) for x in places], abs=0.003)


def test_nine_degrees_and_twelve_percent_are_read(board: GoldenBoard, floor: Image) -> None:
    poses = [(9 * math.sin(k / 2), 1 + 0.12 * math.sin(k / 3)) for k in range(12)]
    seen = _watched(board, [_seen(floor, 500 + 3 * k, 500, turn, scale, k) for k, (turn, scale) in enumerate(poses)])
    assert all(s.reading.valid for s in seen)
    assert [math.degrees(s.reading.heading) for s in seen] == pytest.approx([turn for turn, _ in poses], abs=0.3)
    assert [s.reading.zoom for s in seen] == pytest.approx([scale for _, scale in poses], rel=0.005)


def test_of_another_seabed_nothing_is_read_and_the_station_is_found_again(board: GoldenBoard, floor: Image) -> None:
    """The other one is the same floor elsewhere; the vehicle comes back turned, aside and higher."""
    other = [_seen(floor, 900 + 4 * k, 950, seed=k) for k in range(6)]
    seen = _watched(board, [_seen(floor, 400, 400), *other, *(_seen(floor, 470, 360, -8, 0.9, k) for k in range(4))])
    assert [s.reading.valid for s in seen[:7]] == [True] + 6 * [False]
    back = [s.reading for s in seen[7:] if s.reading.valid]
    assert len(back) >= 2
    for reading in back:
        assert (reading.right, reading.forward) == pytest.approx((_metres(70), _metres(40)), abs=0.005)
        assert math.degrees(reading.heading) == pytest.approx(-8, abs=0.3)
        assert reading.zoom == pytest.approx(0.9, rel=0.005)


def test_a_way_is_followed_over_changes_of_the_reference_that_are_counted_with_their_error(
        board: GoldenBoard, floor: Image) -> None:
    places = [300.0 + 40 * k for k in range(17)]
    pictures = [_seen(floor, x, 500 + 4 * k, seed=k) for k, x in enumerate(places)]
    ends = [*pictures[:2], *pictures[-2:]]
    held, followed = _watched(board, ends), _watched(board, pictures, follow_ground=True)
    assert not any(s.anchored or s.reading.reference for s in held) and not held[-1].reading.valid
    assert all(s.reading.valid for s in followed)
    anchors = sum(s.anchored for s in followed)
    assert anchors >= 3 and followed[-1].reading.reference == anchors
    counted = np.cumsum([0] + [s.anchored for s in followed[:-1]])
    assert [s.reading.reference for s in followed] == counted.tolist()
    for s, x in zip(followed, places, strict=True):
        off = math.hypot(s.reading.right - _metres(x - 300), s.reading.forward + _metres(4 * int(s.name)))
        assert off <= min(0.02, 3 * s.reading.offset_error + 0.003)
    errors = [s.reading.offset_error for s in followed if s.anchored]
    assert errors == sorted(errors) and errors[-1] > 1.5 * errors[0] > 0


def test_a_slope_of_the_floor_is_no_rotation() -> None:
    """Half of the view has gone; the floor rises by a tenth across what is left."""
    rng = np.random.default_rng(3)
    points = rng.uniform((0, -200), (300, 200), (30, 2))
    true, slope = Similarity.of(5.0, 1.05, (-300.0, 30.0)), np.array([0.03, 0.1])
    height = (points - points.mean(axis=0)) @ slope / 600.0
    found = true(points) + height[:, None] * [-300.0, 30.0] + rng.normal(0, 0.3, points.shape)
    got = fit_ground(points, found, true, 600.0, 4.0)
    turn, _ = got.errors(0.1)
    assert abs(got.similarity.rot_deg - 5.0) < 0.3 and math.radians(abs(got.similarity.rot_deg - 5.0)) < 3 * turn


def test_chance_is_reckoned_as_it_comes() -> None:
    """Windows that are found anywhere agree as often as stated, or less."""
    rng = np.random.default_rng(1)
    area, tried, believed = 29.0**2, 12, 0
    for _ in range(40):
        p = rng.uniform(-200, 200, (tried, 2))
        q = p + rng.uniform(-14.5, 14.5, p.shape)
        best = 0.0
        for i in range(tried):
            for j in range(i):
                a = complex(*(q[i] - q[j])) / complex(*(p[i] - p[j]))
                like = Similarity(a, complex(*q[i]) - a * complex(*p[i]))
                best = min(best, log_false_alarms(np.hypot(*(q - like(p)).T), tried, area))
        believed += best <= -1
    assert believed <= 0.1 * 40 + 3 * math.sqrt(4)
    assert log_false_alarms(np.full(10, 1.5), 12, area) < -7 < log_false_alarms(np.full(4, 1.5), 12, area)


def test_the_board_keeps_its_size_and_its_slots_while_the_reference_is_lost(board: GoldenBoard, floor: Image) -> None:
    measurer = Measurer(board, SIZE, 2.0)
    meter = StationMeter(measurer, FOCAL, RANGE_M, 48)
    meter.anchor(meter.view(_seen(floor, 400, 400)))
    configurations = board.configurations
    for k in range(5):
        live = meter.view(_seen(floor, 950, 900, seed=k))
        assert meter.seek(live) == Reading(tried=meter.seek(live).tried)
        measurer.release(live)
        assert measurer.free_views >= 4
    assert board.configurations == configurations
    meter.release()
    assert measurer.free_views == 6
