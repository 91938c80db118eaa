# SPDX-License-Identifier: Apache-2.0
"""A single-column mosaic flown in the simulated world: the paper's `make_single_column_mosaic()` in automatic mode.

    store an image; then, again and again: find the section at its top centre in the live image, and move the vehicle by
    the section's offset from the bottom centre; once the section has arrived there, store the live image.

The stored images go to a `Survey`, which registers them and writes the mosaic. In manual mode, where an operator or a
recording moves the camera, the same `Survey` takes the frames without this loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from signum.applications.mosaic.survey import Survey
from signum.applications.pid import Gains, Pid
from signum.common.arrays import Floats, Image
from signum.frames.frame import Frame
from signum.geometry.camera import Sight
from signum.geometry.similarity import IDENTITY
from signum.world.camera import Pinhole
from signum.world.vehicle import DOWN, Vehicle
from signum.world.world import World

NEAR_M = 0.15
"""Distance from the goal within which the controllers integrate: the thrust for the way there is not the current's."""
TRAVEL = Gains(30.0, 10.0, 35.0, 30.0, 300.0)
"""Gains of surge and sway: second-order loops of some 1.2 rad/s for a hull of 20 kg."""
HEAVE, YAW = Gains(40.0, 8.0, 50.0, 30.0, 200.0), Gains(5.0, 1.0, 0.5, 4.0, 40.0)
"""Gains of depth and heading, which are held tighter."""
LEVEL_RAD, COMPASS_RAD, GAUGE_M = 0.001, 0.01, 0.005
"""Standard deviations of the vehicle's own roll and pitch, heading and depth."""


@dataclass(frozen=True, eq=False)
class ColumnFrame:
    """One live frame of a column.

    Attributes:
        time: seconds.
        picture: the frame.
        sight: the camera's true position and attitude when it was taken.
        section: where the section is in the frame, pixels; NaN where it was not found.
        error: its distance from the bottom centre (right, down), pixels; NaN where it was not found.
        stored: frames stored so far, this one included if it was stored.
        valid: whether the section was found.
    """

    time: float
    picture: Image
    sight: Sight
    section: tuple[float, float]
    error: tuple[float, float]
    stored: int
    valid: bool


def fly_column(world: World, vehicle: Vehicle, camera: Pinhole, survey: Survey, images: int, section: int = 64,
               dt: float = 0.2, epsilon: float = 4.0, seconds: float = 120.0) -> Iterator[ColumnFrame]:
    """Fly forward until `images` frames are stored, or the time is up.

    The section at the top centre of the stored frame is found in each live frame, and its offset from the bottom
    centre is servoed to zero; within `epsilon` pixels of it the live frame is stored. The first live frame is stored
    as it is. The vehicle holds heading and depth by its own compass and pressure gauge.

    Args:
        world: with a floor; stepped here.
        vehicle: at its start over the floor, with the world's current; stepped here. Its camera looks straight down,
            image up is forward.
        camera: of the frames the survey's registrar is for.
        survey: takes the stored frames, named "0", "1", ...; for snapshots. `Settings(loops=False)` leaves it a chain.
        images: to store, the first included.
        section: side of the section, pixels.
        dt: seconds between live frames.
        epsilon: pixels.
        seconds: at most.
    """
    registrar = survey.registrar
    width, height = camera.size
    border = section / 2 + 8
    top, bottom = np.array([(width - 1) / 2, border]), np.array([(width - 1) / 2, height - 1 - border])
    pilot = _Pilot(vehicle, camera.focal, world.seed)
    began, stored = vehicle.time, 0
    seen = before = IDENTITY
    while vehicle.time - began < seconds:
        time, sight = vehicle.time, DOWN.sight(vehicle)
        picture = world.look(camera, sight).frame
        live = registrar.prepare(picture)
        if stored == 0:
            reference = live
        predicted = seen @ before.inverse @ seen
        result = registrar.register(reference, live, predicted, survey.settings.reach)
        if not result.accepted:
            result = registrar.register(reference, live)
        at = error = np.full(2, np.nan)
        if result.accepted:
            before, seen = seen, result.similarity
            at = seen(top)
            error = at - bottom
        if stored == 0 or (result.accepted and float(np.hypot(*error)) < epsilon):
            survey.add(Frame(str(stored), picture))
            stored += 1
            reference, seen, before = live, IDENTITY, IDENTITY
            force = pilot.step(top - bottom, dt, anew=True)
        else:
            force = pilot.step(error if result.accepted else None, dt)
        yield ColumnFrame(time, picture, sight, (float(at[0]), float(at[1])), (float(error[0]), float(error[1])),
                          stored, result.accepted)
        if stored >= images:
            return
        vehicle.step(force, dt)
        world.step(dt)


class _Pilot:
    """Turns the section's error into forces; keeps the heading and depth the vehicle has at the start.

    Args:
        vehicle: whose roll and pitch, compass and pressure gauge are read; over a floor at depth 0.
        focal: focal length, pixels.
        seed: of the sensors' noise.
    """

    def __init__(self, vehicle: Vehicle, focal: float, seed: int) -> None:
        self._vehicle, self._focal = vehicle, focal
        self._heading, self._depth = float(vehicle.attitude[2]), float(vehicle.position[2])
        self._loops = Pid(TRAVEL), Pid(TRAVEL), Pid(HEAVE), Pid(YAW)
        self._rng = np.random.default_rng([seed, 10])
        self._last: Floats | None = None

    def step(self, error: Floats | None, dt: float, anew: bool = False) -> Floats:
        """Forces (6,) N and N m in body axes.

        Args:
            error: of the section (right, down), pixels; None where it was not found.
            dt: seconds since the call before.
            anew: whether the error is to a new reference, so that its change does not measure the motion.
        """
        surge, sway, heave, yaw = self._loops
        tilt = self._vehicle.attitude[:2] + self._rng.normal(0, LEVEL_RAD, 2)
        heading = float(self._vehicle.attitude[2] + self._rng.normal(0, COMPASS_RAD)) - self._heading
        depth = float(self._vehicle.position[2] + self._rng.normal(0, GAUGE_M)) - self._depth
        vertical, turning = heave.step(-depth, dt), yaw.step(-heading, dt, -float(self._vehicle.velocity[5]))
        if error is None:
            self._last = None
            return np.array([surge.hold(), sway.hold(), vertical, 0.0, 0.0, turning])
        # Roll moves the picture to the right and pitch moves it down; neither is a displacement of the vehicle.
        right, down = (error - self._focal * tilt) * -self._depth / self._focal
        off = np.array([-down, right])  # a section above the bottom centre is ahead
        rate = np.zeros(2) if anew or self._last is None else (off - self._last) / dt
        self._last = off
        near = float(np.hypot(*off)) <= NEAR_M
        ahead, aside = (loop.step(float(e), dt, float(r), near)
                        for loop, e, r in zip((surge, sway), off, rate, strict=True))
        return np.array([ahead, aside, vertical, 0.0, 0.0, turning])
