"""Mosaic navigation in the simulated world: a camera on a pan/tilt surveys a seafloor from one place, and is then sent
to chosen points of its own mosaic. The truth stands beside every measurement and never gets into one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sw.geometry import Similarity
from sw.measure import Measurer
from sw.mosaic import Column
from sw.navigate.chart import Chart
from sw.navigate.localise import Localiser, Place
from sw.navigate.pilot import Aim, PanTiltSteering, Pilot
from sw.register import Registrar
from sw.sources import Fit, Frame, Picture
from sw.world.camera import Pinhole, Sight
from sw.world.seafloor import Seafloor
from sw.world.vehicle import DOWN, PanTilt, Vehicle
from sw.world.water import COASTAL, Water
from sw.world.world import World

Array = NDArray[np.float64]
Make = Callable[[tuple[int, int], float], Measurer]
SIGMA = 2.0
WINDOW = 64


@dataclass(frozen=True)
class Scene:
    """What is simulated.

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
    """One frame of a way: what was measured, and in truth the way to go, original pixels in the frame."""

    time: float
    aim: Aim
    truth: Array
    frame: Picture


@dataclass
class PanTiltSite:
    """A pan/tilt over a seafloor, and the mosaic it made."""

    scene: Scene
    camera: Pinhole = field(default_factory=Pinhole)
    world: World = field(init=False, repr=False)
    vehicle: Vehicle = field(init=False, repr=False)
    shots: list[tuple[Similarity, Sight, NDArray[np.float32]]] = field(init=False, default_factory=list, repr=False)
    """Truth of the survey: of every placed picture, its pixels -> mosaic.png, where it was taken from, its depths."""

    def __post_init__(self) -> None:
        s = self.scene
        floor = Seafloor(extent=6 * s.height, relief=s.relief, texel=s.height / 500, photo=s.photo, seed=s.seed)
        self.world = World(floor, s.water, seed=s.seed)
        self.vehicle = Vehicle(position=np.array([0.0, 0.0, -s.height]))

    def look(self, head: PanTilt) -> Picture:
        """What the camera sees now."""
        return self.world.look(self.camera, DOWN.sight(self.vehicle, head)).frame

    def survey(self, measurer: Make, largest: tuple[int, int], out: Path, tell: Callable[[str], None] | None = None
               ) -> Chart:
        """Sweep back and forth, build the mosaic in `out`, and remember for the judge what it shows where."""
        shown = Fit(self.camera.size, self.camera.size)
        taken: dict[str, tuple[Sight, NDArray[np.float32]]] = {}
        with Column(Registrar.on(measurer, shown, WINDOW, SIGMA), out) as column:
            for k, head in enumerate(self._sweep()):
                sight = DOWN.sight(self.vehicle, head)
                shot = self.world.look(self.camera, sight)
                taken[str(k)] = sight, shot.depth
                column.add(Frame(str(k), shot.frame))
                self.world.step(0.5)
                if tell is not None:
                    tell("survey")
        stored = column.pieces[0].stored
        corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * (np.array(self.camera.size) - 1)
        low = np.floor(np.min([s.place(corners).min(axis=0) for s in stored], axis=0))
        view = Similarity(1 + 0j, -complex(*low))
        self.shots = [(view @ s.place, *taken[s.name]) for s in stored]
        return Chart.load(out)

    def _sweep(self) -> Iterator[PanTilt]:
        s = self.scene
        pans, tilts = (np.linspace(-a, a, round(2 * a / s.pitch) + 1) for a in s.sweep)
        for i, pan in enumerate(pans):
            for tilt in tilts if i % 2 == 0 else tilts[::-1]:
                yield PanTilt(pan=float(pan), tilt=float(tilt))

    def world_point(self, target: tuple[float, float]) -> Array:
        """Truth: the world point (3,) a pixel of the mosaic shows, by the picture whose centre is nearest to it."""
        at, centre = np.array(target), (np.array(self.camera.size, np.float64) - 1) / 2
        place, sight, depth = min(self.shots, key=lambda s: float(np.hypot(*(s[0](centre) - at))))
        x, y = place.inverse(at)
        z = float(depth[int(np.clip(round(float(y)), 0, depth.shape[0] - 1)),
                        int(np.clip(round(float(x)), 0, depth.shape[1] - 1))])
        ray = np.array([(x - centre[0]) / self.camera.focal, (y - centre[1]) / self.camera.focal, 1.0])
        return np.asarray(sight.position + sight.rotation @ (z * ray), np.float64)

    def true_place(self, target: Array, head: PanTilt) -> Array:
        """Truth: (2,) from the middle of the frame to a world point, pixels."""
        seen = self.camera.project(DOWN.sight(self.vehicle, head), target)[0]
        return np.asarray(seen - np.array(self.camera.centre), np.float64)

    def random_head(self, rng: np.random.Generator) -> PanTilt:
        """A pan/tilt turned by hand to anywhere in the survey."""
        return PanTilt(pan=float(rng.uniform(-1, 1) * self.scene.sweep[0]),
                       tilt=float(rng.uniform(-1, 1) * self.scene.sweep[1]))

    def random_target(self, chart: Chart, rng: np.random.Generator) -> tuple[float, float]:
        """A place of the mosaic that can be looked at with most of the picture on the mosaic: a third of the frame from
        its border."""
        reach_x, reach_y = (n / 3 for n in self.camera.size)
        while True:
            x, y = (float(rng.uniform(r, n - r)) for r, n in zip((reach_x, reach_y), chart.size, strict=True))
            if all(chart.covers(x + i * reach_x, y + j * reach_y) for i in (-1, 0, 1) for j in (-1, 0, 1)):
                return x, y

    def go(self, localiser: Localiser, target: tuple[float, float], head: PanTilt, seconds: float = 20.0,
           dwell: float = 1.5, close_px: float = 2.0) -> Iterator[Step]:
        """Look at a place, from wherever the head happens to point; ends after `dwell` seconds within `close_px` of it
        by its own measurement, or when the time is up."""
        dt = 1 / self.scene.rate
        pilot, steering = Pilot(localiser, target), PanTiltSteering(self.camera.focal)
        goal = self.world_point(target)
        there = 0.0
        for k in range(round(seconds * self.scene.rate)):
            frame = self.look(head)
            aim = pilot.look(frame)
            yield Step(k * dt, aim, self.true_place(goal, head), frame)
            close = aim.sharp and float(np.hypot(*aim.error)) <= close_px
            there = there + dt if close else 0.0
            if there >= dwell:
                return
            head.step(*steering.rates(aim, dt), dt)
            self.world.step(dt)


def miss(site: PanTiltSite, chart: Chart, place: Place, head: PanTilt) -> float:
    """Truth: how far a found place is from where the frame's centre really is, pixels of the frame."""
    inside = chart.covers(*place.centre)
    if not inside:
        return float("inf")
    return float(np.hypot(*site.true_place(site.world_point(place.centre), head)))
