"""Mosaic navigation in the simulated world: a camera on a pan/tilt surveys a seafloor from one place, and is then sent
to chosen points of its own mosaic. The truth stands beside every measurement and never gets into one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sw.blend import bounds
from sw.geometry import Similarity
from sw.measure import Measurer
from sw.navigate.chart import Chart
from sw.navigate.conformal import Conformal
from sw.navigate.localise import Localiser, Place
from sw.navigate.pilot import Aim, PanTiltSteering, Pilot
from sw.register import Registrar
from sw.sources import Fit, Frame, Picture
from sw.survey.survey import Survey
from sw.world.camera import Pinhole, Sight
from sw.world.seafloor import Seafloor
from sw.world.vehicle import DOWN, PanTilt, Vehicle
from sw.world.water import COASTAL, Water
from sw.world.world import World

Array = NDArray[np.float64]
Make = Callable[[tuple[int, int], float], Measurer]
SIGMA = 2.0
WINDOW = 64
PATCH = 12
"""Half the side of the patch by which the judge tells which picture a pixel of the mosaic comes from."""


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


@dataclass(frozen=True, eq=False)
class Shot:
    """Truth of a picture of the survey: its pixels -> mosaic.png, the picture, where it was taken from, its depths
    before it was redrawn."""

    place: Similarity
    picture: Picture
    sight: Sight
    depth: NDArray[np.float32]

    def likeness(self, mosaic: Picture, at: Array) -> float:
        """Correlation of the mosaic with this picture about a place, -1..1; -1 where the picture does not show it."""
        size = np.array(self.picture.shape[::-1])
        if ((self.place.inverse(at) < PATCH) | (self.place.inverse(at) > size - 1 - PATCH)).any():
            return -1.0
        side = 2 * PATCH + 1
        from_here = Similarity(1 + 0j, complex(*at) - complex(PATCH, PATCH))
        patches = [cv2.warpAffine(picture, matrix, (side, side), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
                   for picture, matrix in ((mosaic, from_here.matrix), (self.picture,
                                                                        (self.place.inverse @ from_here).matrix))]
        return float(np.corrcoef(patches[0].ravel(), patches[1].ravel())[0, 1])


@dataclass
class PanTiltSite:
    """A pan/tilt over a seafloor, and the mosaic it made."""

    scene: Scene
    camera: Pinhole = field(default_factory=Pinhole)
    world: World = field(init=False, repr=False)
    vehicle: Vehicle = field(init=False, repr=False)
    redrawn: Conformal = field(init=False, repr=False)
    shots: list[Shot] = field(init=False, default_factory=list, repr=False)
    """Truth of the survey."""

    def __post_init__(self) -> None:
        s = self.scene
        floor = Seafloor(extent=6 * s.height, relief=s.relief, texel=s.height / 500, photo=s.photo, seed=s.seed)
        self.world = World(floor, s.water, seed=s.seed)
        self.redrawn = Conformal(self.camera.size, self.camera.focal)
        self.vehicle = Vehicle(position=np.array([0.0, 0.0, -s.height]))

    def look(self, head: PanTilt) -> Picture:
        """What the camera sees now, redrawn."""
        return self.redrawn(self.world.look(self.camera, DOWN.sight(self.vehicle, head)).frame)

    def survey(self, measurer: Make, out: Path, tell: Callable[[str], None] | None = None) -> Chart:
        """Sweep back and forth, build the mosaic in `out`, and remember for the judge what it shows where."""
        shown = Fit(self.redrawn.shown, self.redrawn.shown)
        taken: dict[str, tuple[Picture, Sight, NDArray[np.float32]]] = {}
        with Survey(Registrar.on(measurer, shown, WINDOW, SIGMA), out) as survey:
            for k, head in enumerate(self._sweep()):
                sight = DOWN.sight(self.vehicle, head)
                shot = self.world.look(self.camera, sight)
                frame = self.redrawn(shot.frame)
                taken[str(k)] = frame, sight, shot.depth
                survey.add(Frame(str(k), frame))
                self.world.step(0.5)
                if tell is not None:
                    tell("survey")
            for _ in survey.finish():
                pass
        places = survey.ranked()[0].places
        low = bounds([self.redrawn.shown] * len(places), list(places.values()))[0]
        view = Similarity(1 + 0j, -complex(*low))
        self.shots = [Shot(view @ place, *taken[name]) for name, place in places.items()]
        return Chart.load(out)

    def _sweep(self) -> Iterator[PanTilt]:
        s = self.scene
        pans, tilts = (np.linspace(-a, a, round(2 * a / s.pitch) + 1) for a in s.sweep)
        for i, pan in enumerate(pans):
            for tilt in tilts if i % 2 == 0 else tilts[::-1]:
                yield PanTilt(pan=float(pan), tilt=float(tilt))

    def world_point(self, chart: Chart, target: tuple[float, float]) -> Array:
        """Truth: the world point (3,) a pixel of the mosaic shows: that of the survey's picture it looks most like
        there, for seams may run anywhere."""
        at = np.array(target)
        shot = max(self.shots, key=lambda s: s.likeness(chart.picture, at))
        x, y = self.redrawn.pinhole(shot.place.inverse(at))
        height, width = shot.depth.shape
        z = float(shot.depth[int(np.clip(round(float(y)), 0, height - 1)), int(np.clip(round(float(x)), 0, width - 1))])
        ray = np.array([*((np.array([x, y]) - self.camera.centre) / self.camera.focal), 1.0])
        return np.asarray(shot.sight.position + shot.sight.rotation @ (z * ray), np.float64)

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
        reach_x, reach_y = (n / 3 for n in self.redrawn.shown)
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
        goal = self.world_point(localiser.chart, target)
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
    return float(np.hypot(*site.true_place(site.world_point(chart, place.centre), head)))
