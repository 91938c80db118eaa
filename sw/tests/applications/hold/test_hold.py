# SPDX-License-Identifier: Apache-2.0
"""Station keeping: the equations, the closed loop under current, surge, snow, occlusion and shove."""

from __future__ import annotations

import math

import numpy as np
import pytest

from signum.applications.hold.body_pid import Axes
from signum.applications.hold.judge import judge_hold
from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Level
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.applications.hold.tuning import PEAK, peaks, tune
from signum.applications.pid import Gains, Pid
from signum.boards.golden import GoldenBoard
from signum.measure.measurer import Measurer
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Vehicle
from signum.world.water import Water
from signum.world.world import World

CAMERA = Pinhole()
SMALL = Pinhole((256, 192), 300.0)
"""A camera over the photograph at one of its pixels a pixel, from 2 m."""
SENSOR = Water(noise=2.0)


def measurer(size: tuple[int, int]) -> Measurer:
    return Measurer(GoldenBoard(), size, 2.0)


@pytest.fixture(scope="module")
def world() -> World:
    return World(Seafloor(extent=4.0, texel=0.0025, relief=0.03))


@pytest.mark.parametrize(("forward", "right", "up", "roll", "pitch", "yaw"), [
    (0.05, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.05, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.1, 0.0, 0.0, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 0.05), (0.0, 0.0, 0.0, 0.02, -0.02, 0.0), (-0.06, 0.04, -0.08, -0.02, 0.01, -0.04)])
def test_signs_and_sizes(world: World, forward: float, right: float, up: float, roll: float, pitch: float, yaw: float
                         ) -> None:
    vehicle = Vehicle()
    shot = world.look(CAMERA, DOWN.sight(vehicle))
    meter = StationMeter(measurer(CAMERA.size), CAMERA.focal, float(np.median(shot.depth)), reach=30)
    assert meter.anchor(meter.measurer.view(shot.frame)) >= 8
    vehicle.position = vehicle.position + np.array([forward, right, -up])
    vehicle.attitude = np.array([roll, pitch, yaw])
    reading = meter.read(meter.measurer.view(world.look(CAMERA, DOWN.sight(vehicle)).frame),
                         Level(roll, pitch))
    assert reading.valid
    assert (reading.forward, reading.right) == pytest.approx((forward, right), abs=0.004)
    assert reading.heading == pytest.approx(yaw, abs=0.003)
    assert reading.range_m - meter.range_m == pytest.approx(up, abs=0.008)


@pytest.fixture(scope="module")
def gravel() -> Seafloor:
    """A flat floor that is one photograph of gravel."""
    return Seafloor(extent=1024 * 2 / 300, texel=2 / 300, quilted=False)


def _at(world: World, north: float, east: float, heading: float = 0.0, altitude: float = 2.0) -> np.ndarray:
    vehicle = Vehicle(position=np.array([north, east, -altitude]), attitude=np.array([0.0, 0.0, heading]))
    return world.look(SMALL, DOWN.sight(vehicle)).frame


def _anchored(frame: np.ndarray) -> StationMeter:
    meter = StationMeter(measurer(SMALL.size), SMALL.focal, 2.0, window=48, reach=30)
    assert meter.anchor(meter.measurer.view(frame)) >= meter.least
    return meter


@pytest.mark.parametrize("heading", [0.0, 0.7])
@pytest.mark.parametrize(("ahead", "right"), [(0.1, 0.0), (0.0, 0.1), (-0.12, 0.07)])
def test_offsets_are_in_the_stations_axes_at_any_heading(gravel: Seafloor, ahead: float, right: float, heading: float
                                                         ) -> None:
    world = World(gravel, SENSOR)
    c, s = math.cos(heading), math.sin(heading)
    meter = _anchored(_at(world, -0.2, 0.1, heading))
    there = _at(world, -0.2 + ahead * c - right * s, 0.1 + ahead * s + right * c, heading)
    reading = meter.read(meter.measurer.view(there))
    assert reading.confidence >= 50
    assert (reading.forward, reading.right) == pytest.approx((ahead, right), abs=0.002)


def test_rotation_and_zoom_are_measured_too(gravel: Seafloor) -> None:
    world = World(gravel, SENSOR)
    meter = _anchored(_at(world, 0.0, 0.0))
    reading = meter.read(meter.measurer.view(_at(world, 0.0, 0.0, math.radians(1.5), 1.96)))
    assert math.degrees(reading.heading) == pytest.approx(1.5, abs=0.3)
    assert reading.zoom == pytest.approx(2 / 1.96, abs=0.006) and reading.range_m == pytest.approx(1.96, abs=0.012)
    assert (reading.forward, reading.right) == pytest.approx((0, 0), abs=0.004)


def test_nothing_to_see_is_no_confidence_and_sight_comes_back(gravel: Seafloor) -> None:
    world = World(gravel, SENSOR)
    meter = _anchored(_at(world, 0.0, 0.0))
    murk = np.full(SMALL.size[::-1], 70, np.uint8)
    noise = np.random.default_rng(1).integers(0, 256, SMALL.size[::-1], dtype=np.uint8)
    assert [meter.read(meter.measurer.view(picture)).confidence for picture in (murk, noise)] == [0, 0]
    assert meter.read(meter.measurer.view(_at(world, 0.0, 0.05))).confidence > 50


def test_it_holds_where_the_free_vehicle_drifts_away(gravel: Seafloor) -> None:
    """Over the flat floor with an ideal attitude sensor the readings are exact to a millimetre."""
    moments, free = (list(simulate_hold(measurer, Scenario(seconds, water=SENSOR, level_noise=0.0, seed=5, window=48,
                                                           control=control), SMALL, gravel))
                     for control, seconds in ((True, 12.0), (False, 5.0)))
    assert len(moments) == 120 and all(m.reading.confidence for m in moments)
    true = np.array([m.truth[:2] for m in moments])
    measured = np.array([(m.reading.forward, m.reading.right) for m in moments])
    assert np.sqrt(np.mean((measured - true) ** 2)) < 0.001
    assert np.sqrt(np.mean(np.sum(true[40:] ** 2, axis=1))) < 0.03
    assert math.hypot(*free[-1].truth[:2]) > 0.5, "the water does push"


def test_it_stays() -> None:
    """A short form of the long hold: occluded for 3 s on the way."""
    moments = list(simulate_hold(measurer, Scenario(seconds=34, occluded=(16.0, 19.0), seed=1)))
    figures = judge_hold(moments, settle=8.0)
    print(f"RMS {figures.rms_m * 100:.1f} cm, heading {np.degrees(figures.heading_rms):.2f} degrees, "
          f"range {figures.range_rms:.2%}, {figures.valid:.0%} valid")
    blind = [m for m in moments if 16.05 < m.time < 18.95]
    assert blind and all(m.reading.confidence == 0 for m in blind)
    assert all(m.reading.valid for m in moments if m.time >= 20.0)
    assert np.hypot(*np.array([m.truth[:2] for m in moments if 16 <= m.time < 20]).T).max() < 0.25
    calm = judge_hold([m for m in moments if m.time < 16.0], settle=8.0)
    assert calm.rms_m <= 0.02 and calm.heading_rms <= np.radians(0.5) and calm.range_rms <= 0.01
    assert figures.wrong == 0


def test_a_lost_target_is_found_again() -> None:
    """Shoved until the station is out of sight: no wrong reading, and back home afterwards."""
    moments = list(simulate_hold(measurer, Scenario(seconds=24, shoved=(6.0, 9.0), shove=(32.0, 8.0), seed=2)))
    away = np.array([np.hypot(*m.truth[:2]) for m in moments])
    assert away.max() > 0.4
    assert any(not m.reading.valid for m in moments)
    assert judge_hold(moments, settle=0.0).wrong == 0
    assert moments[-1].reading.valid and away[-20:].max() < 0.06


def test_the_gains_are_those_of_the_stated_method() -> None:
    axes = Axes()
    for axis, gains in zip(axes.axes, axes.tuned, strict=True):
        assert max(peaks(axis, gains)) <= PEAK + 0.02
        assert max(peaks(axis, (gains[0], 1.1 * gains[1], gains[2]))) > PEAK + 0.02
    assert tune(axes.axes[3])[1] <= 1.02 * axes.tuned[3][1]
    assert peaks(axes.axes[0], (500.0, 2000.0, 5.0))[0] == float("inf"), "an unstable loop"


def test_a_reading_that_the_gyro_does_not_feel_has_no_confidence(world: World) -> None:
    vehicle, shots = Vehicle(), []
    for yaw in (0.0, 0.0, 0.03, 0.03):
        vehicle.attitude = np.array([0.0, 0.0, yaw])
        shots.append(world.look(CAMERA, DOWN.sight(vehicle)).frame)
    for gyro, believed in ((0.3, True), (0.0, False), (None, True)):
        meter = StationMeter(measurer(CAMERA.size), CAMERA.focal, 2.0)
        meter.anchor(meter.measurer.view(shots[0]))
        keeper = StationKeeper(meter)
        rates = (0.0, gyro, 0.0) if gyro is not None else (None, None, None)
        readings = [keeper.step(meter.measurer.view(frame), Sensed(yaw_rate=rate), 0.1)[0]
                    for frame, rate in zip(shots[1:], rates, strict=True)]
        assert [r.valid for r in readings] == [True, believed, believed]


def test_controller_limits() -> None:
    pid = Pid(Gains(proportional=2.0, integral=0.5, rate=0.0, limit=0.4, slew=0.8))
    outputs = [pid.step(5.0, 0.1) for _ in range(20)]
    assert outputs[0] == pytest.approx(0.08) and max(outputs) == pytest.approx(0.4)
    assert pid.hold() == 0.0, "the integral was frozen at the limit"
    for _ in range(30):
        pid.step(0.01, 0.1)
    assert pid.hold() == pytest.approx(0.5 * 0.01 * 3.0)
