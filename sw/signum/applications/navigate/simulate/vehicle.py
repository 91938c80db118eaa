# SPDX-License-Identifier: Apache-2.0
"""A vehicle goes to a place of its mosaic and stays above it: six degrees of freedom, a current with surge.

Its measurements are frames against the mosaic, and roll and pitch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from signum.applications.navigate.aim import TargetFinder
from signum.applications.navigate.chart import Chart
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.simulate.pan_tilt import Step
from signum.applications.navigate.simulate.truth import Make, Taken, Truth, build_chart
from signum.applications.navigate.steering import VehicleSteering
from signum.geometry.camera import rotation
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, Current, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World

DIVE_CURRENT = Current(steady=(0.1, 0.05), surge=(0.03, 0.03, 0.01), period=8.0)
"""A tenth of a metre per second across the columns of the survey, with surge."""
LEVEL_NOISE = 0.001
"""Standard deviation of the attitude sensor's roll and pitch, radians."""


@dataclass(frozen=True)
class Dive:
    """The survey and the sea to simulate.

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
    current: Current = DIVE_CURRENT
    water: Water = COASTAL
    photo: str = "gravel"
    seed: int = 0


@dataclass
class VehicleSite:
    """A vehicle over a seafloor, and the truth of the mosaic built from its pictures."""

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
        """Fly columns back and forth, and build the mosaic in `out`; `tell` is called after every picture."""
        return build_chart(measurer, self._columns(), self.truth, out, tell)

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
        """A vehicle at a random position over the survey, turned by up to 0.1 rad."""
        d = self.dive
        north, east = (float(rng.uniform(-a, a)) for a in d.area)
        return Vehicle(current=d.current, position=np.array([north, east, -d.height]),
                       attitude=np.array([0.0, 0.0, float(rng.uniform(-0.1, 0.1))]))

    def go(self, localiser: Localiser, target: tuple[float, float], vehicle: Vehicle, seconds: float = 40.0
           ) -> Iterator[Step]:
        """Go to a place and stay above it for `seconds`; the truth of a step is the horizontal vector to the place in
        body axes, in pixels of a level camera."""
        d, dt = self.dive, 1 / self.dive.rate
        finder, steering = TargetFinder(localiser, target), VehicleSteering(self.camera.focal, d.height)
        goal = self.truth.world_point(localiser.chart, target)
        for k in range(round(seconds * d.rate)):
            frame = self.world.look(self.camera, DOWN.sight(vehicle)).frame
            aim = finder.look(frame)
            away = rotation(0.0, 0.0, float(vehicle.attitude[2])).T @ (goal - vehicle.position)
            truth = np.array([away[1], -away[0]]) * self.camera.focal / d.height
            yield Step(k * dt, aim, truth, frame)
            level = vehicle.attitude[:2] + self._rng.normal(0, LEVEL_NOISE, 2)
            vehicle.step(steering.forces(aim, (float(level[0]), float(level[1])), dt), dt)
            self.world.step(dt)
