# SPDX-License-Identifier: Apache-2.0
"""Scenes rendered without control: a survey flown back and forth, a drifting vehicle; frames with their truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from signum.common.arrays import Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.tables.schemas import SCENE_TRUTH
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Current, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World

DRIFT_CURRENT = Current(steady=(0.10, 0.04), surge=(0.05, 0.06, 0.02), period=8.0)
"""The current of `drift`."""


@dataclass(frozen=True, eq=False)
class Still:
    """A moment of a scene: seconds, frame or stereo pair (uint8), and the truth by column name."""

    time: float
    frames: tuple[Image, ...]
    truth: dict[str, float]


def truth_of(position: np.ndarray, attitude: tuple[float, float, float], altitude: float) -> dict[str, float]:
    """The columns SCENE_TRUTH of a camera at `position` (3,) m, turned by roll, pitch and yaw, radians."""
    values = float(position[0]), float(position[1]), altitude, *(math.degrees(a) for a in attitude)
    return dict(zip(SCENE_TRUTH, values, strict=True))


def survey(place: Callable[[float], tuple[float, float]], seconds: float, rate: float, height: float = 2.0,
           stereo: bool = False, water: Water = COASTAL, seed: int = 0, camera: Pinhole | None = None
           ) -> Iterator[Still]:
    """A camera carried along a path, looking down.

    Args:
        place: north and east, metres, at a time in seconds.
        height: over the mean floor, metres.
    """
    camera = camera or Pinhole()
    path = np.array([place(t) for t in np.arange(0, seconds, 1 / rate)])
    middle = (path.min(axis=0) + path.max(axis=0)) / 2
    floor = Seafloor(extent=max(6.0, float(np.ptp(path, axis=0).max()) + 3 * height), relief=0.05, texel=0.005,
                     seed=seed)
    world = World(floor, water, seed=seed)
    for k, at in enumerate(path - middle):
        t = k / rate
        attitude = 0.01 * math.sin(t / 1.3), 0.01 * math.cos(t / 1.7), 0.03 * math.sin(t / 5)
        sight = Sight(np.array([*at, -height]), rotation(*attitude) @ LOOK_DOWN)
        yield _take(world, camera, sight, stereo, t, attitude)
        world.step(1 / rate)


def drift(seconds: float, rate: float, height: float = 2.0, stereo: bool = False, water: Water = COASTAL,
          seed: int = 0, camera: Pinhole | None = None) -> Iterator[Still]:
    """A vehicle without thrust in a current with surge, its camera looking down; arguments as `survey`."""
    camera = camera or Pinhole()
    far = 0.13 * seconds + 2 * height
    start = np.array([-0.05 * seconds, -0.02 * seconds, -height])
    floor = Seafloor(extent=max(6.0, far), relief=0.05, texel=0.005, seed=seed)
    world = World(floor, water, current=DRIFT_CURRENT, seed=seed)
    vehicle = Vehicle(current=DRIFT_CURRENT, position=start)
    for k in range(round(seconds * rate)):
        a = vehicle.attitude
        yield _take(world, camera, DOWN.sight(vehicle), stereo, k / rate, (float(a[0]), float(a[1]), float(a[2])))
        vehicle.step(np.zeros(6), 1 / rate)
        world.step(1 / rate)


def _take(world: World, camera: Pinhole, sight: Sight, stereo: bool, time: float,
          attitude: tuple[float, float, float]) -> Still:
    shots = world.look_pair(camera, sight, BASELINE_M) if stereo else (world.look(camera, sight),)
    return Still(time, tuple(s.frame for s in shots),
                 truth_of(sight.position, attitude, float(np.median(shots[0].depth))))
