"""The simulated world as a source: a survey flown back and forth over a seafloor, seen by a camera looking down."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields

import numpy as np

from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.world.camera import Pinhole
from signum.world.seafloor import PHOTOS, Seafloor
from signum.world.water import WATERS
from signum.world.world import World


@dataclass(frozen=True)
class SurveyPlan:
    """The survey to fly; each attribute can be set in a source's name, `world:frames=200,water=paper`.

    Attributes:
        frames: number of frames.
        rate: frames a second.
        speed: along the path, m/s.
        columns: length of the columns, metres.
        spacing: distance between columns, metres.
        height: of the camera over the mean floor, metres.
        relief: standard deviation of the floor's height, metres.
        water: one of WATERS.
        photo: the photograph that covers the floor, one of PHOTOS.
        seed: of floor, water and noise.
    """

    frames: int = 100
    rate: float = 5.0
    speed: float = 0.3
    columns: float = 4.0
    spacing: float = 0.8
    height: float = 2.0
    relief: float = 0.05
    water: str = "coastal"
    photo: str = "gravel"
    seed: int = 0

    def place(self, time: float) -> tuple[float, float]:
        """North and east, metres, from the first corner, at `time` seconds; between columns the path leads sideways."""
        turn = self.columns + self.spacing
        column, along = divmod(self.speed * time, turn)
        north, east = min(along, self.columns), column * self.spacing + max(along - self.columns, 0.0)
        return (north if column % 2 == 0 else self.columns - north), east


class WorldSource(Source):
    """Frames of a `SurveyPlan`, grey, 384x288."""

    def __init__(self, survey: SurveyPlan, label: str = "world") -> None:
        super().__init__(label, survey.frames)
        self.survey = survey

    @classmethod
    def named(cls, text: str) -> WorldSource:
        """From `world` or `world:name=value,...`.

        Raises:
            SourceError: for an unknown name or value.
        """
        kinds: dict[str, Callable[[str], object]] = {
            f.name: type(getattr(SurveyPlan, f.name)) for f in fields(SurveyPlan)}
        values: dict[str, object] = {}
        for part in filter(None, text.partition(":")[2].split(",")):
            name, _, value = part.partition("=")
            try:
                values[name] = kinds[name](value)
            except (KeyError, ValueError) as error:
                raise SourceError(f"{text}: {part!r} is none of " + ", ".join(
                    f"{n}={f.default}" for n, f in zip(kinds, fields(SurveyPlan), strict=True))) from error
        survey = SurveyPlan(**values)  # type: ignore[arg-type]
        if survey.water not in WATERS or survey.photo not in PHOTOS:
            raise SourceError(f"{text}: water is one of {', '.join(WATERS)}, photo one of {', '.join(PHOTOS)}")
        if survey.frames < 1 or min(survey.rate, survey.speed, survey.columns, survey.spacing, survey.height) <= 0:
            raise SourceError(f"{text}: frames, rate, speed, columns, spacing and height must be above 0")
        return cls(survey, text)

    def _frames(self) -> Iterator[Frame]:
        s = self.survey
        flown = [s.place(k / s.rate) for k in range(s.frames)]
        middle = (np.min(flown, axis=0) + np.max(flown, axis=0)) / 2
        extent = float(np.ptp(np.array(flown), axis=0).max()) + 1.5 * s.height + 1.0
        camera = Pinhole()
        floor = Seafloor(extent=extent, relief=s.relief, texel=0.8 * s.height / camera.focal, photo=s.photo,
                         seed=s.seed)
        world = World(floor, WATERS[s.water], seed=s.seed)
        for k, (north, east) in enumerate(flown):
            position = np.array([north - middle[0], east - middle[1], -s.height])
            swell = 0.01 * np.sin(0.9 * k / s.rate), 0.01 * np.cos(0.7 * k / s.rate), 0.02 * np.sin(0.3 * k / s.rate)
            yield Frame(str(k), world.look(camera, Sight(position, rotation(*swell) @ LOOK_DOWN)).frame)
            world.step(1 / s.rate)
