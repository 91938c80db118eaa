# SPDX-License-Identifier: Apache-2.0
"""Rounds of the soak: cases drawn by seed, played by processes of their own, until the first difference."""

from __future__ import annotations

import random
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path

from golden.params import CONFIGS
from sim.coverage.record import met
from tests.soak.boards import Boards
from tests.soak.bus import Bus
from tests.soak.case import Case, Difference, Part
from tests.soak.races import Races
from tests.soak.shrink import shrink, words
from tests.soak.video import Video

PARTS: dict[str, Part] = {part.name: part for part in (Boards(), Video(), Races(), Bus())}
REPORT_EVERY = 15.0
"""Seconds between two lines of progress."""
LONGEST = 900.0
"""Seconds after which a case counts as hanging."""


def draw(seed: int, number: int, parts: tuple[str, ...] = tuple(PARTS), config: str | None = None) -> Case:
    """Case `number` of a soak; the parts take turns.

    Args:
        seed: of the soak.
        number: of the case.
        parts: names in PARTS.
        config: a configuration; by default one of the part's.
    """
    rng = random.Random(f"{seed} {number}")
    part = PARTS[parts[number % len(parts)]]
    chosen = config or rng.choice(part.configs)
    return Case(part.name, chosen, rng.randrange(1, 1 << 31), tuple(part.draw(rng, CONFIGS[chosen])))


def play(case: Case) -> tuple[Counter[str], Difference | None]:
    """Play a case: what it met, and the difference it shows if any. An error of another kind is a difference too."""
    try:
        return PARTS[case.part].play(case), None
    except Difference as difference:
        return Counter(), difference
    except Exception as error:
        return Counter(), Difference(type(error).__name__, str(error))


def shortest(case: Case, difference: Difference, seconds: float = 120.0) -> Case:
    """The shortest case found that shows a difference of the same kind."""

    def differs(candidate: Case) -> bool:
        shown = play(candidate)[1]
        return shown is not None and shown.kind == difference.kind

    return shrink(case, differs, seconds)


def replay_command(file: Path) -> str:
    """The command that replays a kept case."""
    return f"make soak REPLAY={file}"


@dataclass
class Campaign:
    """Plays cases until one differs or the time is over.

    Attributes:
        seed: decides all cases, with their numbers.
        folder: for the reproduction of a difference.
        jobs: processes.
        parts: names in PARTS.
        config: plays this configuration only; None for the parts' own.
        cases: played, by part and configuration.
        met: what they met, by part and configuration.
    """

    seed: int
    folder: Path
    jobs: int = 2
    parts: tuple[str, ...] = tuple(PARTS)
    config: str | None = None
    cases: Counter[str] = field(default_factory=Counter)
    met: dict[str, Counter[str]] = field(default_factory=dict)
    started: float = field(default_factory=time.monotonic)

    def run(self, count: int | None = None, seconds: float | None = None) -> Path | None:
        """Play `count` cases, or for some seconds; returns the file that reproduces the difference found, if any."""
        numbers = iter(range(count)) if count is not None else self._until(seconds or 0.0)
        playing: dict[Future[tuple[Counter[str], Difference | None]], tuple[Case, float]] = {}
        shown = time.monotonic()
        with ProcessPoolExecutor(self.jobs, max_tasks_per_child=50) as pool:
            for number in numbers:
                case = draw(self.seed, number, self.parts, self.config)
                playing[pool.submit(play, case)] = case, time.monotonic()
                while len(playing) >= self.jobs:
                    found = self._take(playing)
                    if found:
                        self._stop(pool)
                        return self._keep(*found)
                    if time.monotonic() - shown > REPORT_EVERY:
                        shown = time.monotonic()
                        print(self.progress(seconds), flush=True)
            while playing:
                found = self._take(playing)
                if found:
                    self._stop(pool)
                    return self._keep(*found)
        for part, counts in self.met.items():
            met(f"soak {part}", counts)
        return None

    def progress(self, seconds: float | None = None) -> str:
        """One line: time, cases by part."""
        gone = time.monotonic() - self.started
        limit = f" of {seconds:.0f}" if seconds else ""
        return (f"{gone:.0f}{limit} s: {sum(self.cases.values())} cases without a difference ("
                + ", ".join(f"{name} {count}" for name, count in sorted(self.cases.items())) + ")")

    def _until(self, seconds: float) -> Iterator[int]:
        number = 0
        while time.monotonic() - self.started < seconds:
            yield number
            number += 1

    def _take(self, playing: dict[Future[tuple[Counter[str], Difference | None]], tuple[Case, float]],
              ) -> tuple[Case, Difference] | None:
        """Take the cases that are done; returns one that differs."""
        done, _ = wait(playing, timeout=REPORT_EVERY, return_when=FIRST_COMPLETED)
        for future in done:
            case, _ = playing.pop(future)
            try:
                counts, difference = future.result()
            except BrokenProcessPool:
                return case, Difference("crash", "the simulation ended its process")
            if difference:
                return case, difference
            self.cases[f"{case.part} {case.config}"] += 1
            self.met.setdefault(f"{case.part} {case.config}", Counter()).update(counts)
        late = [case for case, begun in playing.values() if time.monotonic() - begun > LONGEST]
        return (late[0], Difference("hang", f"no end after {LONGEST:.0f} s")) if late else None

    @staticmethod
    def _stop(pool: ProcessPoolExecutor) -> None:
        """End this soak's own processes, without waiting for cases under way."""
        processes = list((pool._processes or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()

    def _keep(self, case: Case, difference: Difference) -> Path:
        """Write the shortest case that shows the difference, and say how to replay it."""
        file = self.folder / f"{case.part}-{case.config}-{difference.kind}.json"
        case.write(file)  # first as it is: a crash while it is made shorter loses nothing
        print(f"difference in {case.part} on {case.config}: {difference}\nmaking it shorter ...", flush=True)
        if difference.kind not in ("crash", "hang"):
            case = shortest(case, difference)
            case.write(file)
            shown = play(case)[1]
            print("\n".join(words(case)))
            print(f"shows: {shown}")
        print(f"repeat it: {replay_command(file)}")
        return file
