# SPDX-License-Identifier: Apache-2.0
"""Renders the finished picture of a camera in the world: seafloor, fish, water, snow and sensor noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from signum.common.arrays import Image
from signum.geometry.camera import Sight
from signum.world.camera import Pinhole, see_floor
from signum.world.fish import Fish
from signum.world.seafloor import Float, Seafloor
from signum.world.vehicle import STILL, Current
from signum.world.water import CLEAR, Snow, Water, expose, sense


@dataclass(frozen=True, eq=False)
class Shot:
    """A frame and its true depths.

    Attributes:
        frame: uint8 (height, width).
        depth: float32 (height, width), metres along the optical axis, infinite for open water.
    """

    frame: Image
    depth: Float


@dataclass
class World:
    """Seafloor, water and fish.

    Attributes:
        floor: None in midwater.
        water, fish, current: of the sea.
        occluder: draws further objects in front of the camera into (image, time), in place.
        seed: of snow and noise.
        time: seconds.
    """

    floor: Seafloor | None
    water: Water = CLEAR
    fish: list[Fish] = field(default_factory=list)
    current: Current = STILL
    occluder: Callable[[Float, float], None] | None = None
    seed: int = 0
    time: float = 0.0

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng([self.seed, 4])
        self._snow = Snow(self.water.snow, self.seed)

    def step(self, dt: float) -> None:
        """Move fish and snow for `dt` seconds."""
        for fish in self.fish:
            fish.step(dt)
        if self.water.snow:
            self._snow.drift(self.current.at(self.time), dt)
        self.time += dt

    def look(self, camera: Pinhole, sight: Sight) -> Shot:
        """The present picture of `camera` from `sight`."""
        if self.floor is None:
            shape = camera.size[::-1]
            albedo, depth = np.zeros(shape, np.float32), np.full(shape, np.inf, np.float32)
        else:
            albedo, depth = see_floor(camera, sight, self.floor)
        for fish in self.fish:
            fish.draw(albedo, depth, camera, sight)
        light = expose(albedo, depth, camera, self.water)
        if self.water.snow:
            self._snow.draw(light, camera, sight, depth)
        if self.occluder is not None:
            self.occluder(light, self.time)
        return Shot(sense(light, self.water.noise, self._rng), depth)

    def look_pair(self, camera: Pinhole, sight: Sight, baseline: float) -> tuple[Shot, Shot]:
        """The pictures of a rectified stereo pair: the left camera at `sight`, the right one `baseline` metres to its
        right."""
        return self.look(camera, sight), self.look(camera, sight.shifted(baseline))
