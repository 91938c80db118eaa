# SPDX-License-Identifier: Apache-2.0
"""Figure 13's argument measured: offsets over relief through perspective and through parallel rays.

The same ground is seen, with the same pixels on it, from several heights, each with the lens that fits; the higher,
the nearer to orthographic. Two frames half a footprint apart are registered as in any mosaic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from signum.applications.mosaic.simulate import orthographic, seafloor
from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.geometry.similarity import Similarity
from signum.measure.register import Registrar
from signum.world.camera import Pinhole
from signum.world.water import Water
from signum.world.world import World

SIZE = 256, 192
FOOTPRINT = 1.6
"""Metres of seabed a frame is wide."""
RELIEF, FEATURE = 0.10, 0.35
"""Standard deviation and length scale of the floor's height, metres."""
HEIGHTS = 0.8, 1.2, 2.0, 4.0, 8.0
"""Metres; the first is a lens of 90 degrees."""
STEP = 0.5
NOISE = 2.0
REACH = 40


@dataclass(frozen=True, eq=False)
class Projection:
    """The measurements under one projection.

    Attributes:
        label: the projection in words.
        angle_deg: of view, across; 0 for parallel rays.
        accepted: share of the pairs whose registration was accepted.
        agreed: share of the windows that agree, mean over pairs.
        spread_px: root-mean-square distance of agreeing windows from the similarity, mean over pairs.
        error_px: (n,) distance between measured and true offset of the accepted pairs.
        pair: the first pair's frames.
        found: what was found between them.
    """

    label: str
    angle_deg: float
    accepted: float
    agreed: float
    spread_px: float
    error_px: Floats
    pair: tuple[Image, Image]
    found: Similarity

    @property
    def rms_px(self) -> float:
        """Root mean square of the errors, pixels; NaN without an accepted pair."""
        return float(np.sqrt(np.mean(self.error_px**2))) if len(self.error_px) else float("nan")


def compare_projections(registrar: Registrar, seed: int, pairs: int,
                        tell: Callable[[str], None] = lambda _: None) -> list[Projection]:
    """Register pairs of frames through each projection, the last with parallel rays."""
    floor = seafloor(10.0, RELIEF, 0.8 * FOOTPRINT / SIZE[0], seed, FEATURE)
    rng = np.random.default_rng([seed, 8])
    spots = rng.uniform(-3, 3, (pairs, 2))
    pixel = FOOTPRINT / SIZE[0]
    ahead = STEP * SIZE[1]
    out = []
    for height in (*HEIGHTS, None):
        world = World(floor, Water(noise=NOISE), seed=seed)
        camera = None if height is None else Pinhole(SIZE, height / pixel)

        def look(north: float, east: float, camera: Pinhole | None = camera, height: float | None = height,
                 world: World = world) -> Image:
            if camera is None or height is None:
                return orthographic(floor, north, east, SIZE, pixel, NOISE, rng)
            sight = Sight(np.array([north, east, -height]), rotation(0, 0, 0) @ LOOK_DOWN)
            return world.look(camera, sight).frame

        taken = [(look(x, y), look(x + ahead * pixel, y)) for x, y in spots]
        results = [registrar.register(registrar.prepare(a), registrar.prepare(b), Similarity.of(shift=(0.0, ahead)),
                                      REACH) for a, b in taken]
        good = [r for r in results if r.accepted]
        label = "parallel rays" if height is None else f"from {height:g} m"
        angle = 0.0 if height is None else float(np.degrees(2 * np.arctan(FOOTPRINT / 2 / height)))
        out.append(Projection(label, angle, len(good) / len(results),
                        float(np.mean([r.agreed / max(r.tried, 1) for r in results])),
                        float(np.mean([r.rms_px for r in results])),
                        np.array([np.hypot(r.shift[0], r.shift[1] - ahead) for r in good]), taken[0],
                        results[0].similarity))
        tell(label)
    return out
