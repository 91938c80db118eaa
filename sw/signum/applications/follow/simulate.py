"""Following a fish in the simulated world, with the truth beside every answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from signum.applications.follow.follower import (
    MOTION_WINDOW,
    RANGE_WINDOW,
    Eye,
    Follower,
    MotionEye,
    RangeEye,
    State,
    Target,
)
from signum.applications.follow.pilot import Felt, Pilot, Where
from signum.common.arrays import Image
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurer
from signum.world.camera import Pinhole
from signum.world.fish import Fish
from signum.world.seafloor import Seafloor
from signum.world.vehicle import AHEAD, DOWN, Current, PanTilt, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World

BASELINE_M = 0.12
SWELL = Current(steady=(0.02, 0.04), surge=(0.03, 0.03, 0.02), period=8.0)


@dataclass(frozen=True)
class Chase:
    """A fish to follow.

    Attributes:
        where: midwater, by range; or terrain, by motion.
        seconds: length; rate: frames per second.
        darts: seconds at which the fish darts away at `dart` m/s (world) for 0.7 s, out of the view.
        window: side of the windows, pixels; None for the eye's own.
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


@dataclass(frozen=True, eq=False)
class Glimpse:
    """A frame, or stereo pair, of a chase: answer, and the truth: the fish's pixel (NaN where it is not in view), its
    distance, head (pan, tilt) and vehicle."""

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


def follow(measurer: Callable[[tuple[int, int]], Measurer], chase: Chase, camera: Pinhole | None = None
           ) -> Iterator[Glimpse]:
    """Follow a fish, frame by frame."""
    camera = camera or Pinhole()
    world, vehicle = _scene(chase)
    fish, head, dt = world.fish[0], PanTilt(), 1 / chase.rate
    midwater = chase.where is Where.MIDWATER
    mount = AHEAD if midwater else DOWN
    taken = measurer(camera.size)
    geometry = StereoGeometry(camera.focal, BASELINE_M, camera.centre)
    eye: Eye = (RangeEye(taken, geometry, window=chase.window or RANGE_WINDOW) if midwater
                else MotionEye(taken, window=chase.window or MOTION_WINDOW))
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


class Row(NamedTuple):
    """A glimpse without its picture: time, whether the fish is in the centre quarter, its true pixel (NaN out of view),
    the answer's state and pixel, and the fish's length in pixels."""

    time: float
    centred: bool
    true_x: float
    true_y: float
    state: State
    x: float
    y: float
    length_px: float

    @classmethod
    def of(cls, g: Glimpse, camera: Pinhole, length_m: float = 0.5) -> Row:
        """Of a glimpse through a camera."""
        return cls(g.time, g.centred(camera.size), *g.truth, g.target.state, g.target.x, g.target.y,
                   length_m * camera.focal / max(g.range_m, 0.2))


@dataclass(frozen=True)
class ChaseFigures:
    """What a chase was like: shares of the frames from `settle` on, seconds.

    `centred` is the share in which the fish is in the centre quarter, `wrong` that in which the target is said not to
    be lost, yet lies farther from the fish than its length; `silent_s` the longest time for which the fish was out of
    view and not said to be lost; `finds` how often it was found again.
    """

    centred: float
    in_view: float
    lost: float
    wrong: float
    silent_s: float
    longest_lost_s: float
    finds: int


def judge(rows: Sequence[Row], rate: float = 10.0, settle: float = 5.0) -> ChaseFigures:
    """Figures of a chase."""
    rows = [r for r in rows if r.time >= settle]
    seen = np.array([np.isfinite(r.true_x) for r in rows])
    lost = np.array([r.state is State.LOST for r in rows])
    far = np.array([not np.hypot(r.x - r.true_x, r.y - r.true_y) <= r.length_px for r in rows])
    return ChaseFigures(float(np.mean([r.centred for r in rows])), float(seen.mean()), float(lost.mean()),
                        float((~lost & far).mean()), _longest(~seen & ~lost) / rate, _longest(lost) / rate,
                        int((lost[:-1] & ~lost[1:]).sum()))


def _longest(flags: NDArray[np.bool_]) -> int:
    return max((len(run) for run in "".join("1" if f else "0" for f in flags).split("0")), default=0)
