# SPDX-License-Identifier: Apache-2.0
"""Known places of frames: a truth, or a navigation log by frame or by time.

Positions are complex numbers x + iy with y down, as pixels have it; east and north become east - i north.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path, PureWindowsPath

import numpy as np

from signum.applications.mosaic.pose import Pose
from signum.common.arrays import Complexes, Floats
from signum.common.console import notes
from signum.common.errors import SignumError

GAP = 5.0
"""Fixes further apart than this, in times of the usual step, are not interpolated between."""
SHORTEST_GAP_S = 1.0
"""Fixes up to this far apart, seconds, always are."""
SLACK_S = 1e-3
"""Times nearer than this are the same, seconds."""
LONGEST_NUMBER = 19
"""Digits from which on a name is no number."""
NAMED = 6
"""Most frames named in a message."""


@dataclass(frozen=True, eq=False)
class Track:
    """Known positions of frames.

    Attributes:
        positions: by frame, complex, y down.
        headings: by frame, degrees, clockwise seen from above; empty where they are not known.
        unit: "m" or "px".
        epsg: code of the projected system of metres, 0 where it is not known.
        accuracy_m: of the step from latitude and longitude to that system, metres.
    """

    positions: dict[str, complex]
    headings: dict[str, float]
    unit: str
    epsg: int = 0
    accuracy_m: float = 0.0

    def of(self, poses: Sequence[Pose]) -> Track:
        """The positions of these frames, by their own names.

        A name that the log does not have is looked for as a number, so 7 is frame 007, unless two have that number.
        """
        numbers = {name: number for name in self.positions if (number := _number(name)) is not None}
        times = Counter(numbers.values())
        by_number: dict[int | None, str] = {n: name for name, n in numbers.items() if times[n] == 1}
        found = {pose.frame: pose.frame if pose.frame in self.positions else by_number.get(_number(pose.frame))
                 for pose in poses}
        names = {frame: name for frame, name in found.items() if name is not None}
        return replace(self, positions={frame: self.positions[name] for frame, name in names.items()},
                       headings={frame: self.headings[name] for frame, name in names.items() if name in self.headings})


@dataclass(frozen=True, eq=False)
class TimedTrack:
    """Known positions at times.

    Attributes:
        path: of the log, for messages.
        times: (n,) ascending, seconds on the log's clock.
        positions: (n,) complex, y down, metres.
        epsg, accuracy_m: as of `Track`.
        start: time of the survey's first frame on the log's clock, seconds; None if the frames' clock is the log's.
        first: gives the time of the survey's first frame on the frames' clock, seconds.
    """

    path: Path
    times: Floats
    positions: Complexes
    epsg: int = 0
    accuracy_m: float = 0.0
    start: float | None = None
    first: Callable[[], float | None] = lambda: None

    def of(self, poses: Sequence[Pose]) -> Track:
        """The positions of these frames, linear between the fixes before and after. A frame without a time, outside of
        the log or in a gap of it has none; the last two are named.

        Raises:
            SignumError: if none of the frames' times lies in the log.
        """
        timed = [(pose.frame, pose.time_s) for pose in poses if pose.time_s is not None]
        begin = self.first()
        shift = 0.0 if self.start is None or begin is None else self.start - begin
        at = np.array([time + shift for _, time in timed], np.float64)
        inside = (at >= self.times[0] - SLACK_S) & (at <= self.times[-1] + SLACK_S)
        span = f"its times are {clock_text(self.times[0])} to {clock_text(self.times[-1])}"
        if not inside.any():
            theirs = f"those of the frames {clock_text(at.min())} to {clock_text(at.max())}" if len(at) else (
                "the frames have none")
            raise SignumError(f"{self.path}: no frame lies within the log: {span}, {theirs}; if the clocks differ, "
                              "give the first frame's time on the log's clock with --start")
        place = np.interp(at, self.times, self.positions.real) + 1j * np.interp(at, self.times, self.positions.imag)
        after = np.clip(np.searchsorted(self.times, at), 1, len(self.times) - 1)
        steps = np.diff(self.times)
        beside = np.minimum(np.abs(at - self.times[after - 1]), np.abs(at - self.times[after]))
        wide = (steps[after - 1] > max(GAP * float(np.median(steps)), SHORTEST_GAP_S)) & (beside > SLACK_S)
        for which, what in ((~inside, f"lie outside the log, {span}"), (inside & wide, "lie in a gap of the log")):
            without = [frame for (frame, _), there in zip(timed, which, strict=True) if there]
            if without:
                notes.print(f"{self.path}: {len(without)} frames ({listed(without)}) {what}: placed by their "
                            "neighbours alone")
        good = inside & ~wide
        return Track({frame: complex(place[k]) for k, (frame, _) in enumerate(timed) if good[k]}, {}, "m", self.epsg,
                     self.accuracy_m)


def _number(name: str) -> int | None:
    """A frame's name as a number, if it is one."""
    return int(name) if name.isdecimal() and len(name) < LONGEST_NUMBER else None


def listed(names: Sequence[str]) -> str:
    """Names for a message, the first few."""
    return ", ".join(names[:NAMED]) + (", ..." if len(names) > NAMED else "")


def clock_text(seconds: float) -> str:
    """A time for people: what can only be seconds since 1970 as date and time in UTC, all else in seconds."""
    if 1e8 < seconds < 1e11:
        return f"{datetime.fromtimestamp(float(seconds), UTC):%Y-%m-%dT%H:%M:%S}Z"
    return f"{seconds:g} s"


def read_moment(text: str, label: str) -> float:
    """Seconds of a time: a number, or a date and time as ISO 8601, then since 1970, UTC unless it states its zone.

    Raises:
        SignumError: if it is neither.
    """
    try:
        value = float(text)
    except ValueError:
        try:
            moment = datetime.fromisoformat(text)
            return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
        except (ValueError, OverflowError):
            raise SignumError(f"{label} is {text!r}; expected seconds, or a date and time such as "
                              "2026-03-01T10:00:00Z") from None
    if not abs(value) < 1e11:
        raise SignumError(f"{label} is {value:g}; expected seconds, or a date and time such as 2026-03-01T10:00:00Z")
    return value


PICTURE_ENDINGS = frozenset({
    ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp", ".dng", ".nef", ".cr2", ".cr3", ".arw",
    ".orf", ".rw2", ".raf", ".heic"})
"""Endings of pictures, and of cameras' raw files of which pictures were made, that a log may write after a name."""


def frame_name(text: str) -> str:
    """A frame's name of a log's cell, which may be a file's, with folder and ending."""
    path = PureWindowsPath(text)  # which takes both kinds of slashes
    return path.stem if path.suffix.lower() in PICTURE_ENDINGS else text
