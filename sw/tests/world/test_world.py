# SPDX-License-Identifier: Apache-2.0
"""The simulated world against its own geometry: rays, ranges, motion; and its speed."""

from __future__ import annotations

import time

import cv2
import numpy as np
import pytest

from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.world.camera import Pinhole
from signum.world.fish import Fish
from signum.world.seafloor import Seafloor, photograph
from signum.world.vehicle import AHEAD, DOWN, Current, PanTilt, Vehicle
from signum.world.water import CLEAR, COASTAL, PAPER
from signum.world.world import World

CAMERA = Pinhole()


@pytest.fixture(scope="module")
def relief() -> Seafloor:
    return Seafloor(extent=6.0, relief=0.12, texel=0.005, seed=3)


def test_depth_of_an_inclined_plane_is_exact() -> None:
    floor = Seafloor(extent=3.0, texel=0.005, slope=(0.2, -0.1))
    sight = Sight(np.array([0.3, -0.2, -2.0]), rotation(0.1, -0.15, 0.6) @ LOOK_DOWN)
    depth = CAMERA.meet(sight, floor)
    ray = CAMERA.rays.astype(np.float64) @ sight.rotation.T
    normal = np.array([0.2, -0.1, -1.0])
    truth = -(normal @ sight.position) / (ray @ normal)
    assert np.abs(depth - truth).max() < 1e-3


def test_two_sights_of_relief_agree(relief: Seafloor) -> None:
    """What one camera sees, warped by its own depth into the other, is what the other sees."""
    world = World(relief)
    one = Sight(np.array([0.0, 0.0, -2.0]), LOOK_DOWN)
    two = Sight(np.array([0.15, -0.1, -1.9]), rotation(0.05, 0.04, 0.1) @ LOOK_DOWN)
    a, b = world.look(CAMERA, one), world.look(CAMERA, two)
    points = one.position + (CAMERA.rays * a.depth[..., None]).reshape(-1, 3) @ one.rotation.T
    at = CAMERA.project(two, points).reshape(*a.frame.shape, 2).astype(np.float32)
    warped = cv2.remap(b.frame, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
    inside = (at > 2).all(axis=2) & (at < np.array(CAMERA.size) - 3).all(axis=2)
    assert inside.mean() > 0.5
    assert np.corrcoef(warped[inside], a.frame[inside])[0, 1] > 0.97


def test_a_seed_makes_a_world() -> None:
    def film(seed: int) -> np.ndarray:
        world = World(Seafloor(extent=3.0, relief=0.1, texel=0.005, seed=seed), COASTAL,
                      [Fish(np.array([0.1, 0.1, -1.0]), seed=seed)], seed=seed)
        frames = []
        for _ in range(3):
            world.step(0.1)
            frames.append(world.look(CAMERA, DOWN.sight(Vehicle())).frame)
        return np.stack(frames)

    assert np.array_equal(film(5), film(5))
    assert not np.array_equal(film(5), film(6))


def test_the_same_forces_in_the_same_water_end_at_the_same_place() -> None:
    ends = []
    for _ in range(2):
        vehicle = Vehicle(current=Current((0.1, -0.05), (0.08, 0.04, 0.02)))
        for _ in range(50):
            vehicle.step(np.array([5.0, 0.0, 0.0, 0.0, 0.0, 0.5]), 0.1)
        ends.append(np.concatenate([vehicle.position, vehicle.attitude, vehicle.velocity]))
    assert np.array_equal(ends[0], ends[1]) and np.hypot(*ends[0][:2]) > 0.5


def test_pixels_and_world_points_are_each_others_inverse(relief: Seafloor) -> None:
    sight = Sight(np.array([0.3, -0.2, -2.0]), rotation(0.1, -0.15, 0.6) @ LOOK_DOWN)
    pixels = np.array([[0.0, 0.0], [200.0, 31.0], [383.0, 287.0]])
    points = CAMERA.unproject(sight, pixels, np.array([1.5, 2.0, 2.5]))
    assert np.allclose(CAMERA.project(sight, points), pixels)
    assert np.allclose((points - sight.position) @ sight.rotation[:, 2], [1.5, 2.0, 2.5])


def test_a_photographed_floor_shows_the_photograph() -> None:
    """From where a pixel of the camera covers a texel, north up."""
    floor = Seafloor(extent=5.12, texel=0.01, quilted=False)
    frame = World(floor).look(Pinhole((256, 192), 200.0), DOWN.sight(Vehicle())).frame
    photo = photograph("gravel")[160:352, 128:384]
    assert np.corrcoef(frame.ravel(), photo.ravel())[0, 1] > 0.999


@pytest.mark.parametrize("water", [CLEAR, COASTAL, PAPER])
def test_thirty_frames_a_second(relief: Seafloor, water: object) -> None:
    world = World(relief, water)  # type: ignore[arg-type]
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        start = time.process_time()
        for _ in range(15):
            world.step(0.1)
            world.look(CAMERA, DOWN.sight(Vehicle()))
        assert 15 / (time.process_time() - start) >= 30
    finally:
        cv2.setNumThreads(threads)


def test_the_vehicle_drifts_with_the_current_and_comes_upright() -> None:
    vehicle = Vehicle(current=Current(steady=(0.2, -0.1)))
    vehicle.attitude = np.array([0.2, -0.2, 0.5])
    for _ in range(600):
        vehicle.step(np.zeros(6), 0.1)
    over_ground = vehicle.turn @ vehicle.velocity[:3]
    assert np.allclose(over_ground, [0.2, -0.1, 0.0], atol=0.01)
    assert np.abs(vehicle.attitude[:2]).max() < 0.01


def test_thrust_is_limited() -> None:
    vehicle = Vehicle()
    for _ in range(300):
        vehicle.step(np.array([1e6, 0, 0, 0, 0, 0]), 0.1)
    h = vehicle.hull
    top = (-h.linear[0] + np.sqrt(h.linear[0] ** 2 + 4 * h.quadratic[0] * h.limit[0])) / (2 * h.quadratic[0])
    assert vehicle.velocity[0] == pytest.approx(top, rel=0.01)


def test_pan_looks_right_and_tilt_looks_up() -> None:
    vehicle = Vehicle()
    ahead = AHEAD.sight(vehicle)
    assert np.allclose(ahead.rotation[:, 2], [1, 0, 0])
    assert AHEAD.sight(vehicle, PanTilt(pan=0.3)).rotation[1, 2] > 0.2
    assert AHEAD.sight(vehicle, PanTilt(tilt=0.3)).rotation[2, 2] < -0.2
    head = PanTilt()
    for _ in range(100):
        head.step(10.0, -10.0, 0.02)
    assert (head.pan, head.tilt) == (head.ends[0], -head.ends[1])


def test_fish_swim_stop_and_stay_at_home() -> None:
    fish = Fish(np.zeros(3), roam=(0.5, 1.0, 0.4))
    speeds, places = [], []
    for _ in range(3000):
        fish.step(0.1)
        speeds.append(np.linalg.norm(fish.velocity))
        places.append(fish.position)
    assert np.abs(np.array(places)).max(axis=0) == pytest.approx([0.5, 1.0, 0.4], abs=0.25)
    assert min(speeds) < 0.02 and max(speeds) > 0.2


def test_a_fish_is_seen_where_it_is() -> None:
    world = World(None, fish=[Fish(np.array([2.0, 0.3, -1.8]))])
    sight = AHEAD.sight(Vehicle())
    shot = world.look(CAMERA, sight)
    v, u = np.nonzero(np.isfinite(shot.depth))
    assert np.allclose([u.mean(), v.mean()], CAMERA.project(sight, np.array([[2.0, 0.3, -1.8]]))[0], atol=2)
    assert shot.depth[v, u] == pytest.approx(2.0)
