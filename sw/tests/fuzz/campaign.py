# SPDX-License-Identifier: Apache-2.0
"""A campaign: cases drawn by seed, run two at a time, judged, and each failure reduced to a minimal reproduction."""

from __future__ import annotations

import gc
import os
import shlex
import shutil
import time
from collections import Counter, deque
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import typer

from signum.common.files import write_picture
from tests.fuzz.child import sketch, start
from tests.fuzz.corpus import KINDS, SMALL, Kind, build
from tests.fuzz.judge import FAILURES, Outcome, Rows, judge, tables
from tests.fuzz.mutate import NAMES, Edit, arguments, edits, replace

WARM = "png", "folder", "bag", "stereo", "navigation", "chart"
"""Kinds of input whose commands are run once before the first case."""


@dataclass
class Case:
    """A damaged input and the command that reads it.

    Attributes:
        number: which decides it, together with the campaign's seed.
        kind: of the input.
        edits: of the victim's bytes; empty for other damage.
        victim: the damaged file, within the input's folder.
        about: the damage in words.
        line: the command line.
    """

    number: int
    kind: str
    folder: Path
    edits: list[Edit] = field(default_factory=list)
    victim: str = ""
    about: str = ""
    line: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Failure:
    """A failure, with the folder of its minimal reproduction."""

    case: Case
    outcome: Outcome
    why: str
    folder: Path


class Campaign:
    """Runs cases.

    Args:
        folder: for inputs, cases and reproductions; made anew.
        seed: decides all cases, with their numbers.
        jobs: children at a time.
        kinds: of input; all by default.
    """

    def __init__(self, folder: Path, seed: int, jobs: int = 2, kinds: tuple[str, ...] = tuple(KINDS)) -> None:
        from signum.commands.cli import application

        self.application: Any = typer.main.get_command(application())
        shutil.rmtree(folder, ignore_errors=True)
        self.folder, self.seed, self.jobs, self.kinds = folder.resolve(), seed, jobs, kinds
        self.inputs = self.folder / "inputs"
        build(self.inputs)
        self._warm()
        self._make("resume", [a.replace("--resume", "--anew") for a in KINDS["resume"].command])
        self._make("report", ["track", "{in}/../npy/dive.npy", "--features", "6", *SMALL, "--out", "{in}/track"])
        self.good: dict[str, Rows] = {kind: self._undamaged(kind) for kind in kinds}
        self.outcomes: dict[str, Counter[Outcome]] = {kind: Counter() for kind in kinds}
        self.failures: list[Failure] = []
        self.seconds: list[tuple[float, str]] = []

    def run(self, count: int | None, seconds: float | None = None) -> None:
        """Run so many cases, or as many as fit into a time."""
        end = None if seconds is None else time.monotonic() + seconds
        running: deque[tuple[Case, Any]] = deque()
        for case in self._cases():
            if (count is not None and case.number >= count) or (end is not None and time.monotonic() > end):
                break
            running.append((case, start(self.application, case.line, case.folder)))
            while len(running) >= self.jobs:
                self._collect(running)
        while running:
            self._collect(running)

    def _collect(self, running: deque[tuple[Case, Any]]) -> None:
        """Take the children that have ended."""
        for case, child in list(running):
            status = child.finished()
            if status is not None:
                running.remove((case, child))
                self.seconds.append((time.monotonic() - child.started, case.kind))
                self._take(case, status)
        time.sleep(0.002)

    def _take(self, case: Case, status: int) -> None:
        outcome, why = self._judge(case, status)
        self.outcomes[case.kind][outcome] += 1
        if outcome in FAILURES:
            self._reduce(case, outcome)
            keep = self.folder / "failures" / f"{case.number}-{case.kind}"
            shutil.rmtree(keep, ignore_errors=True)
            keep.parent.mkdir(exist_ok=True)
            case.folder.rename(keep)
            line = [a.replace(str(case.folder), str(keep)) for a in case.line]
            (keep / "command.txt").write_text(
                f"{outcome}: {why}\n{case.about}\ncd {keep} && {shlex.join(['signum', *line])}\n",
                encoding="utf-8", errors="surrogateescape")
            self.failures.append(Failure(case, outcome, why, keep))
        else:
            shutil.rmtree(case.folder, ignore_errors=True)

    def _judge(self, case: Case, status: int) -> tuple[Outcome, str]:
        said = (case.folder / "said.txt").read_text(encoding="utf-8", errors="replace")
        kind = KINDS[case.kind]
        out = case.folder / ("in/survey" if kind.resumed else "in/track" if case.kind == "report" else "out")
        # Renamed frames and other options give other tables.
        good = {} if case.kind in ("options", "names", "report") else self.good[case.kind]
        return judge(status, said, out, good, kind.checksum)

    def _reduce(self, case: Case, outcome: Outcome) -> None:
        """Leave out edits, and halves of what they write, as long as the outcome stays."""
        if outcome is Outcome.hang:
            return
        for k in reversed(range(len(case.edits))):
            fewer = case.edits[:k] + case.edits[k + 1:]
            if fewer and self._again(case, fewer) is outcome:
                case.edits = fewer
        self._again(case, case.edits)

    def _again(self, case: Case, chosen: list[Edit]) -> Outcome:
        if case.edits:
            shutil.rmtree(case.folder)
            self._lay(case, chosen)
        status = start(self.application, case.line, case.folder).finished(wait=True)
        return self._judge(case, status if status is not None else 0)[0]

    def _cases(self) -> Iterator[Case]:
        """All cases in order, each laid out in its folder."""
        weights = np.array([KINDS[k].weight for k in self.kinds], float)
        number = 0
        while True:
            rng = np.random.default_rng([self.seed, number])
            case = Case(number, str(rng.choice(self.kinds, p=weights / weights.sum())), self.folder / f"case{number}")
            self._damage(case, rng)
            yield case
            number += 1

    def _damage(self, case: Case, rng: np.random.Generator) -> None:
        kind = KINDS[case.kind]
        if case.kind in ("options", "names"):
            self._lay(case, [])
            if case.kind == "options":
                write_picture(case.folder / "in" / "a.png", np.load(case.folder / "in" / "dive.npy")[0])
                case.line = arguments(rng, str(case.folder / "in" / "dive.npy"), str(case.folder / "out"))
                case.line = [a.replace("dive.npy/../", "") for a in case.line]
            else:
                self._rename(case, rng)
            return
        files = sorted(f for pattern in kind.victims for f in (self.inputs / case.kind).glob(pattern) if f.is_file())
        victim = files[int(rng.integers(len(files)))]
        case.victim = str(victim.relative_to(self.inputs / case.kind))
        if rng.random() < 0.06:
            self._lay(case, [])
            way = replace(case.folder / "in" / case.victim, rng, case.kind != "folder")
            case.about = f"{case.victim} is replaced: {way}"
            return
        case.edits = edits(victim.read_bytes(), rng)
        self._lay(case, case.edits)

    def _rename(self, case: Case, rng: np.random.Generator) -> None:
        """Give a picture, or the output folder, a name of its own."""
        name = NAMES[int(rng.integers(len(NAMES)))]
        if rng.random() < 0.3:
            case.line = [a.replace(str(case.folder / "out"), str(case.folder / name)) for a in case.line]
            case.about = f"output is called {name!r}"
            return
        file = sorted((case.folder / "in").glob("*.png"))[int(rng.integers(4))]
        case.about = f"{file.name} is called {name!r}"
        try:
            file.rename(file.with_name(f"{name.replace('/', '')}.png"))
        except OSError:
            case.about += ", which the file system refuses"

    def _lay(self, case: Case, chosen: list[Edit]) -> None:
        """Lay out the input with the victim's bytes edited."""
        shutil.copytree(self.inputs / case.kind, case.folder / "in")
        case.line = _filled(KINDS[case.kind], case.folder)
        if chosen:
            path = case.folder / "in" / case.victim
            raw = path.read_bytes()
            for edit in chosen:
                raw = edit(raw)
            path.write_bytes(raw)
            case.about = f"{case.victim}: " + "; ".join(
                f"bytes {e.start} to {e.stop} become {e.new[:40]!r}" for e in chosen)

    def _warm(self) -> None:
        """Run commands in this process, so that a child has all that they load and compute on first use."""
        import matplotlib.pyplot

        import signum.sources.bags
        import signum.sources.simulated  # noqa: F401

        cv2.setNumThreads(1)
        matplotlib.pyplot.switch_backend("agg")
        sketch()
        for kind in WARM:
            case = Case(-1, kind, self.folder / "warm" / kind)
            self._lay(case, [])
            with open(os.devnull, "w") as sink, redirect_stdout(sink), redirect_stderr(sink), suppress(SystemExit):
                self.application(case.line)
        gc.collect()
        gc.freeze()  # a collection in a child would write to, and so copy, all that is shared with it

    def _make(self, kind: str, command: list[str]) -> None:
        """Make an input by a command."""
        line = [a.replace("{in}", str(self.inputs / kind)) for a in command]
        status = start(self.application, line, self.folder).finished(wait=True)
        if status:
            raise RuntimeError(f"{kind}: {(self.folder / 'said.txt').read_text()}")

    def _undamaged(self, kind: str) -> Rows:
        """The tables of the undamaged input."""
        folder = self.folder / f"good-{kind}"
        case = Case(-1, kind, folder)
        self._lay(case, [])
        status = start(self.application, case.line, folder).finished(wait=True)
        if status:
            raise RuntimeError(f"{kind}: {(folder / 'said.txt').read_text()}")
        return tables(folder / ("in/survey" if KINDS[kind].resumed else "out"))

    def summary(self) -> str:
        """Counts by kind and outcome, and the failures."""
        lines = [f"{'':12}" + "".join(f"{o.value:>16}" for o in Outcome)]
        total: Counter[Outcome] = sum(self.outcomes.values(), Counter())
        for kind, counts in [*self.outcomes.items(), ("all", total)]:
            lines.append(f"{kind:12}" + "".join(f"{counts[o]:16}" for o in Outcome))
        lines += [f"{f.outcome}: {f.case.kind}: {f.case.about[:160]}: {f.why[:160]}\n  {f.folder}/command.txt"
                  for f in self.failures]
        return "\n".join(lines).encode("utf-8", "backslashreplace").decode()


def _filled(kind: Kind, folder: Path) -> list[str]:
    return [a.replace("{in}", str(folder / "in")).replace("{out}", str(folder / "out")) for a in kind.command]
