"""Station keeping in the simulated world, with the truth beside every reading."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sw.hold.keeper import Sensed, StationKeeper
from sw.hold.meter import Reading, StationMeter
from sw.measure import Measurer
from sw.world.camera import Pinhole
from sw.world.seafloor import Float, Seafloor
from sw.world.vehicle import DOWN, Current, Vehicle
from sw.world.water import PAPER, Water
from sw.world.world import World

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]


SURGE = Current(steady=(0.2, 0.0), surge=(0.06, 0.08, 0.03), period=8.0)
"""A fifth of a metre per second, with surge from all sides."""


@dataclass(frozen=True)
class Scenario:
    """A hold to simulate.

    Attributes:
        seconds: length; rate: frames per second.
        range_m: height over the mean floor.
        current: of the water.
        occluded: (from, to) seconds in which something hangs before the camera; None for never.
        shoved: (from, to) seconds in which something pushes the vehicle with `shove` N north and east.
        level_noise: standard deviation of the attitude sensor's roll and pitch, radians; rate_noise: of its yaw rate.
    """

    seconds: float = 600.0
    rate: float = 10.0
    range_m: float = 2.0
    current: Current = SURGE
    water: Water = PAPER
    relief: float = 0.05
    occluded: tuple[float, float] | None = None
    shoved: tuple[float, float] | None = None
    shove: tuple[float, float] = (30.0, 20.0)
    level_noise: float = 0.001
    rate_noise: float = 0.002
    seed: int = 0


@dataclass(frozen=True)
class Moment:
    """One frame of a hold: time, reading, true offset from the station and the frame itself.

    `truth` is (forward, right, down, heading), metres and radians in the station's axes.
    """

    time: float
    reading: Reading
    truth: tuple[float, float, float, float]
    frame: Picture


def occluder(when: tuple[float, float] | None) -> Callable[[Float, float], None] | None:
    """Something that hangs before the lens for a while: a smooth grey veil over the whole picture."""
    if when is None:
        return None

    def paint(image: Float, time: float) -> None:
        if when[0] <= time < when[1]:
            image[:] = 90 + np.linspace(0, 20, image.shape[1], dtype=np.float32)

    return paint


def hold(measurer: Callable[[tuple[int, int]], Measurer], scenario: Scenario, camera: Pinhole | None = None
         ) -> Iterator[Moment]:
    """Fly a scenario, frame by frame."""
    s = scenario
    camera = camera or Pinhole()
    world = World(Seafloor(extent=6.0, relief=s.relief, texel=0.0025, seed=s.seed), s.water, current=s.current,
                  occluder=occluder(s.occluded), seed=s.seed)
    vehicle = Vehicle(current=s.current, position=np.array([0.0, 0.0, -s.range_m]))
    rng = np.random.default_rng([s.seed, 5])
    meter = StationMeter(measurer(camera.size), camera.focal, s.range_m)
    keeper: StationKeeper | None = None
    home, dt, force = vehicle.position.copy(), 1 / s.rate, np.zeros(6)
    for k in range(round(s.seconds * s.rate)):
        shot = world.look(camera, DOWN.sight(vehicle))
        roll, pitch = vehicle.attitude[:2] + rng.normal(0, s.level_noise, 2)
        sensed = Sensed((float(roll), float(pitch)), float(vehicle.velocity[5] + rng.normal(0, s.rate_noise)))
        if keeper is None:
            meter.range_m = float(np.median(shot.depth))
            meter.anchor(meter.measurer.view(shot.frame), sensed.level)
            keeper = StationKeeper(meter)
        reading, force = keeper.step(meter.measurer.view(shot.frame), sensed, dt)
        off = vehicle.position - home
        truth = (float(off[0]), float(off[1]), float(off[2]), float(vehicle.attitude[2]))
        yield Moment(k * dt, reading, truth, shot.frame)
        outside = np.zeros(6)
        if s.shoved and s.shoved[0] <= vehicle.time < s.shoved[1]:
            outside[:3] = vehicle.turn.T @ np.array([*s.shove, 0.0])
        vehicle.step(force + outside, dt)
        world.step(dt)


@dataclass
class HoldFigures:
    """What a hold was like; metres, radians, fractions."""

    rms_m: float
    heading_rms: float
    range_rms: float
    drift_m: float
    valid: float
    worst_valid_m: float
    wrong: int
    longest_blind: int = 0
    series: Array = field(default_factory=lambda: np.zeros((0, 10)), repr=False)
    """Per frame: time, truth (4), reading (forward, right, heading, range), confidence."""


WRONG_M, WRONG_RAD = 0.04, 0.02
"""A valid reading farther from the truth than this is a wrong one."""


def judge(moments: list[Moment], settle: float = 10.0) -> HoldFigures:
    """Figures of a hold, from `settle` seconds on."""
    rows = np.array([[m.time, *m.truth, m.reading.forward, m.reading.right, m.reading.heading, m.reading.range_m,
                      m.reading.confidence] for m in moments])
    after = rows[rows[:, 0] >= settle]
    ok = after[:, 9] > 0
    miss = np.hypot(after[:, 5] - after[:, 1], after[:, 6] - after[:, 2])
    wrong = ok & ((miss > WRONG_M) | (np.abs(after[:, 7] - after[:, 4]) > WRONG_RAD))
    first, last = after[after[:, 0] < settle + 60], after[after[:, 0] >= after[-1, 0] - 60]
    drift = np.hypot(*(last[:, 1:3].mean(axis=0) - first[:, 1:3].mean(axis=0)))
    start = rows[0, 8] if rows[0, 9] > 0 else float("nan")
    blind = max((len(run) for run in "".join("1" if v else "0" for v in ok).split("1")), default=0)
    return HoldFigures(
        float(np.sqrt((after[:, 1] ** 2 + after[:, 2] ** 2).mean())), float(np.sqrt((after[:, 4] ** 2).mean())),
        float(np.sqrt(((after[ok, 8] - (start - after[ok, 3])) ** 2).mean()) / start), float(drift), float(ok.mean()),
        float(miss[ok].max()) if ok.any() else float("nan"), int(wrong.sum()), blind, rows)
