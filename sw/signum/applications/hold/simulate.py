"""Station keeping in the simulated world, with the truth beside every reading."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.meter import Level, Reading, StationMeter
from signum.common.arrays import Floats, Image
from signum.common.errors import SignumError
from signum.geometry.calibration import StereoGeometry
from signum.measure.measurer import Measurer
from signum.measure.stereo import measure_range
from signum.world.camera import Pinhole
from signum.world.seafloor import Float, Seafloor
from signum.world.vehicle import DOWN, Current, PanTilt, Vehicle
from signum.world.water import PAPER, Water
from signum.world.world import Shot, World

SURGE = Current(steady=(0.2, 0.0), surge=(0.06, 0.08, 0.03), period=8.0)
"""A fifth of a metre per second, with surge from all sides."""
BASELINE_M = 0.12
HEAD_RATE = 4.0
"""Rate of the pan/tilt per angle it is off, 1/s: settled in a second, well below the frame rate."""


@dataclass(frozen=True)
class Scenario:
    """A hold to simulate.

    Attributes:
        seconds: length; rate: frames per second.
        range_m: height over the mean floor.
        current: of the water.
        guess_m: the range the vehicle takes for true; None to measure it by stereo once, at the station.
        head: whether the camera sits on a pan/tilt that keeps looking at the station's middle.
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
    guess_m: float | None = None
    head: bool = False
    occluded: tuple[float, float] | None = None
    shoved: tuple[float, float] | None = None
    shove: tuple[float, float] = (30.0, 20.0)
    level_noise: float = 0.001
    rate_noise: float = 0.002
    seed: int = 0

    @property
    def apart(self) -> tuple[tuple[float, float], ...]:
        """(from, to) seconds that are no station keeping: blind or pushed, and 10 s to come back."""
        return tuple((begin, end + 10.0) for begin, end in filter(None, (self.occluded, self.shoved)))


@dataclass(frozen=True, eq=False)
class Moment:
    """One frame of a hold: time, reading, true offset from the station, and for pictures the frame and its features.

    `truth` is (forward, right, down, heading), metres and radians in the station's axes; `range_m` the true range;
    `features` (n, 2) pixels where the reading puts them; `level` the true roll and pitch.
    """

    time: float
    reading: Reading
    truth: tuple[float, float, float, float]
    range_m: float
    frame: Image
    features: Floats
    level: tuple[float, float] = (0.0, 0.0)

    @property
    def row(self) -> tuple[float, ...]:
        """Time, truth (4), reading (forward, right, heading, range), confidence, true range, agreed, tried."""
        r = self.reading
        return (self.time, *self.truth, r.forward, r.right, r.heading, r.range_m, r.confidence, self.range_m, r.agreed,
                r.tried)


def occluder(when: tuple[float, float] | None) -> Callable[[Float, float], None] | None:
    """Something that hangs before the lens for a while: a smooth grey veil over the whole picture."""
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
        SignumError: if hardly anything can be matched between `near` and `far` metres.
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
        raise SignumError("stereo sees no range at the station: give one with --range")
    return float(np.nanmedian(depth))


def hold(measurer: Callable[[tuple[int, int]], Measurer], scenario: Scenario, camera: Pinhole | None = None
         ) -> Iterator[Moment]:
    """Fly a scenario, frame by frame."""
    s = scenario
    camera = camera or Pinhole()
    world = World(Seafloor(extent=6.0, relief=s.relief, texel=0.0025, seed=s.seed), s.water, current=s.current,
                  occluder=occluder(s.occluded), seed=s.seed)
    vehicle = Vehicle(current=s.current, position=np.array([0.0, 0.0, -s.range_m]))
    head = PanTilt() if s.head else None
    rng = np.random.default_rng([s.seed, 5])
    taken = measurer(camera.size)
    home, dt = vehicle.position.copy(), 1 / s.rate
    first = world.look_pair(camera, DOWN.sight(vehicle, head), BASELINE_M)
    true_range = float(np.median(first[0].depth))
    meter = StationMeter(taken, camera.focal, s.guess_m or stereo_range(taken, camera, first))
    keeper: StationKeeper | None = None
    for k in range(round(s.seconds * s.rate)):
        shot = world.look(camera, DOWN.sight(vehicle, head))
        roll, pitch = (float(a) for a in vehicle.attitude[:2] + rng.normal(0, s.level_noise, 2))
        level = Level(roll, pitch, head.pan, head.tilt) if head else Level(roll, pitch)
        sensed = Sensed(level, float(vehicle.velocity[5] + rng.normal(0, s.rate_noise)))
        if keeper is None:
            if meter.anchor(taken.view(shot.frame), level) < meter.least:
                raise SignumError("the picture at the station offers too few features to hold on to")
            keeper = StationKeeper(meter)
        reading, force = keeper.step(taken.view(shot.frame), sensed, dt)
        off = vehicle.position - home
        truth = (float(off[0]), float(off[1]), float(off[2]), float(vehicle.attitude[2]))
        yield Moment(k * dt, reading, truth, true_range - float(off[2]), shot.frame, meter.features_at(level),
                     (float(vehicle.attitude[0]), float(vehicle.attitude[1])))
        outside = np.zeros(6)
        if s.shoved and s.shoved[0] <= vehicle.time < s.shoved[1]:
            outside[:3] = vehicle.turn.T @ np.array([*s.shove, 0.0])
        vehicle.step(force + outside, dt)
        if head is not None:
            aim = (meter.middle_at(level) - meter.centre) / camera.focal if keeper.blind == 0 else np.zeros(2)
            head.step(HEAD_RATE * float(aim[0]), -HEAD_RATE * float(aim[1]), dt)
        world.step(dt)


@dataclass
class HoldFigures:
    """What a hold was like; metres, radians, fractions. `range_rms` is of the vehicle's true range about its station's,
    `range_miss` of the valid readings about the truth."""

    rms_m: float
    heading_rms: float
    range_rms: float
    range_miss: float
    drift_m: float
    valid: float
    worst_valid_m: float
    wrong: int
    longest_blind: int = 0
    series: Floats = field(default_factory=lambda: np.zeros((0, 13)), repr=False)


WRONG_M, WRONG_RAD = 0.04, 0.02
"""A valid reading farther from the truth than this is a wrong one."""


def judge(moments: Sequence[Moment], settle: float = 10.0) -> HoldFigures:
    """Figures of a hold, from `settle` seconds on."""
    return judge_rows(np.array([m.row for m in moments]), settle)


def judge_rows(rows: Floats, settle: float = 10.0, apart: Sequence[tuple[float, float]] = ()) -> HoldFigures:
    """Figures of a hold from its moments' rows (n, 13), from `settle` seconds on.

    Args:
        apart: (from, to) seconds that do not count for the position, heading and range errors: something pushed the
            vehicle away or blinded it. They do count for wrong readings.
    """
    after = rows[rows[:, 0] >= settle]
    ok = after[:, 9] > 0
    miss = np.hypot(after[:, 5] - after[:, 1], after[:, 6] - after[:, 2])
    wrong = ok & ((miss > WRONG_M) | (np.abs(after[:, 7] - after[:, 4]) > WRONG_RAD))
    counts = np.ones(len(after), bool)
    for begin, end in apart:
        counts &= (after[:, 0] < begin) | (after[:, 0] >= end)
    calm = after[counts]
    first, last = calm[calm[:, 0] < settle + 60], calm[calm[:, 0] >= calm[-1, 0] - 60]
    drift = np.hypot(*(last[:, 1:3].mean(axis=0) - first[:, 1:3].mean(axis=0)))
    blind = max((len(run) for run in "".join("1" if v else "0" for v in ok).split("1")), default=0)
    station = rows[0, 10]
    return HoldFigures(
        float(np.sqrt((calm[:, 1] ** 2 + calm[:, 2] ** 2).mean())), float(np.sqrt((calm[:, 4] ** 2).mean())),
        float(np.sqrt(((calm[:, 10] / station - 1) ** 2).mean())),
        float(np.sqrt(((after[ok, 8] / after[ok, 10] - 1) ** 2).mean())), float(drift), float(ok.mean()),
        float(miss[ok].max()) if ok.any() else float("nan"), int(wrong.sum()), blind, rows)
