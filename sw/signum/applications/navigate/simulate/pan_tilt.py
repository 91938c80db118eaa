# SPDX-License-Identifier: Apache-2.0
"""A camera on a pan/tilt surveys a seafloor from one position, and is then sent to chosen points of its own mosaic."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from signum.applications.mosaic.settings import CURVED
from signum.applications.navigate.aim import Aim, TargetFinder
from signum.applications.navigate.chart import Chart
from signum.applications.navigate.conformal import Conformal
from signum.applications.navigate.localise import Localiser
from signum.applications.navigate.place import Place
from signum.applications.navigate.simulate.truth import Make, Taken, Truth, build_chart
from signum.applications.navigate.steering import PanTiltSteering
from signum.common.arrays import Floats, Image
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor
from signum.world.vehicle import DOWN, PanTilt, Vehicle
from signum.world.water import COASTAL, Water
from signum.world.world import World


@dataclass(frozen=True)
class PanTiltScene:
    """The survey and the sea to simulate.

    Attributes:
        height: of the pan/tilt over the mean floor, metres; relief: standard deviation of the floor's, metres.
        sweep: largest pan and tilt of the survey, radians; pitch: between its pictures.
        rate: frames a second afterwards.
        water, photo: of the floor.
        seed: of everything.
    """

    height: float = 2.0
    relief: float = 0.05
    sweep: tuple[float, float] = (0.54, 0.36)
    pitch: float = 0.18
    rate: float = 10.0
    water: Water = COASTAL
    photo: str = "gravel"
    seed: int = 0


@dataclass(frozen=True)
class Step:
    """One frame of a run: the measured aim, and the true vector (2,) from the frame's middle to the target, pixels."""

    time: float
    aim: Aim
    truth: Floats
    frame: Image


@dataclass
class PanTiltSite:
    """A pan/tilt over a seafloor, and the truth of the mosaic built from its pictures."""

    scene: PanTiltScene
    camera: Pinhole = field(default_factory=Pinhole)
    world: World = field(init=False, repr=False)
    vehicle: Vehicle = field(init=False, repr=False)
    redrawn: Conformal = field(init=False, repr=False)
    truth: Truth = field(init=False, repr=False)

    def __post_init__(self) -> None:
        s = self.scene
        floor = Seafloor(extent=6 * s.height, relief=s.relief, texel=s.height / 500, photo=s.photo, seed=s.seed)
        self.world = World(floor, s.water, seed=s.seed)
        self.redrawn = Conformal(self.camera.size, self.camera.focal)
        self.vehicle = Vehicle(position=np.array([0.0, 0.0, -s.height]))
        self.truth = Truth(self.camera, self.redrawn.pinhole)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the frames, pixels."""
        return self.redrawn.shown

    def look(self, head: PanTilt) -> Image:
        """The present frame, redrawn."""
        return self._take(head).picture

    def survey(self, measurer: Make, out: Path, tell: Callable[[str], None] | None = None) -> Chart:
        """Sweep back and forth, and build the mosaic in `out`; `tell` is called after every picture."""
        return build_chart(measurer, self._sweep(), self.truth, out, tell, CURVED)

    def _take(self, head: PanTilt) -> Taken:
        sight = DOWN.sight(self.vehicle, head)
        shot = self.world.look(self.camera, sight)
        return Taken(self.redrawn(shot.frame), sight, shot.depth)

    def _sweep(self) -> Iterator[Taken]:
        s = self.scene
        pans, tilts = (np.linspace(-a, a, round(2 * a / s.pitch) + 1) for a in s.sweep)
        for i, pan in enumerate(pans):
            for tilt in tilts if i % 2 == 0 else tilts[::-1]:
                yield self._take(PanTilt(pan=float(pan), tilt=float(tilt)))
                self.world.step(0.5)

    def true_way(self, target: Floats, head: PanTilt) -> Floats:
        """True vector (2,) from the middle of the frame to a world point, pixels."""
        seen = self.camera.project(DOWN.sight(self.vehicle, head), target)[0]
        return np.asarray(seen - np.array(self.camera.centre), np.float64)

    def random_head(self, rng: np.random.Generator) -> PanTilt:
        """A pan/tilt turned to a random direction within the survey."""
        return PanTilt(pan=float(rng.uniform(-1, 1) * self.scene.sweep[0]),
                       tilt=float(rng.uniform(-1, 1) * self.scene.sweep[1]))

    def go(self, localiser: Localiser, target: tuple[float, float], head: PanTilt, seconds: float = 20.0,
           dwell: float = 1.5, close_px: float = 2.0) -> Iterator[Step]:
        """Look at a place, beginning from the present direction of the head.

        Ends after `dwell` seconds within `close_px` pixels of it as measured, or after `seconds`.
        """
        dt = 1 / self.scene.rate
        finder, steering = TargetFinder(localiser, target), PanTiltSteering(self.camera.focal)
        goal = self.truth.world_point(localiser.chart, target)
        there = 0.0
        for k in range(round(seconds * self.scene.rate)):
            frame = self.look(head)
            aim = finder.look(frame)
            yield Step(k * dt, aim, self.true_way(goal, head), frame)
            close = aim.sharp and float(np.hypot(*aim.error)) <= close_px
            there = there + dt if close else 0.0
            if there >= dwell:
                return
            head.step(*steering.rates(aim, dt), dt)
            self.world.step(dt)


def miss(site: PanTiltSite, chart: Chart, place: Place, head: PanTilt) -> float:
    """True error of a found place at the frame's centre, pixels of the frame; infinite off the mosaic."""
    if not chart.covers(*place.centre):
        return float("inf")
    return float(np.hypot(*site.true_way(site.truth.world_point(chart, place.centre), head)))
