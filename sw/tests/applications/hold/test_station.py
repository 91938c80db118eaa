"""Station keeping: signs of equations 2 to 5, accuracy, losing sight, the controller's limits."""

import math

import numpy as np
import pytest

from signum.applications.hold.station import Station, hold
from signum.applications.pid import Gains, Pid
from signum.boards.golden import GoldenBoard
from signum.measure.measurer import Measurer
from signum.world.scene import Camera, Current, Pose, Vehicle, gravel

SIZE = 256, 192


@pytest.fixture(scope="module")
def camera() -> Camera:
    return Camera(gravel(), size=SIZE, focal=300.0, ground_pixel=2 / 300)


def _measurer() -> Measurer:
    return Measurer(GoldenBoard(), SIZE, 2.0)


@pytest.mark.parametrize("heading", [0.0, 0.7])
@pytest.mark.parametrize(("ahead", "right"), [(0.1, 0.0), (0.0, 0.1), (-0.12, 0.07)])
def test_where_the_vehicle_is(camera: Camera, ahead: float, right: float, heading: float) -> None:
    c, s = math.cos(heading), math.sin(heading)
    home = Pose(0.1, 0.2, heading=heading)
    station = Station(_measurer(), camera.look(home), camera.focal, home.altitude, 48)
    there = Pose(0.1 + ahead * s + right * c, 0.2 - ahead * c + right * s, heading=heading)
    fix = station.look(camera.look(there))
    assert fix.confidence >= 0.5
    assert (fix.x, fix.y) == pytest.approx((ahead, right), abs=0.002)


def test_rotation_and_zoom_come_with_it(camera: Camera) -> None:
    station = Station(_measurer(), camera.look(Pose()), camera.focal, 2.0, 48)
    fix = station.look(camera.look(Pose(altitude=1.96, heading=math.radians(1.5))))
    # The vehicle turns clockwise, so the scene turns the other way; it comes nearer, so the scene grows.
    assert fix.rot_deg == pytest.approx(-1.5, abs=0.3) and fix.zoom == pytest.approx(2 / 1.96, abs=0.006)
    assert (fix.x, fix.y) == pytest.approx((0, 0), abs=0.004)


def test_nothing_to_see_is_no_confidence_and_sight_comes_back(camera: Camera) -> None:
    station = Station(_measurer(), camera.look(Pose()), camera.focal, 2.0, 48)
    murk = np.full(SIZE[::-1], 70, np.uint8)
    noise = np.random.default_rng(1).integers(0, 256, SIZE[::-1], dtype=np.uint8)
    assert [station.look(picture).confidence for picture in (murk, noise)] == [0.0, 0.0]
    assert station.look(camera.look(Pose(0.05, 0.0))).confidence > 0.5


def test_holds_against_current_and_surge(camera: Camera) -> None:
    vehicle = Vehicle(Pose(0.1, 0.1), current=Current(seed=5))
    moments = list(hold(_measurer(), camera, vehicle, 12.0, window=48))
    assert len(moments) == 60 and all(m.fix.confidence for m in moments)
    true = np.array([m.true for m in moments])
    seen = np.array([(m.fix.x, m.fix.y) for m in moments])
    assert np.sqrt(np.mean((seen - true) ** 2)) < 0.001
    assert np.sqrt(np.mean(np.sum(true[20:] ** 2, axis=1))) < 0.03
    free = Vehicle(Pose(0.1, 0.1), current=Current(seed=5))
    for _ in range(60):
        free.step(0.0, 0.0, 0.2)
    assert math.hypot(free.pose.x - 0.1, free.pose.y - 0.1) > 0.5, "the water does push"


def test_controller_limits() -> None:
    pid = Pid(Gains(proportional=2.0, integral=0.5, rate=0.0, limit=0.4, slew=0.8))
    outputs = [pid.step(5.0, 0.1) for _ in range(20)]
    assert outputs[0] == pytest.approx(0.08) and max(outputs) == pytest.approx(0.4)
    assert pid.hold() == 0.0, "nothing was learnt while at the limit"
    for _ in range(30):
        pid.step(0.01, 0.1)
    assert pid.hold() == pytest.approx(0.5 * 0.01 * 3.0)


def test_scene_is_the_same_for_a_seed() -> None:
    looks = [Camera(gravel(), size=(64, 48), seed=7).look(Pose(0.1)) for _ in range(2)]
    assert np.array_equal(looks[0], looks[1])
    ends = []
    for _ in range(2):
        vehicle = Vehicle(current=Current(seed=3))
        for _ in range(50):
            vehicle.step(0.1, 0.0, 0.1)
        ends.append(vehicle.pose)
    assert ends[0] == ends[1]
