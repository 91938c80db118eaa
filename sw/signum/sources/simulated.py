# SPDX-License-Identifier: Apache-2.0
"""The simulated world as a source: a survey flown back and forth over a seafloor, seen by a camera looking down."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields

import numpy as np

from signum.common.checks import within
from signum.common.errors import SourceError
from signum.frames.frame import Frame, Source
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.world.camera import Pinhole
from signum.world.seafloor import PHOTOS, Seafloor
from signum.world.water import WATERS
from signum.world.world import World

RANGES: dict[str, tuple[float, float]] = {
    "frames": (1, 1_000_000), "rate": (0.01, 1000.0), "speed": (0.001, 10.0), "columns": (0.01, 100.0),
    "spacing": (0.01, 100.0), "height": (0.2, 20.0), "relief": (0.0, 2.0), "seed": (0, 2**31 - 1)}
"""Smallest and largest value of what a source's name may set."""
MOST_TEXELS = 100e6
"""Largest size of the simulated floor, texels."""


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
        self.rate = survey.rate

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
        for name, (low, high) in RANGES.items():
            within(getattr(survey, name), f"{text}: {name}", low, high, SourceError)
        return cls(survey, text)

    def _frames(self) -> Iterator[Frame]:
        s = self.survey
        flown = [s.place(k / s.rate) for k in range(s.frames)]
        middle = (np.min(flown, axis=0) + np.max(flown, axis=0)) / 2
        extent = float(np.ptp(np.array(flown), axis=0).max()) + 1.5 * s.height + 1.0
        camera = Pinhole()
        texel = 0.8 * s.height / camera.focal
        if (extent / texel) ** 2 > MOST_TEXELS:
            raise SourceError(f"{self.label}: a floor of {extent:.0f} m seen from {s.height:g} m; expected a shorter "
                              "or higher survey")
        floor = Seafloor(extent=extent, relief=s.relief, texel=texel, photo=s.photo, seed=s.seed)
        world = World(floor, WATERS[s.water], seed=s.seed)
        for k, (north, east) in enumerate(flown):
            position = np.array([north - middle[0], east - middle[1], -s.height])
            swell = 0.01 * np.sin(0.9 * k / s.rate), 0.01 * np.cos(0.7 * k / s.rate), 0.02 * np.sin(0.3 * k / s.rate)
            yield Frame(str(k), world.look(camera, Sight(position, rotation(*swell) @ LOOK_DOWN)).frame, k / s.rate)
            world.step(1 / s.rate)
