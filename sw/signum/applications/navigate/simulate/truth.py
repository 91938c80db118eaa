# SPDX-License-Identifier: Apache-2.0
"""What a simulated mosaic truly shows: it judges navigation and takes no part in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.applications.mosaic.blend import bounds
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.survey import Survey
from signum.applications.navigate.chart import Chart
from signum.common.arrays import Floats, Image
from signum.frames.fit import Fit
from signum.frames.frame import Frame
from signum.geometry.camera import Sight
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.world.camera import Pinhole

Make = Callable[[tuple[int, int], float], Measurer]
"""Makes a measurer for a picture size (width, height) and a sigma."""
SURVEY_SIGMA = 2.0
"""Sigma of the LoG in a simulated survey, pixels."""
SURVEY_WINDOW = 64
"""Side of the windows in a simulated survey, pixels."""
LIKENESS_HALF = 12
"""Half side of the patch by which the picture a pixel of the mosaic comes from is recognised, pixels."""


@dataclass(frozen=True, eq=False)
class Taken:
    """A picture of a simulated survey, the camera's pose, and the pinhole camera's depths (height, width), metres."""

    picture: Image
    sight: Sight
    depth: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Truth:
    """A simulated survey's pictures and their places in the mosaic.

    Attributes:
        camera: the pictures' camera.
        pinhole: pixels of the pictures -> pixels of the camera, where they were redrawn.
        shots: each picture with its pixels -> mosaic.png.
    """

    camera: Pinhole
    pinhole: Callable[[Floats], Floats]
    shots: list[tuple[Similarity, Taken]] = field(default_factory=list)

    def world_point(self, chart: Chart, target: tuple[float, float]) -> Floats:
        """The world point (3,) a pixel of the mosaic shows, by the picture most similar to the mosaic around it: the
        positions of seams are not known."""
        at = np.array(target)
        place, shot = max(self.shots, key=lambda s: _likeness(chart.picture, at, *s))
        x, y = self.pinhole(place.inverse(at))
        height, width = shot.depth.shape
        z = shot.depth[int(np.clip(round(float(y)), 0, height - 1)), int(np.clip(round(float(x)), 0, width - 1))]
        return np.asarray(self.camera.unproject(shot.sight, np.array([x, y]), np.array([z]))[0], np.float64)


def build_chart(measurer: Make, taken: Iterable[Taken], truth: Truth, out: Path,
                tell: Callable[[str], None] | None = None, settings: SurveySettings | None = None) -> Chart:
    """Build the mosaic of a simulated survey in `out`, as `signum mosaic` does, and set the truth's shots.

    Raises:
        ValueError: without pictures.
    """
    shots: dict[str, Taken] = {}
    made: Survey | None = None
    for k, shot in enumerate(taken):
        size = shot.picture.shape[1], shot.picture.shape[0]
        made = made or Survey(Registrar.on(measurer, Fit(size, size), SURVEY_WINDOW, SURVEY_SIGMA), out,
                              settings=settings)
        shots[str(k)] = shot
        made.add(Frame(str(k), shot.picture))
        if tell is not None:
            tell("survey")
    if made is None:
        raise ValueError("a survey needs pictures")
    for _ in made.finish():
        pass
    made.close()
    places = made.ranked()[0].places
    low = bounds([size] * len(places), list(places.values()))[0]
    view = Similarity(1 + 0j, -complex(*low))
    truth.shots[:] = [(view @ place, shots[name]) for name, place in places.items()]
    return Chart.load(out)


def random_target(chart: Chart, size: tuple[int, int], rng: np.random.Generator) -> tuple[float, float]:
    """A random place of the mosaic, at least a third of the frame's `size` from its border."""
    reach_x, reach_y = (n / 3 for n in size)
    while True:
        x, y = (float(rng.uniform(r, n - r)) for r, n in zip((reach_x, reach_y), chart.size, strict=True))
        if all(chart.covers(x + i * reach_x, y + j * reach_y) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            return x, y


def _likeness(mosaic: Image, at: Floats, place: Similarity, shot: Taken) -> float:
    """Correlation of the mosaic with a picture around a place, -1..1; -1 where the picture does not show it."""
    here = place.inverse(at)
    if ((here < LIKENESS_HALF) | (here > np.array(shot.picture.shape[::-1]) - 1 - LIKENESS_HALF)).any():
        return -1.0
    side = 2 * LIKENESS_HALF + 1
    corner = Similarity(1 + 0j, complex(*at) - complex(LIKENESS_HALF, LIKENESS_HALF))
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    patches = [cv2.warpAffine(picture, way.matrix, (side, side), flags=flags)
               for picture, way in ((mosaic, corner), (shot.picture, place.inverse @ corner))]
    return float(np.corrcoef(patches[0].ravel(), patches[1].ravel())[0, 1])
