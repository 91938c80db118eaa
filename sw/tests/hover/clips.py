# SPDX-License-Identifier: Apache-2.0
"""Hover clips with their truth: a camera that looks down at a floor, drifts, turns, rises and sinks, and is disturbed.

Two kinds of floor: one photograph, seen by a similarity, and the simulated world's, with relief. Views are 640x480, 2 m
above the floor in the first frame, and come through figure 8's degradation with the light falling to 35 %.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from signum.common.arrays import Floats, Image
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.geometry.similarity import Similarity
from signum.world.camera import Pinhole
from signum.world.seafloor import PHOTOS, Float, Seafloor
from signum.world.water import Water
from signum.world.world import World

SIZE = (640, 480)
FOCAL = 600.0
RANGE_M = 2.0
RATE = 10.0
YAW_DEG, RANGE_SHARE = 9.0, 0.12
"""Largest turn and change of range of a clip."""
CONTRAST, SNOW, DIMMED = 0.25, 250, 0.35
"""Figure 8: contrast left, snow flakes; and the light that is left in the corners, or at the end of a clip."""
BLIND = (60, 90)
"""Frames in which a disturbed clip shows something else, or its vehicle is away: 3 s."""
PUSH_FRAMES = 12
"""Frames in which a push takes the vehicle away, and in which it returns."""
FLOORS = ("gravel", "grass", "brick", "coins", "moon", "world:gravel", "world:grass", "world:brick")
"""Floors of `make hover`."""
EVENTS = ("drift", "occluded", "pushed", "seabed", "jump")
"""What happens in a clip besides its motion."""


@dataclass(frozen=True)
class Pose:
    """Of the vehicle: metres right and back of the station, radians clockwise, metres of range."""

    right: float
    back: float
    heading: float
    range_m: float

    @property
    def similarity(self) -> Similarity:
        """From pixels of the first view to those of this one, both from the image centre."""
        factor = RANGE_M / self.range_m * np.exp(-1j * self.heading)
        return Similarity(complex(factor), complex(-factor * complex(self.right, self.back) * FOCAL / RANGE_M))

    @property
    def in_sight(self) -> float:
        """Share of the first view that this one shows, 0..1."""
        half = np.array(SIZE) / 2
        frame = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
        seen = self.similarity.inverse(frame)
        area, _ = cv2.intersectConvexConvex(seen.astype(np.float32), frame.astype(np.float32))
        return float(area) / float(np.prod(SIZE))


@dataclass(frozen=True)
class Moment:
    """A frame of a clip, its pose, and whether it shows the floor at all."""

    picture: Image
    pose: Pose
    open: bool


@dataclass(frozen=True)
class Clip:
    """A clip to render.

    Attributes:
        floor: a photograph of scikit-image's wheel, or `world:` and one of the world's.
        event: one of EVENTS.
        seed: of the motion, the snow and the noise.
        frames: their number.
        murky: whether the view is degraded; else it has the sensor's noise only.
        blind: frames in which it shows something else, or its vehicle is away.
    """

    floor: str
    event: str
    seed: int
    frames: int = 150
    murky: bool = True
    blind: tuple[int, int] = BLIND

    @property
    def name(self) -> str:
        """For tables."""
        return f"{self.floor} {self.event} {self.seed}" + ("" if self.murky else " clear")


def path(clip: Clip) -> list[Pose]:
    """The poses: sums of two sines on each axis, at zero in the first frame; the drift is 0.5 m at most, or what a push
    adds."""
    rng = np.random.default_rng([clip.seed, 11])
    t = np.arange(clip.frames) / RATE

    def sway(most: float) -> Floats:
        out = np.zeros(len(t))
        for share, period in ((0.7, rng.uniform(6, 11)), (0.3, rng.uniform(2.5, 4))):
            phase = rng.uniform(0, 2 * np.pi)
            out += share * (np.sin(2 * np.pi * t / period + phase) - np.sin(phase) * np.exp(-t))
        return np.asarray(most * out / max(1.0, float(np.abs(out).max())))

    right, back = sway(0.5), sway(0.4)
    heading, ranged = sway(np.radians(YAW_DEG)), RANGE_M * (1 + sway(RANGE_SHARE))
    begin, end = clip.blind
    if clip.event == "pushed":
        way = rng.uniform(0, 2 * np.pi)
        view = np.array(SIZE) * RANGE_M / FOCAL
        ramp = np.interp(np.arange(clip.frames), [begin - PUSH_FRAMES, begin, end, end + PUSH_FRAMES], [0, 1, 1, 0])
        right, back = right + 1.3 * view[0] * np.cos(way) * ramp, back + 1.3 * view[1] * np.sin(way) * ramp
    if clip.event == "jump":
        for at in range(20, clip.frames, 25):
            right[at:] += rng.choice([-1, 1]) * rng.uniform(0.15, 0.35) * (1 if abs(right[at]) < 0.3 else 0)
            back[at:] += rng.choice([-1, 1]) * rng.uniform(0.1, 0.25) * (1 if abs(back[at]) < 0.3 else 0)
    return [Pose(*map(float, row)) for row in zip(right, back, heading, ranged, strict=True)]


def render(clip: Clip) -> Iterator[Moment]:
    """The clip's frames, in order."""
    look = _world(clip.floor.removeprefix("world:"), clip.seed) if clip.floor.startswith("world:") \
        else _photo(clip.floor, clip.seed)
    others = [name for name in PHOTOS if name not in clip.floor]
    other = _photo(others[clip.seed % len(others)], clip.seed + 1)
    rng = np.random.default_rng([clip.seed, 12])
    begin, end = clip.blind
    for k, pose in enumerate(path(clip)):
        blind = begin <= k < end
        light = look(pose)
        if blind and clip.event == "seabed":
            light = other(pose)
        elif blind and clip.event == "occluded":
            light = np.full(SIZE[::-1], 100, np.float32) + np.linspace(0, 40, SIZE[0], dtype=np.float32)
        yield Moment(spoil(light, rng, _lamp(clip, k)), pose,
                     not (blind and clip.event in ("seabed", "occluded")))


def spoil(light: Float, rng: np.random.Generator, lamp: tuple[float, float] | None) -> Image:
    """Figure 8: contrast, light and snow, then the sensor's noise.

    Args:
        light: (H, W) grey levels.
        lamp: light left in the corners and light left of the whole, 0..1; None for the noise only.
    """
    if lamp is not None:
        light = np.asarray((128 + CONTRAST * (light - 128)) * _cone(lamp[0]) * np.float32(lamp[1]), np.float32)
        for y, x in zip(rng.integers(0, SIZE[1] - 2, SNOW), rng.integers(0, SIZE[0] - 2, SNOW), strict=True):
            light[y:y + 3, x:x + 3] = 255
    noisy = light + rng.standard_normal(light.shape, np.float32)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), np.uint8)


def _lamp(clip: Clip, k: int) -> tuple[float, float] | None:
    """Light left in the corners and of the whole, frame k: to DIMMED in the corners, or over two thirds of the clip of
    the whole, or both, by the seed."""
    if not clip.murky:
        return None
    kind = clip.seed % 3
    fallen = 1 - (1 - DIMMED) * min(1.0, 1.5 * k / clip.frames)
    return 1.0 if kind == 1 else DIMMED, 1.0 if kind == 0 else fallen


@lru_cache(maxsize=2)
def _cone(corner: float) -> Float:
    """The paper's fall-off, to `corner` in the corners."""
    y, x = np.mgrid[:SIZE[1], :SIZE[0]] - (np.array(SIZE[::-1])[:, None, None] - 1) / 2
    beyond = np.clip(np.hypot(x, y) / (np.hypot(*SIZE) / 2) - 0.25, 0, None) / 0.75
    return np.asarray(1 - (1 - corner) * beyond**2, np.float32)


@lru_cache(maxsize=16)
def _wheel(name: str, scale: int) -> Float:
    """A photograph of scikit-image's wheel, enlarged, grey."""
    from skimage import data

    photo = np.asarray(getattr(data, name)())
    if photo.ndim == 3:
        photo = cv2.cvtColor(photo[..., :3], cv2.COLOR_RGB2GRAY)
    factor = scale * 512 / min(photo.shape)
    return np.asarray(cv2.resize(photo.astype(np.float32), None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC),
                      np.float32)


def _photo(name: str, seed: int) -> Callable[[Pose], Float]:
    """A floor that is one photograph, enlarged two, three or four times by the seed, from a random place near its
    middle."""
    photo = _wheel(name, 2 + seed // 3 % 3)
    rng = np.random.default_rng([seed, 13])
    middle = complex(*(np.array(photo.shape[::-1]) / 2 + rng.uniform(-100, 100, 2)))
    turn = np.exp(1j * rng.uniform(0, 2 * np.pi))
    centre = complex(*((np.array(SIZE) - 1) / 2))

    def look(pose: Pose) -> Float:
        onto = Similarity(turn, middle) @ pose.similarity.inverse @ Similarity(1, -centre)
        return np.asarray(cv2.warpAffine(photo, onto.matrix, SIZE, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP,
                                         borderMode=cv2.BORDER_REFLECT_101), np.float32)

    return look


def _world(name: str, seed: int) -> Callable[[Pose], Float]:
    """The simulated world's floor, with relief, seen by a level camera."""
    camera = Pinhole(SIZE, FOCAL)
    world = World(Seafloor(extent=8.0, relief=0.02, texel=0.004, photo=name, seed=seed), Water())
    depth = float(np.median(world.look(camera, _sight(0, 0, 0, RANGE_M)).depth)) - RANGE_M

    def look(pose: Pose) -> Float:
        return world.look(camera, _sight(-pose.back, pose.right, pose.heading, pose.range_m - depth)
                          ).frame.astype(np.float32)

    return look


def _sight(north: float, east: float, heading: float, height: float) -> Sight:
    return Sight(np.array([north, east, -height]), rotation(0.0, 0.0, heading) @ LOOK_DOWN)
