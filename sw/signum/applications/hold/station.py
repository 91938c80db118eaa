"""Translation station keeping: stay over one place by what the camera sees, the paper's equations 2 to 5.

The initial picture stays on the board as the reference, so nothing drifts. With t the image offset of the scene since
then, as an angle (right and down in the image), R the distance from the camera to the feature, and forward up in it:

    x = R sin(t down)       the vehicle is x ahead of its station: what it saw has moved down     (eqs 2, 4)
    y = -R sin(t right)     the vehicle is y to the right of it: what it saw has moved left       (eqs 3, 5)

t is that of the feature which was at the image's centre, by least squares over all windows that are found and agree. At
a height h above the bottom that feature's distance is R = h / cos t, so that R sin t = h tan t.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from signum.applications.pid import Gains, Pid
from signum.common.arrays import Image
from signum.geometry.similarity import IDENTITY, Similarity, fit, vote
from signum.measure.measurer import Measurer, Query, View
from signum.measure.predict import SearchPredictor
from signum.world.scene import Camera, Pose, Vehicle


@dataclass(frozen=True)
class Fix:
    """Where the vehicle is, seen from its station.

    Attributes:
        x, y: metres ahead and to the right.
        rot_deg, zoom: of the picture since then.
        offset_px: (right, down) offset of the scene at the image's centre, pixels.
        agreed, tried: windows.
        confidence: 0..1; 0 where the measurement must not be used.
    """

    x: float
    y: float
    rot_deg: float
    zoom: float
    offset_px: tuple[float, float]
    agreed: int
    tried: int
    confidence: float


class Station:
    """Measures the vehicle's position against the picture it had at the station.

    Args:
        measurer: for the camera's frames.
        frame: the picture at the station, uint8 (height, width).
        focal: focal length, pixels of that picture.
        height: of the camera above the seabed, metres.
        window: side of the windows, pixels.
        count: windows (across, down) laid over the picture.
    """

    def __init__(self, measurer: Measurer, frame: Image, focal: float, height: float, window: int = 64,
                 count: tuple[int, int] = (4, 3)) -> None:
        self._measurer, self.focal, self.height, self.window = measurer, focal, height, window
        self._home: View = measurer.view(frame)
        width, height = measurer.size
        room = window // 2 + 8
        self._places = [(int(x), int(y)) for y in np.linspace(room, height - 1 - room, count[1])
                        for x in np.linspace(room, width - 1 - room, count[0])]
        self._centre = (np.array([width, height], np.float64) - 1) / 2
        self._seen, self._before = IDENTITY, IDENTITY
        self._search = SearchPredictor(floor=6, widest=32)

    def look(self, frame: Image) -> Fix:
        """Where the vehicle is, by the live picture."""
        live = self._measurer.view(frame)
        try:
            return self._fix(live)
        finally:
            self._measurer.release(live)

    def _fix(self, live: View) -> Fix:
        at = np.array(self._places, np.float64)
        guess = self._seen @ self._before.inverse @ self._seen
        moved = guess(at) - at
        reach = (self._search.reach, self._search.reach)
        answers = self._measurer.measure([
            Query(self._home, live, x, y, self.window, self.window, (float(d[0]), float(d[1])), reach)
            for (x, y), d in zip(self._places, moved, strict=True)])
        keep = [i for i, a in enumerate(answers) if a.valid]
        tried = len(answers)
        agree = np.zeros(0, bool)
        if len(keep) >= 2:
            p, q = at[keep], at[keep] + [[answers[i].dx_px, answers[i].dy_px] for i in keep]
            tolerance = 0.05 * self.window
            result = fit(p, q, vote(p, q, tolerance, 15.0, 1.2, float(self.window))[0], tolerance)
            agree = result.agree
        if agree.sum() < max(3, 0.3 * len(keep)):
            self._search.learn(np.zeros(0), tried)
            self._before = self._seen
            return Fix(0.0, 0.0, 0.0, 1.0, (0.0, 0.0), int(agree.sum()), tried, 0.0)
        misses = np.abs(q[agree] - guess(p[agree])).max(axis=1)
        self._search.learn(misses, tried)
        self._before, self._seen = self._seen, result.similarity
        return self._position(result.similarity, int(agree.sum()), tried)

    def _position(self, similarity: Similarity, agreed: int, tried: int) -> Fix:
        right, down = (float(v) for v in similarity(self._centre) - self._centre)
        x = self.height * down / self.focal
        y = -self.height * right / self.focal
        return Fix(x, y, similarity.rot_deg, similarity.scale, (right, down), agreed, tried, agreed / tried)


@dataclass(frozen=True)
class Moment:
    """One step of a station-keeping run: seconds; truth and measurement, metres (ahead, right); the command, m/s."""

    time: float
    true: tuple[float, float]
    fix: Fix
    command: tuple[float, float]
    picture: Image


def hold(measurer: Measurer, camera: Camera, vehicle: Vehicle, seconds: float, dt: float = 0.2, window: int = 64,
         gains: Gains | None = None, control: bool = True) -> Iterator[Moment]:
    """Keep the simulated vehicle where it is.

    Args:
        measurer: for the camera's frames.
        camera, vehicle: the simulation; the station is where the vehicle is now.
        seconds: how long.
        dt: seconds from frame to frame.
        window: side of the windows, pixels.
        gains: of both controllers, metres -> m/s.
        control: False lets it drift, for comparison.
    """
    home = vehicle.pose
    station = Station(measurer, camera.look(home), camera.focal, home.altitude, window)
    ahead, aside = Pid(gains or Gains()), Pid(gains or Gains())
    for _ in range(round(seconds / dt)):
        picture = camera.look(vehicle.pose)
        fix = station.look(picture)
        command = (0.0, 0.0)
        if control:
            if fix.confidence:
                command = ahead.step(-fix.x, dt), aside.step(-fix.y, dt)
            else:
                command = ahead.hold(), aside.hold()
        yield Moment(vehicle.time, _ahead(home, vehicle.pose), fix, command, picture)
        vehicle.step(*command, dt)


def _ahead(home: Pose, now: Pose) -> tuple[float, float]:
    """Metres ahead and to the right of `home`."""
    dx, dy = now.x - home.x, now.y - home.y
    c, s = math.cos(home.heading), math.sin(home.heading)
    return s * dx - c * dy, c * dx + s * dy
