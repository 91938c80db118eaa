# SPDX-License-Identifier: Apache-2.0
"""Following a fish in the simulated world, with the truth beside every target."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from signum.applications.follow.eyes import MOTION_WINDOW, RANGE_WINDOW, DenseEye, Eye, MotionEye, RangeEye
from signum.applications.follow.follower import Follower, Target
from signum.applications.follow.judge import ChaseRow
from signum.applications.follow.pilot import Felt, Pilot, Where
from signum.common.arrays import Image
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurer
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.fish import Fish
from signum.world.seafloor import Seafloor
from signum.world.vehicle import AHEAD, DOWN, Current, PanTilt, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World

SWELL = Current(steady=(0.02, 0.04), surge=(0.03, 0.03, 0.02), period=8.0)
"""The current of a chase."""


@dataclass(frozen=True)
class Chase:
    """A chase to simulate.

    Attributes:
        where: midwater, by range; or terrain, by motion.
        seconds: length; rate: frames per second.
        speed: of the fish, m/s.
        current, water: of the sea.
        darts: seconds at which the fish darts away at `dart` m/s (world) for 0.7 s, out of the view.
        seed: of everything.
        window: side of the windows, pixels; None for the eye's default.
        dense: over terrain, whether the board with the dense engine finds what moves by itself.
    """

    where: Where = Where.MIDWATER
    seconds: float = 300.0
    rate: float = 10.0
    speed: float = 0.25
    current: Current = SWELL
    water: Water = COASTAL
    darts: tuple[float, ...] = ()
    dart: tuple[float, float, float] = (0.0, 3.0, 0.0)
    seed: int = 0
    window: int | None = None
    dense: bool = False


@dataclass(frozen=True, eq=False)
class Glimpse:
    """A frame, or stereo pair, of a chase.

    Attributes:
        time: seconds.
        target: the follower's.
        truth: the fish's pixel, NaN out of view.
        range_m: true distance of the fish, metres.
        head: pan and tilt, radians.
        position: of the vehicle, world metres.
        frames: uint8 (height, width), one or two.
    """

    time: float
    target: Target
    truth: tuple[float, float]
    range_m: float
    head: tuple[float, float]
    position: tuple[float, float, float]
    frames: tuple[Image, ...]

    @property
    def frame(self) -> Image:
        """The frame, or the left one of the pair."""
        return self.frames[0]

    def row(self, camera: Pinhole, length_m: float = 0.5) -> ChaseRow:
        """What is judged of it, for a fish of length `length_m` metres."""
        return ChaseRow(self.time, self.centred(camera.size), *self.truth, self.target.state, self.target.x,
                        self.target.y, length_m * camera.focal / max(self.range_m, 0.2))

    def centred(self, size: tuple[int, int]) -> bool:
        """Whether the fish is in the centre quarter: the middle half across and down."""
        x, y = self.truth
        return abs(x - (size[0] - 1) / 2) <= size[0] / 4 and abs(y - (size[1] - 1) / 2) <= size[1] / 4


def _scene(chase: Chase) -> tuple[World, Vehicle]:
    if chase.where is Where.MIDWATER:
        fish = Fish(np.array([2.2, 0.2, -10.0]), speed=chase.speed, home=np.array([2.2, 0.0, -10.0]),
                    roam=(0.5, 1.5, 0.5), seed=chase.seed)
        return (World(None, chase.water, [fish], chase.current, seed=chase.seed),
                Vehicle(current=chase.current, position=np.array([0.0, 0.0, -10.0])))
    fish = Fish(np.array([0.1, 0.2, -1.2]), speed=chase.speed, home=np.array([0.0, 0.0, -1.2]), roam=(1.5, 1.5, 0.2),
                seed=chase.seed)
    floor = Seafloor(extent=10.0, relief=0.05, texel=0.005, seed=chase.seed)
    return (World(floor, chase.water, [fish], chase.current, seed=chase.seed),
            Vehicle(current=chase.current, position=np.array([0.0, 0.0, -3.0])))


def simulate_chase(measurer: Callable[[tuple[int, int]], Measurer], chase: Chase, camera: Pinhole | None = None
           ) -> Iterator[Glimpse]:
    """Follow a fish, frame by frame; `measurer` makes a measurer for a picture size (width, height)."""
    camera = camera or Pinhole()
    world, vehicle = _scene(chase)
    fish, head, dt = world.fish[0], PanTilt(), 1 / chase.rate
    midwater = chase.where is Where.MIDWATER
    mount = AHEAD if midwater else DOWN
    taken = measurer(camera.size)
    geometry = StereoGeometry(camera.focal, BASELINE_M, camera.centre)
    eye: Eye = (RangeEye(taken, geometry, window=chase.window or RANGE_WINDOW) if midwater else
                (DenseEye if chase.dense else MotionEye)(taken, window=chase.window or MOTION_WINDOW))
    follower = Follower(eye)
    pilot = Pilot(chase.where, camera.focal, camera.centre)
    rng = np.random.default_rng([chase.seed, 6])
    depth, before = float(vehicle.position[2]), (0.0, 0.0)
    for k in range(round(chase.seconds * chase.rate)):
        sight = mount.sight(vehicle, head)
        shots = world.look_pair(camera, sight, BASELINE_M) if midwater else (world.look(camera, sight),)
        felt = Felt(head.pan, head.tilt, float(vehicle.attitude[2] + rng.normal(0, 0.01)),
                    float(vehicle.position[2] - depth + rng.normal(0, 0.01)))
        moved = -camera.focal * (head.pan - before[0]), camera.focal * (head.tilt - before[1])
        before = head.pan, head.tilt
        expected = None if follower.target.lost else pilot.expects(felt, dt)
        target = follower.step([s.frame for s in shots], moved, expected)
        place = camera.project(sight, fish.position)[0]
        inside = bool(((place >= 0) & (place <= np.array(camera.size) - 1)).all())
        truth = (float(place[0]), float(place[1])) if inside else (float("nan"), float("nan"))
        yield Glimpse(k * dt, target, truth, float(np.linalg.norm(fish.position - sight.position)),
                      (head.pan, head.tilt), tuple(vehicle.position.tolist()), tuple(s.frame for s in shots))
        rates, force = pilot.step(target, felt, dt)
        head.step(*rates, dt)
        vehicle.step(force, dt)
        world.step(dt)
        if any(t <= world.time < t + 0.7 for t in chase.darts):
            fish.position = fish.position + np.array(chase.dart) * dt
