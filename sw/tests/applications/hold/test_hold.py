"""Station keeping: the equations, the closed loop under current, surge, snow, occlusion and shove, and MAVLink."""

from __future__ import annotations

import numpy as np
import pytest

from signum.applications.hold.judge import judge_hold
from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.loops import Axes
from signum.applications.hold.mavlink import MavlinkSink
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Level, Reading
from signum.applications.hold.simulate import Scenario, simulate_hold
from signum.applications.hold.tuning import PEAK, peaks, tune
from signum.boards.golden import GoldenBoard
from signum.measure.measurer import Measurer
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Vehicle
from signum.world.world import World

CAMERA = Pinhole()


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


def test_mavlink_is_received() -> None:
    from pymavlink import mavutil

    receiver = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    port = receiver.port.getsockname()[1]
    path = [Reading(0.1 * k, -0.05 * k, 0.0, 1.0, 2.0 - 0.01 * k, 90) for k in range(4)] + [Reading()]
    with MavlinkSink(f"udpout:127.0.0.1:{port}") as sink:
        for k, reading in enumerate(path):
            sink.send(0.1 * k, reading)
        got = [receiver.recv_match(type="VISION_POSITION_DELTA", blocking=True, timeout=5) for _ in range(sink.sent)]
    receiver.close()
    assert sink.sent == 4 and all(got)
    assert [g.time_usec for g in got] == [100000, 200000, 300000, 400000]
    assert got[0].time_delta_usec == 100000
    assert got[0].position_delta == pytest.approx([0.1, -0.05, 0.01], abs=1e-6)
    assert got[0].confidence == 90
    assert got[3].confidence == 0 and list(got[3].position_delta) == [0.0, 0.0, 0.0]


def test_mavlink_keeps_ten_a_second_whatever_the_frame_rate() -> None:
    from pymavlink import mavutil

    receiver = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    port = receiver.port.getsockname()[1]
    with MavlinkSink(f"udpout:127.0.0.1:{port}") as sink:
        for k in range(76):
            sink.send(k / 25, Reading(0.01 * k, 0.0, 0.0, 1.0, 2.0, 80))
        got = [receiver.recv_match(type="VISION_POSITION_DELTA", blocking=True, timeout=5) for _ in range(sink.sent)]
    receiver.close()
    assert 29 <= sink.sent <= 30
    assert sum(g.position_delta[0] for g in got) == pytest.approx(0.01 * 25 * got[-1].time_usec / 1e6, abs=1e-5)
    assert np.diff([g.time_usec for g in got]).max() <= 120000


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
