# SPDX-License-Identifier: Apache-2.0
"""What a survey keeps on disk, so that it can continue after a crash: the stored frames, the journal, the run's record.

    run.json            what was asked for, the files made of it, and whether all of them are finished
    frames/journal.txt  every frame and every registration; see `journal`
    frames/000012.png   the picture of frame number 12, where it is stored
    edges.csv           the measured edges, for the user; written anew from the journal when a survey is continued

A frame's name is in the journal only: file names are numbers.
"""

from __future__ import annotations

import json
import re
import zlib
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from signum.applications.mosaic.journal import Journal, SurveyRun, key_of
from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.common.files import UNFINISHED, decode_png, own_bytes, png, write_bytes, write_text
from signum.frames.frame import Frame
from signum.geometry.similarity import Similarity
from signum.measure.register import Registrar
from signum.measure.registration import Prepared, Registration

KEPT, KEPT_BYTES = 256, 64_000_000
"""Prepared frames held in memory at most, and their bytes: two columns of most surveys, as the frames beside the newest
are those of the column before."""
PICTURES_BYTES = 64_000_000
"""Bytes of stored frames held in memory while they are blended."""
RECORD, EDGES_FILE, JOURNAL = "run.json", "edges.csv", "frames/journal.txt"
"""Files of every survey."""
ALWAYS = "poses.csv", "mosaic.png"
"""Files that are made of every survey."""
FILES = re.compile(r"run\.json|(?:edges|accuracy|ground)\.csv|poses(-\d+)?\.csv|mosaic(-\d+)?\.(png|pgw|tif)")
"""Names of the files that a survey writes, apart from those in `frames`."""


class ResumeError(SignumError):
    """A survey that cannot be continued."""


class Shelf:
    """The stored frames, the journal and the run's record in a folder.

    Args:
        folder: the survey's.

    Attributes:
        made: names of the files made of the survey, apart from those every survey has.
        journal: of frames and registrations.
        mended: stored pictures that were damaged or lost and have been stored again.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.frames = folder, folder / "frames"
        self.journal = Journal(folder / JOURNAL)
        self.made: set[str] = set()
        self.mended: list[str] = []
        self._run: SurveyRun | None = None
        self._finished, self._described = False, ""
        self._recorded = False
        self._numbers: dict[str, int] = {}
        self._next = 0
        self._whole: set[int] = set()
        self._at_hand: dict[str, Image] = {}
        self._prepared: OrderedDict[str, Prepared] = OrderedDict()

    def clear(self) -> None:
        """Remove the files of an earlier survey in the folder, as far as its records name them."""
        self.read()
        for number in self.journal.stored:
            self._path(number).unlink(missing_ok=True)
        for name in (*self.made, EDGES_FILE, RECORD):
            (self.folder / name).unlink(missing_ok=True)
        self.journal.path.unlink(missing_ok=True)
        self.made, self._numbers, self._next, self.journal = set(), {}, 0, Journal(self.journal.path)
        self._recorded = False

    def read(self) -> None:
        """Take in the journal, the record and the names of the frames."""
        found = read_record(self.folder)
        self.made, self._recorded = set(found[2]) if found else set(), found is not None
        self.journal.read()
        for number, (name, _) in self.journal.frames.items():
            self.call(number, name)

    def begin(self, run: SurveyRun, finished: bool) -> None:
        """Open the journal, and write the record where it is another."""
        self.frames.mkdir(parents=True, exist_ok=True)
        for half in self.frames.glob(f"{UNFINISHED}[0-9]*.png"):  # of a write that a crash ended
            half.unlink()
        self._run = run
        self.describe(finished)
        self.journal.begin(run)

    def number(self, name: str) -> int:
        """The number of a frame, the next one for a name that has none."""
        if name not in self._numbers:
            self.call(self._next, name)
        return self._numbers[name]

    def call(self, number: int, name: str) -> None:
        """Give a frame a number of which the journal has lost the name."""
        self._numbers[name] = number
        self._next = max(self._next, number + 1)

    def take(self, frame: Frame) -> None:
        """Note a frame in the journal, before anything is measured on it; its picture stays in memory until `let_go`.

        Raises:
            ResumeError: if the frame was taken in before with another picture.
        """
        name, picture = frame.name, frame.picture
        number, crc = self.number(name), zlib.crc32(picture.tobytes())
        before = self.journal.frames.get(number)
        if before is not None and picture.size and before[1] != crc:
            raise ResumeError(f"{self.folder}: frame {name} is not the picture that it was when this survey took it "
                              "in: give the same source, or start anew with --anew")
        self._at_hand[name] = picture
        if picture.size:
            self.journal.frame(number, name, crc, frame.time_s)

    def time(self, name: str) -> float | None:
        """A frame's time on its source's clock, seconds; None if it has none."""
        return self.journal.times.get(self.number(name))

    @property
    def begun_s(self) -> float | None:
        """The time of the first frame that was taken in, seconds; None if it has none."""
        return self.journal.times.get(min(self.journal.frames, default=-1))

    def let_go(self, names: set[str]) -> None:
        """Keep the pictures of these frames in memory, of no others."""
        self._at_hand = {name: picture for name, picture in self._at_hand.items() if name in names}

    def save(self, name: str, picture: Image) -> None:
        """Store a frame; nothing is written where it is stored already, and the file is whole."""
        number = self.number(name)
        if number in self._whole:
            return
        before = self.journal.stored.get(number)
        if before is None or self._bytes(number, before) is None:
            if not picture.size:
                raise ResumeError(self._lost(number, name))
            if before is not None:
                self.mended.append(name)
            data = png(picture)
            write_bytes(self._path(number), data)
            self.journal.store(number, zlib.crc32(data))
        self._whole.add(number)

    def picture(self, name: str) -> Image:
        """A frame that is stored or at hand.

        Raises:
            ResumeError: if it is gone.
        """
        found = self._at_hand.get(name)
        if found is not None and found.size:
            return found
        number = self.number(name)
        data = self._bytes(number, self.journal.stored.get(number))
        picture = None if data is None else decode_png(data)
        if picture is None:
            raise ResumeError(self._lost(number, name))
        return picture

    def stored(self, name: str) -> Image | None:
        """A stored frame; None if it is not stored, or damaged."""
        try:
            return self.picture(name)
        except ResumeError:
            return None

    def _lost(self, number: int, name: str) -> str:
        return (f"{self._path(number)}: missing or broken, and the source does not give frame {name}; give the same "
                "source, or start anew with --anew")

    def _bytes(self, number: int, crc: int | None) -> bytes | None:
        """The file of a stored frame; None if it is missing or damaged."""
        try:
            data = own_bytes(self._path(number))
        except OSError:
            return None
        return data if crc == zlib.crc32(data) else None

    def prepared(self, name: str, registrar: Registrar) -> Prepared:
        """A frame that is stored or at hand as the board sees it."""
        found = self._prepared.pop(name, None) or registrar.prepare(self.picture(name))
        self._prepared[name] = found
        while len(self._prepared) > min(KEPT, max(2, KEPT_BYTES // max(1, found.nbytes))):
            self._prepared.popitem(last=False)
        return found

    def register(self, registrar: Registrar, a: str, b: str, guess: Similarity | None, reach: int | None
                 ) -> Registration:
        """Register two frames, or find in the journal what that gave before."""
        key = key_of(self.number(a), self.number(b), guess, reach)
        found = self.journal.find(key)
        if found is None:
            measured = registrar.register(self.prepared(a, registrar), self.prepared(b, registrar), guess, reach)
            found = self.journal.pair(key, measured)
        return found

    def pictures(self, names: Sequence[str]) -> Sequence[Image]:
        """Stored frames as a sequence that reads each when it is asked for, and keeps the latest."""
        return _Pictures(self, names)

    def _path(self, number: int) -> Path:
        return self.frames / f"{number:06d}.png"

    def make(self, name: str) -> Path:
        """The path of a file made of the survey, which is noted in the record before it is written.

        Raises:
            ResumeError: if there is a file of this name that the record of a continued survey does not name.
        """
        if name not in self.made:
            if self._recorded and name not in ALWAYS and (self.folder / name).exists():
                raise ResumeError(f"{self.folder / name}: is there already, and this survey has not made it: move it "
                                  "away and call again")
            self.made.add(name)
            self.describe(self._finished)
        return self.folder / name

    def unmake(self, name: str) -> None:
        """Remove a file that was made of the survey."""
        if name in self.made:
            (self.folder / name).unlink(missing_ok=True)
            self.made.remove(name)
            self.describe(self._finished)

    def describe(self, finished: bool) -> None:
        """Write `run.json`."""
        if self._run is None:
            return
        self._finished = finished
        text = json.dumps({**asdict(self._run), "made": sorted(self.made), "finished": finished}, indent=1) + "\n"
        if text != self._described:
            write_text(self.folder / RECORD, text)
            self._described = text


def read_record(folder: Path) -> tuple[SurveyRun, bool, list[str]] | None:
    """The run in `run.json`, whether it was finished, and the files made of it; None if there is none that can be
    read."""
    try:
        values = json.loads(own_bytes(folder / RECORD).decode())
        run = SurveyRun.read(values)
        made = [name for name in values["made"] if isinstance(name, str) and FILES.fullmatch(name)]
        return run, bool(values["finished"]), made
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError):
        return None


def survey_files(folder: Path) -> list[str]:
    """Names, relative to the folder, of what a survey there would replace: the files of one, and all that is in
    `frames`."""
    frames = folder / Path(JOURNAL).parent
    stored = frames.iterdir() if frames.is_dir() else ()
    return sorted([file.name for file in folder.iterdir() if FILES.fullmatch(file.name)]
                  + [f"{frames.name}/{file.name}" for file in stored if not file.name.startswith(UNFINISHED)])


def find_survey(folder: Path) -> SurveyRun | None:
    """What the survey in a folder was asked for, from its record, or from its journal if that is damaged; None if there
    is none that can be continued."""
    found = read_record(folder)
    if found is not None:
        return found[0]
    journal = Journal(folder / JOURNAL)
    journal.read()
    return journal.run


def has_journal(folder: Path) -> bool:
    """Whether frames in the journal of a survey's folder can be read, or nothing was made of it yet."""
    journal, found = Journal(folder / JOURNAL), read_record(folder)
    journal.read()
    return bool(journal.frames) or (found is not None and not found[2])


class _Pictures(Sequence[Image]):
    def __init__(self, shelf: Shelf, names: Sequence[str]) -> None:
        self._shelf, self._names = shelf, names
        self._kept: OrderedDict[int, Image] = OrderedDict()
        self._bytes = 0

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, index: int) -> Image:  # type: ignore[override]  # no slices are used
        found = self._kept.pop(index, None)
        if found is None:
            found = self._shelf.picture(self._names[index])
            self._bytes += found.nbytes
        self._kept[index] = found
        while self._bytes > PICTURES_BYTES:
            self._bytes -= self._kept.popitem(last=False)[1].nbytes
        return found

    def __iter__(self) -> Iterator[Image]:
        return (self[k] for k in range(len(self)))
