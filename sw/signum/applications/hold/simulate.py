# SPDX-License-Identifier: Apache-2.0
"""Station keeping in the simulated world, with the truth beside every reading."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from signum.applications.hold.judge import Moment
from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import Level
from signum.common.errors import SignumError
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurer
from signum.measure.stereo import measure_range
from signum.world.camera import BASELINE_M, Pinhole
from signum.world.seafloor import Float, Seafloor
from signum.world.vehicle import DOWN, Current, PanTilt, Vehicle
from signum.world.water import PAPER, Water
from signum.world.world import Shot, World

SURGE = Current(steady=(0.2, 0.0), surge=(0.06, 0.08, 0.03), period=8.0)
"""A fifth of a metre per second, with surge along all axes."""
HEAD_RATE = 4.0
"""Rate of the pan/tilt per angle error, 1/s: it settles in a second, well below the frame rate."""


@dataclass(frozen=True)
class Scenario:
    """A hold to simulate.

    Attributes:
        seconds: length; rate: frames per second.
        range_m: height over the mean floor.
        current: of the water.
        water: its optical properties.
        relief: standard deviation of the floor's height, metres.
        guess_m: the range assumed by the vehicle; None to measure it by stereo once, at the station.
        head: whether the camera is on a pan/tilt that keeps looking at the station's middle.
        occluded: (from, to) seconds in which the view is blocked; None for never.
        shoved: (from, to) seconds in which the vehicle is pushed with `shove` N north and east.
        level_noise: standard deviation of the attitude sensor's roll and pitch, radians; rate_noise: of its yaw rate.
        window: side of the feature windows, pixels.
        control: False computes and discards the control forces: the vehicle drifts.
        seed: of everything.
    """

    seconds: float = 600.0
    rate: float = 10.0
    range_m: float = 2.0
    current: Current = SURGE
    water: Water = PAPER
    relief: float = 0.05
    guess_m: float | None = None
    head: bool = False
    occluded: tuple[float, float] | None = None
    shoved: tuple[float, float] | None = None
    shove: tuple[float, float] = (30.0, 20.0)
    level_noise: float = 0.001
    rate_noise: float = 0.002
    seed: int = 0
    window: int = 64
    control: bool = True

    @property
    def apart(self) -> tuple[tuple[float, float], ...]:
        """(from, to) seconds in which station keeping is not judged: blocked or pushed, and 10 s to come back."""
        return tuple((begin, end + 10.0) for begin, end in filter(None, (self.occluded, self.shoved)))


def simulate_hold(measurer: Callable[[tuple[int, int]], Measurer], scenario: Scenario, camera: Pinhole | None = None,
                  floor: Seafloor | None = None) -> Iterator[Moment]:
    """Fly a scenario, frame by frame.

    Args:
        measurer: makes a measurer for a picture size (width, height).
        scenario: what is flown.
        camera: None for the default one.
        floor: None for a quilted one with the scenario's relief.

    Raises:
        SignumError: if stereo measures no range, or the station offers too few features.
    """
    s = scenario
    camera = camera or Pinhole()
    floor = floor or Seafloor(extent=6.0, relief=s.relief, texel=0.0025, seed=s.seed)
    world = World(floor, s.water, current=s.current, occluder=occluder(s.occluded), seed=s.seed)
    vehicle = Vehicle(current=s.current, position=np.array([0.0, 0.0, -s.range_m]))
    head = PanTilt() if s.head else None
    rng = np.random.default_rng([s.seed, 5])
    taken = measurer(camera.size)
    home, dt = vehicle.position.copy(), 1 / s.rate
    first = world.look_pair(camera, DOWN.sight(vehicle, head), BASELINE_M)
    true_range = float(np.median(first[0].depth))
    meter = StationMeter(taken, camera.focal, s.guess_m or stereo_range(taken, camera, first), s.window)
    keeper: StationKeeper | None = None
    for k in range(round(s.seconds * s.rate)):
        shot = world.look(camera, DOWN.sight(vehicle, head))
        roll, pitch = (float(a) for a in vehicle.attitude[:2] + rng.normal(0, s.level_noise, 2))
        level = Level(roll, pitch, head.pan, head.tilt) if head else Level(roll, pitch)
        sensed = Sensed(level, float(vehicle.velocity[5] + rng.normal(0, s.rate_noise)))
        if keeper is None:
            if meter.anchor(meter.view(shot.frame), level) < meter.least:
                raise SignumError("the picture at the station offers too few features for station keeping")
            keeper = StationKeeper(meter)
        reading, force = keeper.step(meter.view(shot.frame), sensed, dt)
        off = vehicle.position - home
        truth = (float(off[0]), float(off[1]), float(off[2]), float(vehicle.attitude[2]))
        yield Moment(k * dt, reading, truth, true_range - float(off[2]), shot.frame, meter.features_at(level),
                     (float(vehicle.attitude[0]), float(vehicle.attitude[1])))
        outside = np.zeros(6)
        if s.shoved and s.shoved[0] <= vehicle.time < s.shoved[1]:
            outside[:3] = vehicle.turn.T @ np.array([*s.shove, 0.0])
        vehicle.step((force if s.control else np.zeros(6)) + outside, dt)
        if head is not None:
            aim = (meter.middle_at(level) - meter.centre) / camera.focal if keeper.blind == 0 else np.zeros(2)
            head.step(HEAD_RATE * float(aim[0]), -HEAD_RATE * float(aim[1]), dt)
        world.step(dt)


def occluder(when: tuple[float, float] | None) -> Callable[[Float, float], None] | None:
    """Paints an even grey gradient over the whole picture from `when[0]` to `when[1]` seconds; None for never."""
    if when is None:
        return None

    def paint(image: Float, time: float) -> None:
        if when[0] <= time < when[1]:
            image[:] = 90 + np.linspace(0, 20, image.shape[1], dtype=np.float32)

    return paint


def stereo_range(measurer: Measurer, camera: Pinhole, pair: tuple[Shot, Shot], near: float = 0.6, far: float = 6.0
                 ) -> float:
    """Range by a stereo pair, metres: the median over the picture's middle half.

    Raises:
        SignumError: if fewer than four windows are matched between `near` and `far` metres.
    """
    left, right = measurer.pair(pair[0].frame, pair[1].frame)
    ends = camera.focal * BASELINE_M / np.array([far, near])
    try:
        found = measure_range(measurer, left, right, (int(ends[0]), int(np.ceil(ends[1]))), (48, 48), 24)
    finally:
        measurer.release(left)
        measurer.release(right)
    rows, columns = (slice(n // 4, n - n // 4) for n in found.disparity.shape)
    depth = StereoGeometry(camera.focal, BASELINE_M, camera.centre).depth(found.disparity[rows, columns])
    if np.isfinite(depth).sum() < 4:
        raise SignumError("stereo measures no range at the station: give one with --range")
    return float(np.nanmedian(depth))
