# SPDX-License-Identifier: Apache-2.0
"""The journal of a survey: every frame taken in and every registration, with all bits, a line each.

A survey is a function of its frames and of the registrations between them, and both are in the journal. To continue
one, the same steps run again on the frames in the journal's order, with registrations out of the journal: what was
measured is not measured again, and the result has the same bytes as that of an uninterrupted run. A line is its CRC-32
and a JSON array:

    run      what was asked for; see `SurveyRun`
    frame    number, name, CRC-32 of the picture's pixels, time in seconds if it has one
    stored   number, CRC-32 of `NUMBER.png`
    match    numbers of both frames, guess (4 numbers) or null, reach or null, the registration

A line that is damaged, cut short by a crash or lost is left out, and what it held is measured again. So are lines of
another kind: registrations whose numbers mean something else get another word than `MATCH`.
"""

from __future__ import annotations

import json
import math
import os
import zlib
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from signum.common.files import own_bytes
from signum.geometry.similarity import Similarity
from signum.measure.registration import Registration, Rival

MATCH = "motion"
"""Begins the line of a registration whose similarity is that of the surface that most of an overlap shows
(`measure.surface`), and whose evidence doubts low peaks and asks small windows (`measure.likelihood`)."""
Key = tuple[int, int, tuple[float, ...] | None, int | None]
"""A registration's question: the frames' numbers, the guess as 4 numbers, the reach."""


@dataclass(frozen=True)
class SurveyRun:
    """What a survey was asked for; one with other values is another survey.

    Attributes:
        source: where the frames come from: a whole path, or a camera or simulated world.
        calibration: whole path of the camera's calibration, empty for none.
        size: width and height of the frames, pixels.
        stream: whether little moves between frames.
        window, sigma: of the registration.
        columns: how edges beside the sequence are looked for: single, auto or turned.
        order: in which pairs are measured: "batch" when all frames are there, empty as the frames come.
    """

    source: str
    size: tuple[int, int]
    stream: bool
    window: int
    sigma: float
    columns: str
    calibration: str = ""
    order: str = ""

    @classmethod
    def read(cls, values: object) -> SurveyRun:
        """From the values of a JSON object; others in it are ignored.

        Raises:
            ValueError, KeyError, TypeError, OverflowError: if it is no such object.
        """
        if not isinstance(values, dict):
            raise TypeError("no object")
        width, height = values["size"]
        run = cls(values["source"], (int(width), int(height)), bool(values["stream"]), int(values["window"]),
                  float(values["sigma"]), values["columns"], values.get("calibration", ""), values.get("order", ""))
        if not math.isfinite(run.sigma):
            raise ValueError("no width of a filter")
        if not all(isinstance(text, str) for text in (run.source, run.columns, run.calibration, run.order)):
            raise TypeError("no text")
        return run

    def differs(self, other: SurveyRun) -> str:
        """The first difference in words, apart from the source; empty if there is none."""
        for name, flag in (("size", "frames of"), ("stream", "stream"), ("window", "--window"), ("sigma", "--sigma"),
                           ("columns", "--columns"), ("calibration", "--calibration"), ("order", "order")):
            mine, others = ("x".join(map(str, v)) if isinstance(v, tuple) else v or "none" if isinstance(v, str) else v
                            for v in (getattr(self, name), getattr(other, name)))
            if mine != others:
                return f"{flag} {mine} instead of {others}"
        return ""


class Journal:
    """The file of a survey's journal, read and appended to.

    Args:
        path: of the file; `read` and `begin` open it.

    Attributes:
        run: what was asked for; None if that line cannot be read.
        frames: by number, name and CRC-32 of the pixels of the frames in the journal.
        times: by number, seconds on the source's clock, of the frames that have a time.
        stored: by number, CRC-32 of the stored pictures' files.
        dropped: lines that could not be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.run: SurveyRun | None = None
        self.frames: dict[int, tuple[str, int]] = {}
        self.times: dict[int, float] = {}
        self.stored: dict[int, int] = {}
        self.dropped = 0
        self._known: dict[Key, Registration] = {}
        self._file: Any = None

    def read(self) -> None:
        """Take in what the file holds, if there is one; a last line without its end is no damage."""
        try:
            data = own_bytes(self.path)
        except (FileNotFoundError, NotADirectoryError):
            return
        lines = data.split(b"\n")
        for line in lines[:-1]:
            try:
                self._take(line)
            except (ValueError, KeyError, TypeError, OverflowError):
                self.dropped += 1

    def _take(self, line: bytes) -> None:
        check, _, text = line.partition(b" ")
        if int(check, 16) != zlib.crc32(text):
            raise ValueError("damaged")
        kind, *values = json.loads(text)
        if kind == "run":
            self.run = SurveyRun.read(values[0])
        elif kind == "frame":
            number, name, crc, *time = values
            self._note(number, name, crc, float(time[0]) if time else None)
        elif kind == "stored":
            self.stored[values[0]] = values[1]
        elif kind == MATCH:
            a, b, guess, reach, found = values
            self._known[a, b, None if guess is None else tuple(guess), reach] = _registration(found)

    def begin(self, run: SurveyRun) -> None:
        """Open the file to append to it, with the description first; a last line without its end is removed."""
        self._file = self.path.open("ab", buffering=0)
        with self.path.open("rb+") as file:
            data = file.read()
            file.truncate(data.rfind(b"\n") + 1)
        if self.run is None:
            self._write("run", asdict(run))
            self.run = run
            self.sync()

    def frame(self, number: int, name: str, crc: int, time: float | None = None) -> None:
        """Note a frame and its time before anything is measured on it; nothing is written if both are noted already. A
        frame that comes without a time keeps the one that is noted."""
        if self.frames.get(number) != (name, crc) or time not in (None, self.times.get(number)):
            time = self.times.get(number) if time is None else time
            self._note(number, name, crc, time)
            self._write("frame", number, name, crc, *(() if time is None else (time,)))

    def _note(self, number: int, name: str, crc: int, time: float | None) -> None:
        self.frames[number] = name, crc
        if time is not None and math.isfinite(time):
            self.times[number] = time

    def store(self, number: int, crc: int) -> None:
        """Note that a frame's picture is stored; also makes sure that all lines so far are on the disk."""
        if self.stored.get(number) != crc:
            self.stored[number] = crc
            self._write("stored", number, crc)
            self.sync()

    def find(self, key: Key) -> Registration | None:
        """The registration that answers a question, if it is in the journal."""
        return self._known.get(key)

    def pair(self, key: Key, found: Registration) -> Registration:
        """Note a registration; returns it as it is read back, of Python's own numbers, which NumPy's differ from in the
        last bit of a quotient."""
        a, b, guess, reach = key
        text = self._write(MATCH, a, b, guess, reach, _values(found))
        self._known[key] = _registration(json.loads(text)[5])
        return self._known[key]

    def sync(self) -> None:
        """Make sure that all lines are on the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Write no more."""
        if self._file is not None and not self._file.closed:
            self._file.close()

    def _write(self, *values: object) -> bytes:
        text = json.dumps(values, separators=(",", ":"), default=_plain).encode()
        line = b"%08x %s\n" % (zlib.crc32(text), text)
        try:
            done = self._file.write(line)
            if done < len(line):  # a full disk takes what fits and refuses the rest
                self._file.write(line[done:])
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self.path)) from error
        return text


def _plain(value: Any) -> object:
    """A NumPy number as one of Python."""
    return value.item()


def key_of(a: int, b: int, guess: Similarity | None, reach: int | None) -> Key:
    """The question of a registration."""
    return a, b, None if guess is None else (guess.factor.real, guess.factor.imag, guess.shift.real,
                                             guess.shift.imag), reach


def _values(found: Registration | Rival) -> list[object]:
    """Its JSON array: the fields in order, a similarity as four numbers, rivals as arrays of their own."""
    s = found.similarity
    rest = [getattr(found, field.name) for field in fields(found)[1:]]
    if isinstance(found, Registration):
        rest[-4] = [_values(rival) for rival in found.rivals]
    return [[s.factor.real, s.factor.imag, s.shift.real, s.shift.imag], *rest]


def _registration(values: list[Any]) -> Registration:
    """Of its JSON array.

    Raises:
        ValueError, TypeError: if it is none.
    """
    (similarity, shift, score, margin, agreed, tried, accepted, reason, turning, middle, spread, rms, evidence,
     rivals, shear, shear_error, sloping) = values
    _check(*shift, score, margin, *middle, spread, rms, evidence, *shear, shear_error)
    return Registration(_similarity(similarity), (shift[0], shift[1]), score, margin, int(agreed), int(tried),
                        bool(accepted), str(reason), bool(turning), (middle[0], middle[1]), spread, rms, evidence,
                        tuple(_rival(rival) for rival in rivals), (shear[0], shear[1]), shear_error, bool(sloping))


def _rival(values: list[Any]) -> Rival:
    """Of its JSON array; raises as `_registration`."""
    similarity, score, margin, agreed, turning, middle, spread, rms, evidence = values
    _check(score, margin, *middle, spread, rms, evidence)
    return Rival(_similarity(similarity), score, margin, int(agreed), bool(turning), (middle[0], middle[1]), spread,
                 rms, evidence)


def _similarity(values: list[Any]) -> Similarity:
    """Of real and imaginary parts of its factor and shift."""
    fr, fi, sr, si = values
    _check(fr, fi, sr, si)
    if fr == 0 and fi == 0:
        raise ValueError("no similarity")
    return Similarity(complex(fr, fi), complex(sr, si))


def _check(*numbers: Any) -> None:
    """Raise ValueError or TypeError for what is no finite number."""
    if not all(math.isfinite(float(v)) for v in numbers):
        raise ValueError("no registration")
