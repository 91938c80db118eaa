# SPDX-License-Identifier: Apache-2.0
"""Fish: textured bodies that swim, turn and stop."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from signum.common.arrays import Floats
from signum.geometry.camera import Sight
from signum.world.camera import Pinhole
from signum.world.seafloor import Float, photograph

TEXELS = 128
"""Side of the texture, pixels."""
SLIM = 0.45
"""Width of a fish seen from the front as a share of its length seen from the side."""


@dataclass
class Fish:
    """A fish: a textured ellipse that swims between random waypoints, turns towards them, and sometimes stops.

    Attributes:
        position: (3,) world metres.
        length: metres from nose to tail; its height is 0.45 times that.
        speed: while swimming, m/s.
        home: (3,) middle of the box it stays in, world metres; roam: (3,) half sides of the box, metres.
        stops: mean number of stops per minute, each of 1 to 4 seconds.
        agility: rate at which it turns into its direction of motion, 1/s.
        seed: of its texture and motion.
    """

    position: Floats
    length: float = 0.5
    speed: float = 0.25
    home: Floats = field(default_factory=lambda: np.zeros(3))
    roam: tuple[float, float, float] = (0.5, 1.0, 0.4)
    stops: float = 3.0
    agility: float = 2.0
    seed: int = 0
    velocity: Floats = field(init=False, default_factory=lambda: np.zeros(3))
    facing: Floats = field(init=False, default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    _resting: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng([self.seed, 3])
        grain = photograph("brick" if self.seed % 2 else "gravel").astype(np.float32)
        crop = cv2.resize(grain[100:260, 100:260], (TEXELS, TEXELS), interpolation=cv2.INTER_AREA)
        self._skin = np.asarray(20 + 0.5 * crop, np.float32)
        v, u = np.mgrid[:TEXELS, :TEXELS] / (TEXELS - 1) * 2 - 1
        self._mask = np.asarray(np.clip((1 - np.hypot(u, v)) * 12, 0, 1), np.float32)
        self._goal = self._waypoint()

    def _waypoint(self) -> Floats:
        return np.asarray(self.home + self._rng.uniform(-1, 1, 3) * self.roam)

    def step(self, dt: float) -> None:
        """Swim for `dt` seconds."""
        if self._resting > 0:
            self._resting -= dt
            wanted = np.zeros(3)
        else:
            if self._rng.random() < self.stops / 60 * dt:
                self._resting = float(self._rng.uniform(1, 4))
            way = self._goal - self.position
            if np.linalg.norm(way) < 0.15:
                self._goal = self._waypoint()
            wanted = self.speed * way / max(float(np.linalg.norm(way)), 1e-6)
        self.velocity = wanted + (self.velocity - wanted) * np.exp(-dt / 0.5)
        self.position = self.position + self.velocity * dt
        speed = float(np.linalg.norm(self.velocity))
        if speed > 0.05:  # a resting fish keeps its direction
            turned = self.facing + (self.velocity / speed - self.facing) * (1 - np.exp(-self.agility * dt))
            self.facing = turned / max(float(np.linalg.norm(turned)), 1e-6)

    def draw(self, albedo: Float, depth: Float, camera: Pinhole, sight: Sight) -> None:
        """Draw the fish into a scene's albedo and depth, in place, where it is nearer than the scene."""
        local = sight.rotation.T @ (self.position - sight.position)
        if local[2] < 0.2:
            return
        scale = camera.focal / local[2]
        width, height = self.length * scale, 0.45 * self.length * scale
        along = sight.rotation.T @ self.facing
        seen = max(float(np.hypot(along[0], along[1])), 1e-6)
        c, s = along[0] / seen, along[1] / seen
        width *= max(seen, SLIM)
        # In an upright picture a fish that swims to the left is mirrored, so that its back stays on the upper side.
        side = -height if abs(sight.rotation[2, 1]) > 0.7 and c < 0 else height
        texel = np.array([[c * width, -s * side], [s * width, c * side]]) / (TEXELS - 1)
        centre = local[:2] * scale + camera.centre
        half = np.abs(texel).sum(axis=1) * (TEXELS - 1) / 2 + 2
        low = np.maximum(np.floor(centre - half), 0).astype(int)
        high = np.minimum(np.ceil(centre + half) + 1, camera.size).astype(int)
        if (high <= low).any():
            return
        matrix = np.hstack([texel, (centre - low - texel @ np.full(2, (TEXELS - 1) / 2))[:, None]])
        box = tuple((high - low).tolist())
        here = np.s_[low[1]:high[1], low[0]:high[0]]
        mask = cv2.warpAffine(self._mask, matrix, box, flags=cv2.INTER_LINEAR)
        skin = cv2.warpAffine(self._skin, matrix, box, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        mask[depth[here] < local[2]] = 0
        albedo[here] += mask * (skin - albedo[here])
        depth[here][mask > 0.5] = np.float32(local[2])
