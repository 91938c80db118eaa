# SPDX-License-Identifier: Apache-2.0
"""Simulated surveys: frames on a grid of rows and columns over a seafloor, taken by a vehicle that wobbles, with truth.

Heading and height are held within the accuracy of compass and altimeter: yaw, height, roll, pitch and place differ
from the plan by independent zero-mean amounts from frame to frame, as they do between snapshots taken seconds apart.
Columns run north, the first to the west; row 0 is the southern one. Truth of a frame is where its centre looks.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.geometry.similarity import Similarity
from signum.world.camera import Pinhole
from signum.world.seafloor import Seafloor, photograph, quilt
from signum.world.water import Water
from signum.world.world import World

QUILT_PATCH = 96
"""Side of the patches a floor is quilted from, pixels of the finest texture."""
Cell = tuple[int, int]
"""Row, column."""


@dataclass(frozen=True)
class Plan:
    """What is flown.

    Attributes:
        rows, columns: frames.
        size: width and height, pixels; focal: pixels.
        height: over the mean floor, metres.
        step: from frame to frame, share of the frame's height along a column and of its width across.
        yaw_deg, zoom, tilt_deg, place_m: standard deviations of heading, height (share of it), roll and pitch,
            position.
        lean_deg: roll and pitch of the whole survey, to which those deviations are added.
        relief: standard deviation of the floor's height, metres.
        water: the water.
        photo: which photograph the floor is quilted from.
    """

    rows: int = 10
    columns: int = 10
    size: tuple[int, int] = (256, 192)
    focal: float = 300.0
    height: float = 2.0
    step: tuple[float, float] = (0.5, 0.5)
    yaw_deg: float = 1.0
    zoom: float = 0.01
    tilt_deg: float = 0.3
    place_m: float = 0.02
    lean_deg: tuple[float, float] = (0.0, 0.0)
    relief: float = 0.02
    water: Water = field(default_factory=lambda: Water(noise=2.0))
    photo: str = "gravel"

    @property
    def pixel_m(self) -> float:
        """Metres a pixel covers from the planned height."""
        return self.height / self.focal

    @property
    def stride(self) -> tuple[float, float]:
        """From a frame to the next one along a column and across, pixels."""
        return self.step[0] * self.size[1], self.step[1] * self.size[0]

    def planned(self, a: Cell, b: Cell) -> Similarity:
        """Pixels of a's frame -> pixels of b's, if the plan were kept."""
        along, across = self.stride
        # A frame further north sees the same things lower down.
        return Similarity.of(shift=((a[1] - b[1]) * across, (b[0] - a[0]) * along))


@dataclass(frozen=True, eq=False)
class Flown:
    """A simulated survey.

    Attributes:
        plan: what was to be flown.
        frames: pictures by cell.
        truth: by cell, what takes the frame's pixels near its centre to metres east and south (y down) of the origin.
    """

    plan: Plan
    frames: dict[Cell, Image]
    truth: dict[Cell, Similarity]

    def position(self, cell: Cell) -> complex:
        """Where a frame's centre looks, pixels of the planned height, x east and y south."""
        at = self.truth[cell]
        middle = complex(*((n - 1) / 2 for n in self.plan.size))
        return (at.factor * middle + at.shift) / self.plan.pixel_m

    def sequence(self) -> list[Cell]:
        """The cells back and forth, as they are flown."""
        return back_and_forth(self.plan.rows, self.plan.columns)


def back_and_forth(rows: int, columns: int) -> list[Cell]:
    """Up the first column, down the second, and so on."""
    return [(r if c % 2 == 0 else rows - 1 - r, c) for c in range(columns) for r in range(rows)]


def seafloor(extent: float, relief: float, texel: float, seed: int, feature: float = 0.8,
             photo: str = "gravel") -> Seafloor:
    """A floor on which no recurring texture is large enough to be mistaken for another place.

    The photograph is small for a whole survey, so its patches recur, but they are smaller than the span of a frame's
    windows, and turned and mirrored.
    """
    floor = Seafloor(extent=extent, relief=relief, feature=feature, texel=texel, photo=photo, seed=seed)
    rng = np.random.default_rng([seed, 9])
    floor.levels[:1] = [quilt(photograph(floor.photo), floor.levels[0].shape[0], rng, QUILT_PATCH)]
    for k in range(1, len(floor.levels)):
        floor.levels[k] = np.asarray(cv2.pyrDown(floor.levels[k - 1]), np.float32)
    return floor


def simulate_survey(plan: Plan, seed: int) -> Flown:
    """Take the frames of a survey."""
    rng = np.random.default_rng([seed, 7])
    along, across = (s * plan.pixel_m for s in plan.stride)
    extent = max(plan.rows * along, plan.columns * across) + 1.5 * max(plan.size) * plan.pixel_m
    floor = seafloor(extent, plan.relief, 0.8 * plan.pixel_m, seed, photo=plan.photo)
    world = World(floor, plan.water, seed=seed)
    camera = Pinhole(plan.size, plan.focal)
    frames, truth = {}, {}
    for row, column in back_and_forth(plan.rows, plan.columns):
        north = (row - (plan.rows - 1) / 2) * along + rng.normal(0, plan.place_m)
        east = (column - (plan.columns - 1) / 2) * across + rng.normal(0, plan.place_m)
        height = plan.height * (1 + rng.normal(0, plan.zoom))
        roll, pitch = np.radians(rng.normal(0, plan.tilt_deg, 2) + plan.lean_deg)
        yaw = np.radians(rng.normal(0, plan.yaw_deg))
        sight = Sight(np.array([north, east, -height]), rotation(roll, pitch, yaw) @ LOOK_DOWN)
        frames[row, column] = world.look(camera, sight).frame
        truth[row, column] = ground_view(camera, sight)
    return Flown(plan, frames, truth)


def ground_view(camera: Pinhole, sight: Sight) -> Similarity:
    """Pixels about a camera's centre -> metres east and south of the origin on the mean floor: the nearest similarity
    to what it sees."""
    centre = np.array(camera.centre)
    pixels = centre + np.array([[0.0, 0.0], [20.0, 0.0], [0.0, 20.0], [-20.0, 0.0], [0.0, -20.0]])
    rays = np.column_stack([(pixels - centre) / camera.focal, np.ones(len(pixels))]) @ sight.rotation.T
    ground = sight.position + rays * (-sight.position[2] / rays[:, 2])[:, None]
    world = ground[:, 1] - 1j * ground[:, 0]
    around = (pixels - centre) @ np.array([1, 1j])
    factor = complex((np.conj(around) @ (world - world[0])) / (np.abs(around) ** 2).sum())
    return Similarity(factor, complex(world[0]) - factor * complex(*centre))


def orthographic(floor: Seafloor, north: float, east: float, size: tuple[int, int], pixel_m: float,
                 noise: float, rng: np.random.Generator) -> Image:
    """What a camera with parallel rays sees straight down: uint8 (height, width), image up is north."""
    u, v = np.meshgrid(np.arange(size[0]) - (size[0] - 1) / 2, np.arange(size[1]) - (size[1] - 1) / 2)
    x = np.asarray(north - v * pixel_m, np.float32)
    y = np.asarray(east + u * pixel_m, np.float32)
    seen: Floats = floor.albedo(x, y, pixel_m) + rng.normal(0, noise, x.shape)
    return np.asarray(np.clip(np.rint(seen), 0, 255), np.uint8)
