# SPDX-License-Identifier: Apache-2.0
"""Poses: frames, signs, covariance of the fit, rate and the counter of resets, by an autopilot's rules."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from signum.applications.hold.ground_fit import RELIEF, SLOPE, fit_ground
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Level, Reading
from signum.applications.mavlink.sink import MavlinkSink
from signum.boards.golden import GoldenBoard
from signum.geometry.similarity import IDENTITY, Similarity
from signum.measure.measurer import Measurer

from .ekf import LEAST_HZ, ExternalNav
from .ends import receiver

KINDS = {"estimate": "VISION_POSITION_ESTIMATE", "odometry": "ODOMETRY"}


def _flown(message: str, frames: list[tuple[float, Reading]], level: Level | None = None, north: float = 0.0
           ) -> tuple[MavlinkSink, list[Any], ExternalNav]:
    filter_ = ExternalNav()
    with receiver() as other:
        with MavlinkSink(other.address, message=message) as sink:
            for time, reading in frames:
                sink.send(time, reading, level, north)
        got = other.heard(KINDS[message], sink.sent)
        assert other.nothing(KINDS[message])
    for one in got:
        filter_.take(one, 0.0)
    assert not filter_.dropped
    return sink, got, filter_


@pytest.mark.parametrize("message", KINDS)
@pytest.mark.parametrize(("rate", "expected"), [(10.0, 20), (30.0, 60), (60.0, 60)])
def test_poses_come_at_the_frames_rate_up_to_thirty_and_never_while_blind(message: str, rate: float, expected: int
                                                                          ) -> None:
    frames = [(k / rate, Reading(0.01 * k, 0.0, 0.0, 1.0, 2.0, 80, offset_error=0.01)) for k in range(round(2 * rate))]
    late = [(t + 2, r) for t, r in frames[-1:]]
    blind = [(2 + k / 10, Reading()) for k in range(15)]
    sink, got, filter_ = _flown(message, [*frames, *blind, *late])
    assert not [p for p in filter_.poses if 2 <= p[0] < 3.5]
    assert abs(sink.sent - expected - 1) <= 1 and len(filter_.poses) == len(got)
    assert len(filter_.pauses([p[0] for p in filter_.poses], 1e3 / LEAST_HZ)) == 1, "the one while nothing was seen"


@pytest.mark.parametrize("message", KINDS)
def test_a_pose_is_that_of_the_reading(message: str) -> None:
    """0.3 m ahead, 0.1 m to the left, turned by 20 degrees to the right, risen from 2 m to 2.5 m."""
    reading = Reading(0.3, -0.1, math.radians(20), 2.0 / 2.5, 2.5, 64, 9, 12, offset_error=0.02, heading_error=0.004,
                      range_error=0.03)
    north = math.radians(90)
    _, (one,), filter_ = _flown(message, [(1.5, reading)], Level(0.1, -0.2), north)
    if message == "odometry":
        assert (one.frame_id, one.child_frame_id) == (20, 12) and one.quality == 64
        assert math.isnan(one.vx) and math.isnan(one.velocity_covariance[0])
        assert (one.x, one.y, one.z) == pytest.approx((0.3, -0.1, -0.5)), "local axes are the station's"
        assert filter_.poses[0][2] == pytest.approx(math.radians(20))
        w, x, y, z = one.q
        assert math.asin(2 * (w * y - x * z)) == pytest.approx(-0.2)
        assert math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) == pytest.approx(0.1)
        covariance = one.pose_covariance
    else:
        assert (one.x, one.y, one.z) == pytest.approx((0.1, 0.3, -0.5)), "the station looks east"
        assert (one.roll, one.pitch, one.yaw) == pytest.approx((0.1, -0.2, math.radians(110)))
        covariance = one.covariance
    assert [covariance[k] for k in (0, 6, 11)] == pytest.approx([0.0004, 0.0004, 0.0009])
    assert [covariance[k] for k in (15, 18, 20)] == pytest.approx([0.000016] * 3)
    assert sum(map(bool, covariance)) == 6, "nothing off the diagonal"


@pytest.mark.parametrize("message", KINDS)
def test_the_counter_steps_when_the_reference_changes_and_the_filter_resets_then_only(message: str) -> None:
    frames = [(k / 10, Reading(0.1 * (k % 8), 0.0, 0.0, 1.0, 2.0, 80, reference=k // 8)) for k in range(24)]
    sink, got, filter_ = _flown(message, frames)
    assert [g.reset_counter for g in got] == [k // 8 for k in range(24)]
    assert [k for k, p in enumerate(filter_.poses) if p[-1]] == [8, 16]
    assert "reference changed 2 times" in sink.said


def test_the_meter_counts_its_references() -> None:
    rng = np.random.default_rng(2)
    import cv2

    frame = np.clip(cv2.GaussianBlur(rng.normal(128, 90, (144, 192)), (0, 0), 1.5), 0, 255).astype(np.uint8)
    with GoldenBoard() as board:
        meter = StationMeter(Measurer(board, (192, 144), 2.0), 200.0, 2.0, window=32)
        meter.anchor(meter.measurer.view(frame))
        first = meter.read(meter.measurer.view(frame))
        meter.anchor(meter.measurer.view(frame))
        second = meter.read(meter.measurer.view(frame))
    assert (first.reference, second.reference) == (0, 1)
    assert 0 < first.offset_error < 0.002 and 0 < first.heading_error < 0.002 and 0 < first.range_error < 0.004


def test_the_stated_errors_are_those_of_the_fit() -> None:
    """Against the scatter of 400 fits over floors of random slope and height, where the ground point lies outside the
    windows."""
    rng, focal = np.random.default_rng(5), 300.0
    points = rng.uniform(-150, 100, (9, 2))
    true = Similarity.of(4.0, 0.9, (60.0, -35.0))
    places, turns, stated = [], [], []
    for _ in range(400):
        height = rng.normal(0, RELIEF) + (points - points.mean(axis=0)) @ rng.normal(0, SLOPE, 2) / focal
        found = true(points) + height[:, None] * [60.0, -35.0] + rng.normal(0, 0.5, points.shape)
        got = fit_ground(points, found, true, focal, 40.0)  # a tolerance at which Tukey's weights are all but equal
        places.append(complex(-got.similarity.shift / got.similarity.factor) * abs(true.factor))
        turns.append(np.angle(got.similarity.factor))
        stated.append(got.errors(0.1))
    scatter = np.sqrt((np.var(np.real(places)) + np.var(np.imag(places))) / 2)
    turn, shift = np.sqrt(np.mean(np.square(stated), axis=0))
    assert shift == pytest.approx(scatter, rel=0.1)
    assert turn == pytest.approx(np.std(turns), rel=0.1)
    assert min(fit_ground(points, points, IDENTITY, focal, 4.0).errors(0.1)) > 0, "never without an error"
