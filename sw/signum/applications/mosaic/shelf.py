"""What a survey keeps on disk while it runs, so that it can continue after a crash: stored frames, edges, options.

    run.json     what was asked for, and whether it was finished
    frames/      the stored frames, PNG
    frames/starts.txt   the frames that begin a piece, a JSON string a line
    edges.csv    a row per measured edge, as soon as it is measured

A frame's picture is written before the row that places it, and the row ends with a newline: whatever the moment of a
crash, what can be read is whole, and at most the frame at work has to be taken again.
"""

from __future__ import annotations

import json
import os
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from urllib.parse import quote

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.errors import SignumError
from signum.measure.register import Prepared, Registrar

MADE = "mosaic*.png", "mosaic*.tif", "mosaic*.pgw", "poses*.csv", "accuracy*.csv"
"""Files made from the stored frames and edges."""
KEPT = 48
"""Prepared frames held in memory."""


class ResumeError(SignumError):
    """A survey that cannot be continued."""


@dataclass(frozen=True)
class SurveyRun:
    """What a survey was asked for; one with other values is another survey.

    Attributes:
        source: its label.
        size: width and height of the frames, pixels.
        stream: whether little moves between frames.
        window, sigma: of the registration.
        columns: how edges beside the sequence are looked for: single, auto or turned.
    """

    source: str
    size: tuple[int, int]
    stream: bool
    window: int
    sigma: float
    columns: str

    def differs(self, other: SurveyRun) -> str:
        """The first difference in words; empty if there is none. Where the frames come from may differ."""
        for name, flag in (("size", "frames of"), ("stream", "stream"), ("window", "--window"), ("sigma", "--sigma"),
                           ("columns", "--columns")):
            if getattr(self, name) != getattr(other, name):
                return f"{flag} {getattr(self, name)} instead of {getattr(other, name)}"
        return ""


class Shelf:
    """The stored frames and the run's description in a folder.

    Args:
        folder: the survey's; made if missing.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.frames = folder, folder / "frames"
        self.frames.mkdir(parents=True, exist_ok=True)
        self._prepared: OrderedDict[str, Prepared] = OrderedDict()

    def clear(self) -> None:
        """Remove the files of an earlier run."""
        for old in (*self.frames.glob("*.png"), self._starts, self.folder / "edges.csv"):
            old.unlink(missing_ok=True)
        for old in (file for kind in MADE for file in self.folder.glob(kind)):
            old.unlink()

    def save(self, name: str, picture: Image) -> None:
        """Store a frame."""
        write_picture(self._path(name), picture)

    def start(self, name: str) -> None:
        """Record that a frame begins a piece."""
        with self._starts.open("a", encoding="utf-8", newline="") as file:
            file.write(f"{json.dumps(name)}\n")

    def started(self) -> list[str]:
        """The frames that begin a piece, in order."""
        if not self._starts.exists():
            return []
        text = self._starts.read_text(encoding="utf-8")
        return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]

    @property
    def _starts(self) -> Path:
        return self.frames / "starts.txt"

    def picture(self, name: str) -> Image:
        """A stored frame.

        Raises:
            ResumeError: if it is gone.
        """
        picture = cv2.imread(str(self._path(name)), cv2.IMREAD_UNCHANGED)
        if picture is None:
            raise ResumeError(f"{self._path(name)}: missing or broken; start anew with --anew")
        return np.asarray(picture, np.uint8)

    def prepared(self, name: str, registrar: Registrar, known: Prepared | None = None) -> Prepared:
        """A stored frame as the board sees it; `known` is the result where it is at hand."""
        found = known or self._prepared.pop(name, None) or registrar.prepare(self.picture(name))
        self._prepared[name] = found
        while len(self._prepared) > KEPT:
            self._prepared.popitem(last=False)
        return found

    def pictures(self, names: Sequence[str]) -> Sequence[Image]:
        """Stored frames as a sequence that reads each when it is asked for."""
        return _Pictures(self, names)

    def _path(self, name: str) -> Path:
        return self.frames / f"{quote(name, safe=' ')}.png"

    def describe(self, run: SurveyRun, finished: bool) -> None:
        """Write `run.json`."""
        write_text(self.folder / "run.json", json.dumps({**asdict(run), "finished": finished}, indent=1) + "\n")

    def described(self) -> tuple[SurveyRun, bool] | None:
        """The run in `run.json`, and whether it was finished; None if there is none that can be read."""
        try:
            values = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
            finished = bool(values.pop("finished"))
            values["size"] = tuple(values["size"])
            return SurveyRun(**values), finished
        except (OSError, ValueError, KeyError, TypeError):
            return None


class _Pictures(Sequence[Image]):
    def __init__(self, shelf: Shelf, names: Sequence[str]) -> None:
        self._shelf, self._names = shelf, names

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, index: int) -> Image:  # type: ignore[override]  # no slices are used
        return self._shelf.picture(self._names[index])

    def __iter__(self) -> Iterator[Image]:
        return (self._shelf.picture(name) for name in self._names)


def write_picture(path: Path, picture: Image) -> None:
    """Write a PNG atomically."""
    _, data = cv2.imencode(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    _replace(path, data.tobytes())


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    _replace(path, text.encode())


def _replace(path: Path, data: bytes) -> None:
    half = path.with_name(path.name + ".part")
    half.write_bytes(data)
    os.replace(half, path)
