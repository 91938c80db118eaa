"""The vehicle goes to a place of its mosaic and stays above it: six degrees of freedom, a current with surge, and
nothing measured but frames against the mosaic, and roll and pitch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from signum.applications.hold.keeper import STRIDE_M, Axes
from signum.applications.navigate.chart import Chart
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.pilot import Aim, Pilot
from signum.applications.navigate.simulate import Step
from signum.applications.navigate.truth import Make, Taken, Truth, survey
from signum.common.arrays import Floats
from signum.geometry.camera import LOOK_DOWN, rotation
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Current, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World

DRIFT = Current(steady=(0.1, 0.05), surge=(0.03, 0.03, 0.01), period=8.0)
LEVEL_NOISE = 0.001
"""Standard deviation of the attitude sensor's roll and pitch, radians."""


@dataclass(frozen=True)
class Dive:
    """What is simulated.

    Attributes:
        height: over the mean floor, metres; relief: standard deviation of the floor's.
        area: half sides of the surveyed grid, metres north and east; pitch: between its pictures.
        rate: frames a second afterwards.
        current, water, photo: of the sea.
        seed: of everything.
    """

    height: float = 2.0
    relief: float = 0.03
    area: tuple[float, float] = (1.0, 1.0)
    pitch: tuple[float, float] = (0.5, 0.67)
    rate: float = 10.0
    current: Current = DRIFT
    water: Water = COASTAL
    photo: str = "gravel"
    seed: int = 0


@dataclass
class VehicleSteering:
    """Forces that bring the vehicle above the target, at the survey's height and heading: the station keeper's loops on
    the way the mosaic tells.

    Attributes:
        focal: pixels of the frames; range_m: height of the survey over the floor, metres.
    """

    focal: float
    range_m: float
    axes: Axes = field(default_factory=Axes)

    def __post_init__(self) -> None:
        self._loops = self.axes.loops()
        self._errors: Floats | None = None

    def forces(self, aim: Aim, level: tuple[float, float], dt: float) -> Floats:
        """(6,) N and N m in body axes.

        Args:
            aim: of the frame just seen.
            level: roll and pitch, radians.
            dt: seconds between frames.
        """
        if aim.place.similarity is None or not aim.known:
            self._errors = None
            axes = [loop.hold() for loop in self._loops]
        else:
            found = aim.place.similarity
            below = LOOK_DOWN.T @ rotation(*level, 0.0).T @ np.array([0.0, 0.0, 1.0])
            way = (aim.error - self.focal * below[:2] / below[2]) * found.scale * self.range_m / self.focal
            errors = np.array([-way[1], way[0], self.range_m * (found.scale - 1), -np.radians(found.rot_deg)])
            rates = np.zeros(4) if self._errors is None else (errors - self._errors) / dt
            self._errors = errors
            far = max(1.0, float(np.hypot(*way)) / STRIDE_M)
            shown = errors / np.array([far, far, 1.0, 1.0])
            # What it takes to come from far away is no current, and must not be learnt.
            axes = [loop.step(float(e), dt, float(r), far <= 1)
                    for loop, e, r in zip(self._loops, shown, rates, strict=True)]
        return np.array([axes[0], axes[1], axes[2], 0.0, 0.0, axes[3]])


@dataclass
class VehicleSite:
    """A vehicle over a seafloor, and the mosaic it made."""

    dive: Dive
    camera: Pinhole = field(default_factory=Pinhole)
    world: World = field(init=False, repr=False)
    truth: Truth = field(init=False, repr=False)

    def __post_init__(self) -> None:
        d = self.dive
        extent = 2 * max(d.area) + 3 * d.height
        floor = Seafloor(extent=extent, relief=d.relief, texel=d.height / 500, photo=d.photo, seed=d.seed)
        self.world = World(floor, d.water, current=d.current, seed=d.seed)
        self.truth = Truth(self.camera, lambda points: points)
        self._rng = np.random.default_rng([d.seed, 6])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the frames, pixels."""
        return self.camera.size

    def survey(self, measurer: Make, out: Path, tell: Callable[[str], None] | None = None) -> Chart:
        """Fly columns back and forth, and build the mosaic in `out`."""
        return survey(measurer, self._columns(), self.truth, out, tell)

    def _columns(self) -> Iterator[Taken]:
        d = self.dive
        norths, easts = (np.linspace(-a, a, round(2 * a / p) + 1) for a, p in zip(d.area, d.pitch, strict=True))
        for i, east in enumerate(easts):
            for north in norths if i % 2 == 0 else norths[::-1]:
                sway = self._rng.normal(0, 0.01, 3)
                vehicle = Vehicle(position=np.array([north, east, -d.height]), attitude=sway)
                sight = DOWN.sight(vehicle)
                shot = self.world.look(self.camera, sight)
                yield Taken(shot.frame, sight, shot.depth)
                self.world.step(1.0)

    def random_start(self, rng: np.random.Generator) -> Vehicle:
        """A vehicle somewhere over the survey, a little turned."""
        d = self.dive
        north, east = (float(rng.uniform(-a, a)) for a in d.area)
        return Vehicle(current=d.current, position=np.array([north, east, -d.height]),
                       attitude=np.array([0.0, 0.0, float(rng.uniform(-0.1, 0.1))]))

    def go(self, localiser: Localiser, target: tuple[float, float], vehicle: Vehicle, seconds: float = 40.0
           ) -> Iterator[Step]:
        """Go to a place and stay above it until the time is up; the truth of a step is the horizontal way in body axes,
        in pixels of a level camera."""
        d, dt = self.dive, 1 / self.dive.rate
        pilot, steering = Pilot(localiser, target), VehicleSteering(self.camera.focal, d.height)
        goal = self.truth.world_point(localiser.chart, target)
        for k in range(round(seconds * d.rate)):
            frame = self.world.look(self.camera, DOWN.sight(vehicle)).frame
            aim = pilot.look(frame)
            away = rotation(0.0, 0.0, float(vehicle.attitude[2])).T @ (goal - vehicle.position)
            truth = np.array([away[1], -away[0]]) * self.camera.focal / d.height
            yield Step(k * dt, aim, truth, frame)
            level = vehicle.attitude[:2] + self._rng.normal(0, LEVEL_NOISE, 2)
            vehicle.step(steering.forces(aim, (float(level[0]), float(level[1])), dt), dt)
            self.world.step(dt)
