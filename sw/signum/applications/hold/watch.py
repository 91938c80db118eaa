# SPDX-License-Identifier: Apache-2.0
"""Station keeping's measurements on recorded or live frames; the first frame is the station."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from signum.applications.hold.keeper import Sensed, StationKeeper
from signum.applications.hold.meter import StationMeter
from signum.applications.hold.reading import UPRIGHT, Reading
from signum.applications.hold.transit import LEAVING, Transit
from signum.common.arrays import Floats, Image
from signum.common.errors import SourceError
from signum.frames.fit import Fit
from signum.frames.frame import Frame, Source
from signum.measure.measurer import Measurer


@dataclass(frozen=True, eq=False)
class StationFrame:
    """A frame's reading; picture and features (n, 2) in the board's pixels; whether this frame becomes the reference of
    those after it."""

    name: str
    time: float
    reading: Reading
    picture: Image
    features: Floats
    anchored: bool = False


@dataclass(frozen=True)
class Sensors:
    """The vehicle's own.

    Attributes:
        at: what they measure at a time, seconds after the first frame.
        ranged: whether their range is taken: that of the first frame, else of the first with a reading, from which on
            the metres are by it.
    """

    at: Callable[[float], Sensed] = lambda time: Sensed()
    ranged: bool = False


NO_SENSORS = Sensors()


def watch_station(measurer: Measurer, frames: Iterator[Frame] | Source, fit: Fit, focal: float, range_m: float,
                  rate: float, window: int = 64, seconds: float | None = None, sensors: Sensors = NO_SENSORS,
                  follow_ground: bool = False) -> Iterator[StationFrame]:
    """Measure frames against the first of them.

    Meter and search are those of the closed loop. Control forces are computed and discarded. Without an attitude sensor
    the camera is assumed to look straight at the scene.

    Args:
        measurer: of size `fit.board`.
        frames: of size `fit.source`.
        focal: pixels of the frames. range_m: to the scene in the first frame, metres.
        rate: frames per second, where frames have no times.
        seconds: after the first frame at which to end, None for never.
        sensors: of the vehicle.
        follow_ground: whether another frame becomes the reference where the present one is about to leave the view;
            readings stay relative to the first frame, with errors that add up.

    Raises:
        SourceError: if the first frame has too little texture.
    """
    meter = StationMeter(measurer, focal / fit.factor[0], range_m, window)
    keeper: StationKeeper | None = None
    ranged = sensors.ranged
    first, last = 0.0, -1 / rate
    for k, frame in enumerate(frames):
        if k == 0:
            first = frame.time_s or 0.0
        time = k / rate if frame.time_s is None else frame.time_s - first
        if seconds is not None and time >= seconds - 1e-6:
            return
        picture, sensed = fit.show(frame.picture), sensors.at(time)
        if keeper is None:
            if ranged and sensed.range_m is not None:
                meter.range_m, ranged = sensed.range_m, False
            if meter.anchor(meter.view(picture), sensed.level or UPRIGHT) < meter.least:
                raise SourceError(f"frame {frame.name}: only {meter.offered} of the {meter.least} features needed: "
                                  "begin where the picture shows texture, or choose another --window or --sigma")
            keeper = StationKeeper(meter)
            transit = Transit(meter.range_m)
        reading, _ = keeper.step(meter.view(picture), sensed, time - last)
        if ranged and reading.valid and sensed.range_m is not None:
            ratio, ranged = sensed.range_m / reading.range_m, False
            keeper.rescale(ratio)
            transit.rescale(ratio)
            reading = replace(reading.scaled(ratio), reference=meter.changes)
        last, features = time, meter.features_at(sensed.level or UPRIGHT)
        leaving = follow_ground and reading.valid and meter.in_sight() < LEAVING
        if leaving:
            keeper.move(meter.view(picture), sensed.level or UPRIGHT, reading.range_m)
        whole = transit.change(reading) if leaving else transit.whole(reading)
        yield StationFrame(frame.name, time, whole, picture, features, leaving)
