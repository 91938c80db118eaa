# SPDX-License-Identifier: Apache-2.0
"""The folder a command writes into: one process at a time, and only files that are the command's own.

`run-COMMAND.jsonl` in the folder names what a command was run on and the files it has made, a JSON string a line. A
later run of the same command replaces these files and no others. Files made from a live source are never replaced: what
was seen cannot be seen again.
"""

from __future__ import annotations

import errno
import fcntl
import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from signum.common.errors import SignumError
from signum.common.files import real_path, write_text
from signum.common.urls import without_secrets
from signum.sources.open import split_topic

SOURCES = "source", "left", "right"
"""Parameters that name frames."""
PAGE = "report.html"
"""The page that most commands write; those that share a folder replace each other's."""
WITHOUT_PAGE = {f"run-{command}.jsonl" for command in ("export", "filter", "simulate")}
"""Records of the commands that write none."""
SURVEY = "run.json", "frames/journal.txt"
"""Files that tell that a folder holds a survey, which has a page too."""


@dataclass(frozen=True)
class _Record:
    source: str
    live: bool
    made: tuple[str, ...]
    began_s: float = 0.0


class Outputs:
    """A locked folder; call `close` at the end.

    Args:
        folder: made if missing.
        command: its name.
        source: what it runs on, for the record.
        live: whether the source is live.
        replace: whether to remove the files of an earlier run now; else they may only be overwritten.
        began_s: time of the source's first frame, seconds on its own clock, for the record.

    Raises:
        SignumError: if another process writes into the folder, or it holds what came from a live source.
    """

    def __init__(self, folder: Path, command: str, source: str = "", live: bool = False, replace: bool = True,
                 began_s: float | None = None) -> None:
        self.folder, self.command = folder, command
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = lock(folder)
        self._log = None
        try:
            self._record = folder / f"run-{command}.jsonl"
            before = _read(self._record)
            self._page_trouble = page_trouble(folder)
            kept = [name for name in before.made if (folder / name).exists()] if before else []
            if before and before.live and kept:
                raise SignumError(f"{folder}: holds {kept[0]} of {before.source}, which cannot be seen again: choose "
                                  "another --out, or move it away")
            self._mine = set(kept) & {PAGE} if replace else set(kept)
            if replace:
                for name in set(kept) - {PAGE}:  # which tells of other commands' runs too
                    (folder / name).unlink()
            head = json.dumps({"source": source, "live": live, **({"began_s": began_s} if began_s else {})})
            write_text(self._record, "".join(f"{line}\n" for line in (head, *map(json.dumps, sorted(self._mine)))))
            self._log = self._record.open("a", encoding="utf-8")
        except BaseException:
            self.close()
            raise

    def file(self, name: str) -> Path:
        """The path of a file, relative to the folder, that the command is going to write.

        Raises:
            SignumError: if there is a file of this name that the command has not made.
        """
        path = self.folder / name
        if name == PAGE and self._page_trouble:
            raise SignumError(self._page_trouble)
        if name not in self._mine:
            if name != PAGE and path.exists():
                raise SignumError(f"{path}: is there already, and signum {self.command} has not made it: choose "
                                  "another --out, or move it away")
            assert self._log is not None
            self._log.write(f"{json.dumps(name)}\n")
            self._log.flush()
            self._mine.add(name)
        return path

    def close(self) -> None:
        """Let other processes use the folder."""
        if self._log is not None:
            self._log.close()
        os.close(self._lock)


def page_trouble(folder: Path) -> str:
    """Why `report.html` of a folder may not be replaced: no command whose record is there has made it, or one did from
    a live source; empty if it may."""
    records = [record for path in sorted(folder.glob("run-*.jsonl")) if path.name not in WITHOUT_PAGE
               and (record := _read(path)) is not None and record.made]
    live = next((record for record in records if record.live and PAGE in record.made), None)
    if not (folder / PAGE).exists():
        return ""
    if live is not None:
        return (f"{folder / PAGE}: is of {live.source}, which cannot be seen again: choose another --out, or move it "
                "away")
    if records or any((folder / name).exists() for name in SURVEY):
        return ""
    return f"{folder / PAGE}: is there already, and signum has not made it: choose another --out, or move it away"


def lock(folder: Path) -> int:
    """Lock a folder for this process until the returned handle is closed with `os.close`, or the process ends.

    Raises:
        SignumError: if another process has locked it.
    """
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
            return handle  # a file system without locks
        os.close(handle)
        raise SignumError(f"{folder}: another signum is writing into it: wait until it ends, or choose another --out"
                          ) from error
    return handle


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Lock a folder, if there is one, for what runs inside."""
    handle = lock(folder) if folder.is_dir() else None
    try:
        yield
    finally:
        if handle is not None:
            os.close(handle)


def move_aside(folder: Path) -> Path:
    """Rename a folder to the first free one of `NAME-1`, `NAME-2`, ...; returns the new path."""
    real = real_path(folder)
    number = 1
    while (new := real.with_name(f"{real.name}-{number}")).exists():
        number += 1
    os.rename(real, new)
    return new


def identity(source: str) -> str:
    """A source as the user named it, whatever the spelling: whole path of a file, with the topic of a bag; a camera or
    the simulated world as it is, a stream without its password."""
    try:
        file, topic = split_topic(source)
        if Path(file).exists():
            return f"{real_path(file)}{'#' if topic else ''}{topic}"
    except (OSError, ValueError):  # no name of a file
        pass
    return without_secrets(source.removeprefix("camera:"))


def began(folder: Path, command: str) -> float:
    """The time of the first frame that a command's tables in a folder are of, seconds on its source's own clock; 0
    where that is not known."""
    record = _read(folder / f"run-{command}.jsonl")
    return record.began_s if record else 0.0


def check_inputs(folder: Path, command: str, values: Mapping[str, object]) -> None:
    """Check that a command does not replace what it reads, and does not write among the pictures it reads.

    Args:
        folder: that it writes into, which need not exist.
        command: its name.
        values: of its parameters, by their names.

    Raises:
        SignumError: if it would.
    """
    if not folder.is_dir():
        return
    out, before = real_path(folder), _read(folder / f"run-{command}.jsonl")
    made = {out / name for name in before.made} if before else set()
    for name, value in values.items():
        if isinstance(value, str | Path):
            real = Path(split_topic(identity(str(value)))[0])
            if real in made:
                raise SignumError(f"{value}: signum {command} has made it, and would replace it while reading it: "
                                  "choose another --out")
            if name in SOURCES and real in ((out, out / "frames") if command == "mosaic" else (out,)):
                raise SignumError(f"--out {folder}: {real} is the folder of the frames, where pictures that are "
                                  "written would count as frames: choose another --out")


def _read(path: Path) -> _Record | None:
    """A record; None if there is none that can be read. Names that leave the folder are left out.

    Raises:
        SignumError: if something else is in its place.
    """
    if path.exists() and not path.is_file():
        raise SignumError(f"{path}: not a file, where signum keeps its record: move it away, or choose another --out")
    try:
        head, *lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
        values = json.loads(head)
        source, live, began_s = str(values["source"]), bool(values["live"]), float(values.get("began_s", 0.0))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    made = []
    for line in lines:
        try:
            name = json.loads(line)
        except ValueError:
            continue
        if isinstance(name, str) and name and not {"..", "/"} & set(PurePosixPath(name).parts):
            made.append(name)
    return _Record(source, live, tuple(dict.fromkeys(made)), began_s if math.isfinite(began_s) else 0.0)
