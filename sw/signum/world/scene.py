"""A simulated underwater camera: a real photograph as the seabed, a vehicle that lags behind its commands, a current
that pushes it.

Axes: the ground plane is the photograph's, X to its right and Y down its rows, metres, origin at its centre. At
    heading 0 the
vehicle's forward is -Y (up in the image) and its right is +X; heading turns clockwise as seen in the image. The
camera looks straight down from `altitude` metres with a focal length in pixels, so an image pixel covers altitude /
focal metres. Everything is deterministic for a seed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image


def gravel(scale: float = 2.0) -> Image:
    """scikit-image's bundled photograph of gravel (512x512, comes with the package), enlarged; uint8 (512*scale,)*2."""
    from skimage import data

    load: Callable[[], Image] = data.gravel
    photo = load()
    return np.asarray(cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC), np.uint8)


@dataclass(frozen=True)
class Pose:
    """Where the camera is: metres on the ground plane, altitude in metres, heading in radians."""

    x: float = 0.0
    y: float = 0.0
    altitude: float = 2.0
    heading: float = 0.0


@dataclass
class Camera:
    """A pinhole camera over a photograph.

    Attributes:
        photo: uint8 (H, W) seabed.
        size: width and height of its frames, pixels.
        focal: focal length, pixels.
        ground_pixel: metres of seabed per pixel of the photograph; the default shows it 1:1 from 2 m.
        noise: standard deviation of the sensor noise, grey levels.
        seed: of the noise.
    """

    photo: Image
    size: tuple[int, int] = (384, 288)
    focal: float = 400.0
    ground_pixel: float = 0.005
    noise: float = 2.0
    seed: int = 0
    _rng: np.random.Generator = field(init=False, repr=False)
    _bed: NDArray[np.float32] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._bed = self.photo.astype(np.float32)

    def matrix(self, pose: Pose) -> Floats:
        """2x3 matrix from pixels of the frame to pixels of the photograph."""
        scale = pose.altitude / self.focal / self.ground_pixel
        c, s = scale * math.cos(pose.heading), scale * math.sin(pose.heading)
        turn = np.array([[c, -s], [s, c]])
        centre = (np.array(self.size) - 1) / 2
        ground = (np.array(self.photo.shape[::-1]) - 1) / 2 + np.array([pose.x, pose.y]) / self.ground_pixel
        return np.hstack([turn, (ground - turn @ centre)[:, None]])

    def look(self, pose: Pose) -> Image:
        """The frame seen from `pose`: uint8 (height, width). Beyond the photograph's edge its mirror image is seen."""
        flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
        view = np.asarray(cv2.warpAffine(self._bed, self.matrix(pose), self.size, flags=flags,
                                         borderMode=cv2.BORDER_REFLECT_101))
        view = view + self._rng.normal(0.0, self.noise, view.shape)
        return np.asarray(np.clip(np.rint(view), 0, 255), np.uint8)


@dataclass
class Current:
    """Water that pushes the vehicle: a steady part, a surge of a given period, and gusts (filtered noise), m/s."""

    steady: tuple[float, float] = (0.10, -0.05)
    surge: float = 0.08
    period: float = 8.0
    gusts: float = 0.03
    seed: int = 0
    _rng: np.random.Generator = field(init=False, repr=False)
    _gust: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._gust = np.zeros(2)

    def velocity(self, time: float, dt: float) -> Floats:
        """Velocity of the water at `time` seconds, m/s, (2,); `dt` seconds since the call before."""
        fade = math.exp(-dt / 1.5)
        self._gust = fade * self._gust + math.sqrt(1 - fade * fade) * self._rng.normal(0.0, self.gusts, 2)
        wave = self.surge * math.sin(2 * math.pi * time / self.period)
        return np.array([self.steady[0] + wave, self.steady[1] + 0.5 * wave]) + self._gust


STILL = Current(steady=(0.0, 0.0), surge=0.0, gusts=0.0)
"""Still water."""


@dataclass
class Vehicle:
    """A vehicle whose velocity through the water follows its command with a first-order lag; the water carries it
    along.

    Attributes:
        pose: where it is.
        lag: time constant of thrusters and hull, seconds.
        limit: fastest it goes through the water, m/s and axis.
        current: the water.
    """

    pose: Pose = field(default_factory=Pose)
    lag: float = 0.4
    limit: float = 0.5
    current: Current = field(default_factory=lambda: replace(STILL))
    time: float = 0.0
    _through: Floats = field(default_factory=lambda: np.zeros(2), repr=False)

    def step(self, forward: float, right: float, dt: float) -> Pose:
        """Move for `dt` seconds under a velocity command, m/s; returns the new pose."""
        command = np.clip([forward, right], -self.limit, self.limit)
        self._through = command + (self._through - command) * math.exp(-dt / self.lag)
        c, s = math.cos(self.pose.heading), math.sin(self.pose.heading)
        ahead, side = np.array([s, -c]), np.array([c, s])
        velocity = ahead * self._through[0] + side * self._through[1] + self.current.velocity(self.time, dt)
        self.time += dt
        self.pose = replace(self.pose, x=self.pose.x + float(velocity[0]) * dt, y=self.pose.y + float(velocity[1]) * dt)
        return self.pose
